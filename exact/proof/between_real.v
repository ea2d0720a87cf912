(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* The values of greatest_between of toolkit/time/interval_refit.cpp, in real numbers with rounding and underflow: each
   is at least what it stands for. *)
From Coq Require Import Reals Lra Lia ZArith List.
From Flocq Require Import Core.
From CinchProof Require time_bump.
From CinchProof Require Import rounding successor model real_model.
Open Scope R_scope.

Section Between.
Variables prec emin : Z.
Context {format : Format prec emin}.
Notation fl := (fl prec emin).
Notation number := (number prec emin).
Notation u := (u prec).
Notation eta := (eta emin).

Lemma four_times x : number x -> number (4 * x).
Proof.
  intros F. apply FLT_format_generic in F; [| typeclasses eauto]. destruct F as [[m e] -> M E]. unfold F2R. cbn [Fnum
    Fexp] in *.
  replace (4 * (IZR m * bpow radix2 e)) with (IZR m * bpow radix2 (e + 2)).
  - apply (scaled_number prec emin); [exact M | lia].
  - rewrite bpow_plus. change (bpow radix2 2) with 4. ring.
Qed.

(* succ goes up by more than a quarter of u|x|, also where the next number is nearer than the one before. *)
Lemma succ_above x : number x -> x + / 4 * u * Rabs x <= successor.succ prec emin x.
Proof.
  intros F. pose proof (u_positive prec) as U. pose proof (u_small prec emin) as US.
  apply Rle_trans with (2 := succ_at_least_next prec emin x F).
  destruct (Rle_or_lt 0 x) as [P | N].
  - rewrite succ_eq_pos, Rabs_pos_eq by exact P. pose proof (ulp_FLT_gt radix2 emin prec x) as L.
    rewrite Rabs_pos_eq in L by exact P. change (ulp radix2 (FLT_exp emin prec) x) with (ulp radix2 (fexp prec emin)
      x) in L.
    change (bpow radix2 (- prec)) with u in L. assert (0 <= u * x) by (apply Rmult_le_pos; lra). lra.
  - replace x with (- (- x)) at 3 by ring. rewrite succ_opp. rewrite Rabs_left by exact N.
    pose proof (pred_plus_ulp radix2 (fexp prec emin) (- x) ltac:(lra) (number_opp prec emin x F)) as E.
    pose proof (ulp_FLT_gt radix2 emin prec (pred radix2 (fexp prec emin) (- x))) as L.
    change (ulp radix2 (FLT_exp emin prec)) with (ulp radix2 (fexp prec emin)) in L.
    change (bpow radix2 (- prec)) with u in L. set (q := pred radix2 (fexp prec emin) (- x)) in *.
    pose proof (ulp_ge_0 radix2 (fexp prec emin) q) as G0. set (g := ulp radix2 (fexp prec emin) q) in *.
    pose proof (Rle_abs q). assert (q * u <= Rabs q * u) by (apply Rmult_le_compat_r; lra).
    assert (u * g <= / 16777216 * g) by (apply Rmult_le_compat_r; lra).
    replace q with (- x - g) in * by lra. assert (0 <= u * - x) by (apply Rmult_le_pos; lra). lra.
Qed.

(* The greatest of chord and bump, by the ends' difference. *)
Lemma top_by_difference a b s : 0 < s -> Rabs (b - a) < 4 * s ->
  time_bump.greatest_between a b s = (a + b) / 2 + s + Rabs (b - a) * Rabs (b - a) / (16 * s).
Proof.
  intros S D. unfold time_bump.greatest_between. destruct (Rle_dec s 0); [lra |]. destruct (Rle_dec (4 * s) _); [lra |].
  f_equal. f_equal. rewrite <- Rabs_mult. rewrite Rabs_pos_eq; [reflexivity | apply Rle_0_sqr].
Qed.

(* Where the computed difference is at least 4 s, the greatest end and a step bound. *)
Lemma steep a b s : number a -> number b -> 0 < s -> 4 * s <= fl (Rmax a b - Rmin a b) ->
  time_bump.greatest_between a b s <= successor.succ prec emin (Rmax a b).
Proof.
  intros A B S D. pose proof (u_positive prec) as U. pose proof (u_small prec emin) as US.
  assert (NM : number (Rmax a b)) by (unfold Rmax; destruct Rle_dec; assumption).
  assert (Nm : number (Rmin a b)) by (unfold Rmin; destruct Rle_dec; assumption).
  apply Rle_trans with (2 := succ_above _ NM).
  assert (E : Rabs (b - a) = Rmax a b - Rmin a b).
  { unfold Rmax, Rmin, Rabs. destruct Rcase_abs, Rle_dec; lra. }
  assert (Half : a + b = 2 * Rmax a b - (Rmax a b - Rmin a b)) by (unfold Rmax, Rmin; destruct Rle_dec; lra).
  destruct (Rle_or_lt (4 * s) (Rabs (b - a))) as [L | L].
  - unfold time_bump.greatest_between. destruct (Rle_dec s 0); [lra |]. destruct (Rle_dec (4 * s) _); [| lra].
    pose proof (Rabs_pos (Rmax a b)). assert (0 <= u * Rabs (Rmax a b)) by (apply Rmult_le_pos; lra). lra.
  - rewrite (top_by_difference a b s S L). rewrite E in *. set (M := Rmax a b) in *. set (m := Rmin a b) in *.
    set (d := M - m) in *. assert (D0 : 0 <= d) by (rewrite <- E; apply Rabs_pos).
    set (e := 4 * s - d). assert (E0 : 0 < e) by (unfold e; lra).
    pose proof (fl_plus_error prec emin M (- m) NM (number_opp prec emin _ Nm)) as R1.
    change (M + - m) with d in R1. rewrite (Rabs_pos_eq d D0) in R1. apply Rabs_le_inv in R1.
    assert (R2 : fl d - d <= Rabs M).
    { destruct (round_N_pt radix2 (fexp prec emin) (fun n => negb (Z.even n)) d) as [_ Near].
      specialize (Near (- m) (number_opp prec emin _ Nm)). change (round radix2 (fexp prec emin) ZnearestE d) with
        (fl d)
        in Near. replace (- m - d) with (- M) in Near by (unfold d; ring). rewrite Rabs_Ropp in Near.
      apply Rabs_le_inv in Near. lra. }
    assert (K : (a + b) / 2 + s + d * d / (16 * s) = M + e * (e / (4 * s)) * / 4).
    { rewrite Half. unfold e. field. lra. }
    rewrite K. assert (Q : e / (4 * s) <= u).
    { apply Rmult_le_reg_r with (4 * s); [lra |]. unfold Rdiv. rewrite Rmult_assoc, Rinv_l by lra.
      assert (u * d <= u * (4 * s)) by (apply Rmult_le_compat_l; lra). unfold e in *. lra. }
    assert (Q0 : 0 <= e / (4 * s)) by (apply Rlt_le, Rdiv_lt_0_compat; lra).
    assert (e * (e / (4 * s)) <= Rabs M * u) by (apply Rmult_le_compat; unfold e in *; lra). lra.
Qed.

(* The error term: 16 u of a computed sum of three, and underflows. *)
Definition size_of (a b s : R) : R := fl (fl (Rabs a + Rabs b) + s).
Definition real_error (a b s k : R) : R := fl (fl (16 * u * size_of a b s) + k * eta).
Lemma error_below a b s k : number a -> number b -> number s -> 0 <= s -> 1 <= k <= 4 -> number (k * eta) ->
  let S := Rabs a + Rabs b + s in
  0 <= size_of a b s <= 1.01 * S /\
  15.9 * u * S + (k - / 2) * eta - u * (4 * eta) <= real_error a b s k <= / 100 * S + 5 * eta.
Proof.
  intros A B Ns S0 K Nk S. pose proof (u_positive prec) as U. pose proof (u_small prec emin) as US.
  pose proof (eta_positive emin) as E0. pose proof (Rabs_pos a). pose proof (Rabs_pos b).
  pose proof (fl_plus_error prec emin _ _ (number_abs prec emin a A) (number_abs prec emin b B)) as R1.
  rewrite (Rabs_pos_eq (Rabs a + Rabs b)) in R1 by lra. apply Rabs_le_inv in R1.
  set (f := fl (Rabs a + Rabs b)) in *. assert (F0 : 0 <= f) by (apply (fl_nonnegative prec emin); lra).
  pose proof (fl_plus_error prec emin f s (fl_number prec emin _) Ns) as R2. fold f in R2.
  rewrite (Rabs_pos_eq (f + s)) in R2 by lra. apply Rabs_le_inv in R2.
  unfold real_error, size_of. fold f. set (z := fl (f + s)) in *.
  assert (Z0 : 0 <= z) by (apply (fl_nonnegative prec emin); lra).
  assert (S1 : 0 <= S) by (unfold S; lra).
  assert (U1 : u * (Rabs a + Rabs b) <= u * S) by (apply Rmult_le_compat_l; unfold S; lra).
  assert (U2 : u * (f + s) <= u * (S + u * S)) by (apply Rmult_le_compat_l; unfold S in *; lra).
  assert (US1 : 0 <= u * S) by (apply Rmult_le_pos; lra).
  assert (US2 : u * S <= / 16777216 * S) by (apply Rmult_le_compat_r; lra).
  assert (US3 : u * (u * S) <= / 16777216 * (u * S)) by (apply Rmult_le_compat_r; lra).
  assert (ZS : S - 2.001 * (u * S) <= z <= S + 2.001 * (u * S)) by (unfold S in *; lra).
  assert (UZ : u * (S - 2.001 * (u * S)) <= u * z <= u * (S + 2.001 * (u * S))) by (split; apply Rmult_le_compat_l;
    lra).
  assert (UZ0 : 0 <= u * z) by (apply Rmult_le_pos; lra). assert (Z16 : 0 <= 16 * u * z) by lra.
  pose proof (fl_error prec emin (16 * u * z)) as R3. rewrite (Rabs_pos_eq (16 * u * z) Z16) in R3.
  apply Rabs_le_inv in R3.
  set (t := fl (16 * u * z)) in *. assert (T0 : 0 <= t) by (apply (fl_nonnegative prec emin); exact Z16).
  assert (UUZ : u * (16 * u * z) <= / 16777216 * (16 * u * z)) by (apply Rmult_le_compat_r; lra).
  assert (KE : 0 <= k * eta <= 4 * eta) by (split; [apply Rmult_le_pos | apply Rmult_le_compat_r]; lra).
  pose proof (fl_plus_error prec emin t (k * eta) (fl_number prec emin _) Nk) as R4.
  rewrite (Rabs_pos_eq (t + k * eta)) in R4 by lra. apply Rabs_le_inv in R4.
  assert (T1 : t <= 16.01 * (u * S) + eta / 2) by lra.
  assert (UT : u * (t + k * eta) <= u * (16.01 * (u * S) + eta / 2 + k * eta)) by (apply Rmult_le_compat_l; lra).
  assert (UE : u * eta <= / 16777216 * eta) by (apply Rmult_le_compat_r; lra).
  assert (0 <= u * eta) by (apply Rmult_le_pos; lra).
  assert (UK : u * (k * eta) <= u * (7 / 2 * eta) \/ u * (7 / 2 * eta) <= u * (k * eta)) by lra.
  assert (UKE : u * (k * eta) <= u * (4 * eta)) by (apply Rmult_le_compat_l; lra).
  split; [split; lra |].
  (* 15.9 u S is what is left of 16 *)
  assert (T2 : 15.99 * (u * S) - eta / 2 <= t) by lra.
  assert (TT : u * t <= / 16777216 * t) by (apply Rmult_le_compat_r; lra).
  set (w := fl (t + k * eta)) in *.
  assert (W : t + k * eta - u * (t + k * eta) <= w) by lra.
  split; [| lra]. lra.
Qed.

Definition real_parabola (a b s : R) : R :=
  let d := fl (Rmax a b - Rmin a b) in
  fl (fl (fl (fl (a + b) * / 2) + s) + fl (d * fl (fl (d / s) * / 16))).

Lemma parabola_covers a b s : number a -> number b -> number s -> 0 < s -> Rmax a b - Rmin a b < 4 * s ->
  fl (Rmax a b - Rmin a b) <= 4 * s -> number (4 * eta) ->
  time_bump.greatest_between a b s <= fl (real_parabola a b s + real_error a b s 4).
Proof.
  intros A B Ns S0 L0 L1 N4. pose proof (u_positive prec) as U. pose proof (u_small prec emin) as US.
  pose proof (eta_positive emin) as E0. pose proof (Rabs_pos a) as Pa. pose proof (Rabs_pos b) as Pb.
  assert (NM : number (Rmax a b)) by (unfold Rmax; destruct Rle_dec; assumption).
  assert (Nm : number (Rmin a b)) by (unfold Rmin; destruct Rle_dec; assumption).
  assert (E : Rabs (b - a) = Rmax a b - Rmin a b).
  { unfold Rmax, Rmin, Rabs. destruct Rcase_abs, Rle_dec; lra. }
  rewrite (top_by_difference a b s S0) by (rewrite E; exact L0). rewrite E.
  pose proof (error_below a b s 4 A B Ns (Rlt_le _ _ S0) ltac:(lra) N4) as (_ & EL & EU).
  set (err := real_error a b s 4) in *. set (S := Rabs a + Rabs b + s) in *.
  assert (DS : Rmax a b - Rmin a b <= S).
  { rewrite <- E. unfold S. pose proof (Rabs_triang b (- a)). rewrite Rabs_Ropp in *. unfold Rminus. lra. }
  unfold real_parabola. set (M := Rmax a b) in *. set (m := Rmin a b) in *.
  assert (D0 : 0 <= M - m) by (rewrite <- E; apply Rabs_pos).
  pose proof (fl_plus_error prec emin M (- m) NM (number_opp prec emin _ Nm)) as RD.
  change (M + - m) with (M - m) in RD. rewrite (Rabs_pos_eq (M - m) D0) in RD. apply Rabs_le_inv in RD.
  set (d0 := M - m) in *. set (d := fl d0) in *.
  assert (Dn : 0 <= d) by (apply (fl_nonnegative prec emin); exact D0).
  assert (S1 : 0 <= S) by (unfold S; lra).
  assert (US1 : 0 <= u * S) by (apply Rmult_le_pos; lra).
  assert (US2 : u * S <= / 16777216 * S) by (apply Rmult_le_compat_r; lra).
  assert (US3 : u * (u * S) <= / 16777216 * (u * S)) by (apply Rmult_le_compat_r; lra).
  assert (UE : u * eta <= / 16777216 * eta) by (apply Rmult_le_compat_r; lra).
  assert (UE0 : 0 <= u * eta) by (apply Rmult_le_pos; lra).
  (* the chord's middle and the bump *)
  assert (AB : Rabs (a + b) <= S) by (unfold S; pose proof (Rabs_triang a b); lra).
  pose proof (fl_plus_error prec emin a b A B) as R1. set (f := fl (a + b)) in *.
  assert (U1 : u * Rabs (a + b) <= u * S) by (apply Rmult_le_compat_l; lra).
  assert (F1 : Rabs f <= S + u * S).
  { replace f with (a + b + (f - (a + b))) by ring. pose proof (Rabs_triang (a + b) (f - (a + b))). lra. }
  pose proof (fl_error prec emin (f * / 2)) as R2. rewrite Rabs_mult, (Rabs_pos_eq (/ 2)) in R2 by lra.
  assert (U2 : u * (Rabs f * / 2) <= u * ((S + u * S) * / 2)) by (apply Rmult_le_compat_l; lra).
  set (h := fl (f * / 2)) in *. apply Rabs_le_inv in R1, R2. apply Rabs_le_inv in F1.
  assert (H1 : Rabs (h + s) <= 2 * S + eta) by (apply Rabs_le; unfold S in *; lra).
  pose proof (fl_plus_error prec emin h s (fl_number prec emin _) Ns) as R3.
  assert (U3 : u * Rabs (h + s) <= u * (2 * S + eta)) by (apply Rmult_le_compat_l; lra).
  set (hb := fl (h + s)) in *. apply Rabs_le_inv in R3. apply Rabs_le_inv in H1.
  (* the quotient *)
  assert (DQ : 0 <= d / s <= 4).
  { split; [apply Rmult_le_pos; [exact Dn | apply Rlt_le, Rinv_0_lt_compat; exact S0] |].
    apply Rmult_le_reg_r with s; [exact S0 |]. unfold Rdiv. rewrite Rmult_assoc, Rinv_l by lra. lra. }
  pose proof (fl_error prec emin (d / s)) as R4. rewrite (Rabs_pos_eq (d / s)) in R4 by lra. apply Rabs_le_inv in R4.
  set (q0 := fl (d / s)) in *. assert (Q0 : 0 <= q0) by (apply (fl_nonnegative prec emin); lra).
  pose proof (fl_error prec emin (q0 * / 16)) as R5. rewrite (Rabs_pos_eq (q0 * / 16)) in R5 by lra.
  apply Rabs_le_inv in R5. set (q := fl (q0 * / 16)) in *.
  assert (Q1 : 0 <= q) by (apply (fl_nonnegative prec emin); lra).
  set (r := d / s) in *.
  assert (UR : 0 <= u * r) by (apply Rmult_le_pos; lra).
  assert (UUR : u * (u * r) <= / 16777216 * (u * r)) by (apply Rmult_le_compat_r; lra).
  assert (UQ0 : u * q0 <= u * (r + u * r + eta / 2)) by (apply Rmult_le_compat_l; lra).
  assert (URr : u * r <= / 16777216 * r) by (apply Rmult_le_compat_r; lra).
  assert (QL : r * / 16 * (1 - 2.001 * u) - eta <= q) by lra.
  assert (QU : q <= r * / 16 + / 16 + 2 * eta) by lra.
  assert (E1 : eta <= u * u).
  { unfold eta, u, rounding.eta, rounding.u. rewrite <- bpow_plus. apply bpow_le.
    pose proof (@emin_small prec emin format). pose proof (@prec_large prec emin format). lia. }
  assert (UU : u * u <= / 16777216 * u) by (apply Rmult_le_compat_r; lra).
  assert (Dd : d <= 1.001 * S).
  { assert (u * d0 <= u * S) by (apply Rmult_le_compat_l; lra). lra. }
  assert (ED : d * eta <= / 1000 * (u * S)).
  { apply Rle_trans with (1.001 * S * (/ 16777216 * u)); [apply Rmult_le_compat; lra |].
    replace (1.001 * S * (/ 16777216 * u)) with (1.001 * / 16777216 * (u * S)) by ring. lra. }
  pose proof (fl_error prec emin (d * q)) as R6. assert (DQ0 : 0 <= d * q) by now apply Rmult_le_pos.
  rewrite (Rabs_pos_eq (d * q)) in R6 by exact DQ0. apply Rabs_le_inv in R6. set (g := fl (d * q)) in *.
  set (Y := d0 * d0 / (16 * s)).
  assert (YS : 0 <= Y <= / 4 * S).
  { unfold Y. split; [apply Rmult_le_pos; [apply Rmult_le_pos; exact D0 | apply Rlt_le, Rinv_0_lt_compat; lra] |].
    apply Rmult_le_reg_r with (16 * s); [lra |]. unfold Rdiv. rewrite Rmult_assoc, Rinv_l, Rmult_1_r by lra.
    assert (d0 * d0 <= S * (4 * s)) by (apply Rmult_le_compat; lra). lra. }
  assert (UY : u * Y <= u * (/ 4 * S)) by (apply Rmult_le_compat_l; lra).
  assert (UY0 : 0 <= u * Y) by (apply Rmult_le_pos; lra).
  assert (DL : d0 * (1 - u) <= d) by lra.
  assert (DR : Y * (1 - 2 * u) <= d * (r * / 16)).
  { replace (d * (r * / 16)) with (d * d / (16 * s)) by (unfold r; field; lra).
    apply Rle_trans with (d0 * (1 - u) * (d0 * (1 - u)) / (16 * s)).
    - replace (d0 * (1 - u) * (d0 * (1 - u)) / (16 * s)) with (Y * ((1 - u) * (1 - u))) by (unfold Y; field; lra).
      apply Rmult_le_compat_l; [lra |]. assert (0 <= u * u) by (apply Rmult_le_pos; lra). lra.
    - apply Rmult_le_compat_r; [apply Rlt_le, Rinv_0_lt_compat; lra |].
      assert (0 <= d0 * (1 - u)) by (apply Rmult_le_pos; lra). apply Rmult_le_compat; lra. }
  assert (DqL : d * (r * / 16 * (1 - 2.001 * u) - eta) <= d * q) by (apply Rmult_le_compat_l; lra).
  assert (DqL2 : Y * (1 - 2 * u) * (1 - 2.001 * u) <= d * (r * / 16) * (1 - 2.001 * u)) by (apply Rmult_le_compat_r;
    lra).
  assert (DqU : d * q <= d * (/ 2)).
  { apply Rmult_le_compat_l; lra. }
  assert (UDQ : u * (d * q) <= u * (1.001 * S * / 2)) by (apply Rmult_le_compat_l; lra).
  assert (UUY : 0 <= u * (u * Y)) by (apply Rmult_le_pos; lra).
  assert (GL : Y - 1.6 * (u * S) - eta / 2 <= g).
  { lra. }
  assert (GU : 0 <= g <= S + eta).
  { split; [apply (fl_nonnegative prec emin); exact DQ0 | lra]. }
  (* together *)
  pose proof (fl_plus_error prec emin hb g (fl_number prec emin _) (fl_number prec emin _)) as R7.
  assert (P1 : Rabs (hb + g) <= 3.1 * S + 3 * eta) by (apply Rabs_le; lra).
  assert (U7 : u * Rabs (hb + g) <= u * (3.1 * S + 3 * eta)) by (apply Rmult_le_compat_l; lra).
  set (p := fl (hb + g)) in *. apply Rabs_le_inv in R7, P1.
  pose proof (fl_plus_error prec emin p err (fl_number prec emin _) (fl_number prec emin _)) as R8.
  assert (P2 : Rabs (p + err) <= 3.2 * S + 9 * eta) by (apply Rabs_le; lra).
  assert (U8 : u * Rabs (p + err) <= u * (3.2 * S + 9 * eta)) by (apply Rmult_le_compat_l; lra).
  apply Rabs_le_inv in R8. fold Y. lra.
Qed.

(* By the path's length: either of two ways. *)
Definition real_way1 (a b p : R) : R := fl (fl (fl (a + b) + p) * / 2).
Definition real_way2 (a b p : R) : R := fl (Rmin a b + p).

Lemma way_covers a b p way v : number a -> number b -> number p -> 0 <= p ->
  way = real_way1 a b p /\ v <= (a + b + p) / 2 \/ way = real_way2 a b p /\ v <= Rmin a b + p ->
  v <= fl (way + real_error a b p 1).
Proof.
  intros A B Np P0 W. pose proof (u_positive prec) as U. pose proof (u_small prec emin) as US.
  pose proof (eta_positive emin) as E0. pose proof (Rabs_pos a) as Pa. pose proof (Rabs_pos b) as Pb.
  assert (N1 : number (1 * eta)) by (rewrite Rmult_1_l; apply (eta_number prec emin)).
  pose proof (error_below a b p 1 A B Np P0 ltac:(lra) N1) as (_ & EL & EU).
  set (err := real_error a b p 1) in *. set (S := Rabs a + Rabs b + p) in *.
  assert (Nm : number (Rmin a b)) by (unfold Rmin; destruct Rle_dec; assumption).
  assert (Nw : number way) by (destruct W as [[-> _] | [-> _]]; apply (fl_number prec emin)).
  assert (S1 : 0 <= S) by (unfold S; lra).
  assert (Bits : S = 0 \/ eta <= S).
  { destruct (Req_dec a 0) as [Za | Za].
    - destruct (Req_dec b 0) as [Zb | Zb].
      + destruct (Req_dec p 0) as [Zp | Zp]; [left; unfold S; rewrite Za, Zb, Zp, Rabs_R0; lra | right].
        pose proof (number_bit prec emin p Np ltac:(lra)). unfold S. lra.
      + right. pose proof (number_bit prec emin _ (number_abs prec emin b B) (Rabs_pos_lt b Zb)). unfold S. lra.
    - right. pose proof (number_bit prec emin _ (number_abs prec emin a A) (Rabs_pos_lt a Za)). unfold S. lra. }
  assert (UE0 : 0 <= u * eta) by (apply Rmult_le_pos; lra).
  assert (UE : u * eta <= / 16777216 * eta) by (apply Rmult_le_compat_r; lra).
  assert (US1 : 0 <= u * S) by (apply Rmult_le_pos; lra).
  assert (US2 : u * S <= / 16777216 * S) by (apply Rmult_le_compat_r; lra).
  assert (US3 : u * (u * S) <= / 16777216 * (u * S)) by (apply Rmult_le_compat_r; lra).
  assert (WL : v - 2.1 * (u * S) - eta / 2 <= way /\ Rabs way <= 2 * S + eta /\ (S = 0 -> v <= 0 /\ way = 0)).
  { pose proof (Rle_abs a). pose proof (Rle_abs b). pose proof (Rle_abs (- a)) as Na. pose proof (Rle_abs (- b)) as Nb.
    rewrite Rabs_Ropp in Na, Nb.
    destruct W as [[Ew V] | [Ew V]].
    - unfold real_way1 in Ew. pose proof (fl_plus_error prec emin a b A B) as R1. set (f := fl (a + b)) in *.
      assert (Rabs (a + b) <= S) by (apply Rabs_le; unfold S; lra).
      assert (u * Rabs (a + b) <= u * S) by (apply Rmult_le_compat_l; lra). apply Rabs_le_inv in R1.
      pose proof (fl_plus_error prec emin f p (fl_number prec emin _) Np) as R2.
      assert (Rabs (f + p) <= S + u * S) by (apply Rabs_le; unfold S in *; lra).
      assert (u * Rabs (f + p) <= u * (S + u * S)) by (apply Rmult_le_compat_l; lra). apply Rabs_le_inv in R2.
      set (t := fl (f + p)) in *. pose proof (fl_error prec emin (t * / 2)) as R3. rewrite <- Ew in R3.
      rewrite Rabs_mult, (Rabs_pos_eq (/ 2)) in R3 by lra.
      assert (Rabs t <= 2 * S) by (apply Rabs_le; unfold S in *; lra).
      assert (u * (Rabs t * / 2) <= u * (2 * S * / 2)) by (apply Rmult_le_compat_l; lra). apply Rabs_le_inv in R3.
      assert (a + b <= S /\ - S <= a + b + p <= S) by (unfold S in *; lra).
      split; [lra |]. split; [apply Rabs_le; unfold S in *; lra |]. intros Z. split; [lra |].
      assert (a = 0 /\ b = 0 /\ p = 0) as (Za & Zb & Zp) by (unfold S in *; lra).
      unfold t, f in Ew. rewrite Za, Zb, Zp, Rplus_0_l, (fl_0 prec emin), Rplus_0_l, (fl_0 prec emin), Rmult_0_l,
        (fl_0 prec emin) in Ew. exact Ew.
    - unfold real_way2 in Ew. pose proof (fl_plus_error prec emin _ p Nm Np) as R1. rewrite <- Ew in R1.
      assert (Rabs (Rmin a b + p) <= S) by (apply Rabs_le; unfold S, Rmin; destruct Rle_dec; lra).
      assert (u * Rabs (Rmin a b + p) <= u * S) by (apply Rmult_le_compat_l; lra). apply Rabs_le_inv in R1.
      assert (Q : - S <= Rmin a b + p <= S) by now apply Rabs_le_inv.
      split; [lra |]. split; [apply Rabs_le; lra |]. intros Z. split; [lra |].
      assert (Zm : Rmin a b + p = 0) by lra. rewrite Zm, (fl_0 prec emin) in Ew. exact Ew. }
  destruct WL as (WL & WB & WZ).
  pose proof (fl_plus_error prec emin way err Nw (fl_number prec emin _)) as R.
  assert (Wb := WB). apply Rabs_le_inv in Wb. assert (E1 : 0 <= err) by lra.
  destruct Bits as [Z | Bits].
  - destruct (WZ Z) as [V ->]. rewrite Rplus_0_l. apply Rle_trans with (1 := V).
    apply (fl_nonnegative prec emin). exact E1.
  - assert (Rabs (way + err) <= 3 * S + 6 * eta) by (apply Rabs_le; lra).
    assert (u * Rabs (way + err) <= u * (3 * S + 6 * eta)) by (apply Rmult_le_compat_l; lra).
    assert (u * eta <= u * S) by (apply Rmult_le_compat_l; lra).
    apply Rabs_le_inv in R. lra.
Qed.
End Between.
