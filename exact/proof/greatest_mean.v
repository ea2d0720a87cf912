(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* greatest_mean of toolkit/bounds/greatest_mean.hpp: of c_j >= 0 it is at least every mean of W', with rounding and
   underflow, and over IEEE values. *)
From Coq Require Import Reals Lra Lia ZArith List Bool.
From Flocq Require Import Core.
From CinchProof Require Import duality rounding successor approximation model real_model dual_bound ieee ieee_forward
  ieee_dual.
Import ListNotations.
Open Scope R_scope.

Section Real.
Variables prec emin : Z.
Context {format : Format prec emin}.
Notation fl := (fl prec emin).
Notation number := (number prec emin).
Notation u := (u prec).
Notation eta := (eta emin).
Notation real_ops := (real_ops prec emin).
Notation approximates := (approximates prec emin).
Notation growth := (growth prec).
Notation entry := (entry (num := R)).

Definition mean_entry (e : entry) : Prop :=
  number (entry_l e) /\ number (entry_h e) /\ 0 <= entry_l e <= entry_h e /\ entry_h e <= 1 /\ number (entry_b e) /\
  0 <= entry_b e.
Definition above_term (t : R) (e : entry) : R := (entry_h e - entry_l e) * Rmax (entry_b e - t) 0.

Lemma real_max a b : max real_ops a b = Rmax a b.
Proof. unfold max. cbn [less real_model.real_ops]. case Rlt_bool_spec; intros; [rewrite Rmax_right | rewrite
  Rmax_left]; lra. Qed.
Lemma real_min a b : min real_ops a b = Rmin a b.
Proof. unfold min. cbn [less real_model.real_ops]. case Rlt_bool_spec; intros; [rewrite Rmin_right | rewrite
  Rmin_left]; lra. Qed.

(* The greatest and the second-greatest: above the second there is at most one. *)
Lemma two_greatest_fold nodes : Forall mean_entry nodes -> forall most second (above : R -> R),
  number most -> number second -> 0 <= second <= most ->
  (forall t, second <= t -> above t <= Rmax (most - t) 0) ->
  let r := fold_left (mean_step real_ops) nodes (most, second) in
  number (fst r) /\ number (snd r) /\ 0 <= snd r <= fst r /\ most <= fst r /\
  Forall (fun e => entry_b e <= fst r) nodes /\
  forall t, snd r <= t -> above t + sum (above_term t) nodes <= Rmax (fst r - t) 0.
Proof.
  induction 1 as [| e nodes (L & H & W & O & B & C) F IH]; intros most second above Nm Ns S A; cbn [fold_left].
  - cbn [fst snd]. repeat (split; [first [assumption | lra | constructor] |]). intros t T. unfold sum. simpl.
    rewrite Rplus_0_r. now apply A.
  - unfold mean_step at 2. rewrite !real_max, real_min. cbv zeta. unfold mean_step at 3 5 7 9 11 13 15 17.
    cbn [fst snd]. rewrite ?real_max, ?real_min.
    destruct (IH (Rmax most (entry_b e)) (Rmax second (Rmin (entry_b e) most)) (fun t => above t + above_term t e))
      as (R1 & R2 & R3 & R4 & R5 & R6).
    + unfold Rmax. destruct Rle_dec; assumption.
    + unfold Rmax, Rmin. destruct Rle_dec; [destruct Rle_dec; assumption | assumption].
    + unfold Rmax, Rmin. repeat destruct Rle_dec; lra.
    + intros t T. assert (T1 : second <= t) by (pose proof (Rmax_l second (Rmin (entry_b e) most)); lra).
      assert (T2 : Rmin (entry_b e) most <= t) by (pose proof (Rmax_r second (Rmin (entry_b e) most)); lra).
      specialize (A t T1). unfold above_term. revert T2 A. unfold Rmin, Rmax.
      destruct (Rle_dec (entry_b e) most) as [D | D]; intros T2 A.
      * destruct (Rle_dec (entry_b e - t) 0); [| lra]. destruct (Rle_dec most (entry_b e)).
        -- assert (most = entry_b e) by lra. subst most. lra.
        -- lra.
      * destruct (Rle_dec most (entry_b e)); [| lra]. destruct (Rle_dec (most - t) 0); [| lra].
        destruct (Rle_dec (entry_b e - t) 0); [lra |].
        assert ((entry_h e - entry_l e) * (entry_b e - t) <= 1 * (entry_b e - t)) by (apply Rmult_le_compat_r; lra).
        lra.
    + pose proof (Rmax_l most (entry_b e)). pose proof (Rmax_r most (entry_b e)).
      split; [exact R1 |]. split; [exact R2 |]. split; [exact R3 |]. split; [lra |].
      split; [constructor; [lra | exact R5] |]. intros t T. specialize (R6 t T). rewrite sum_cons. lra.
Qed.

(* One term of the sum passes at most 4 roundings. *)
Lemma term_approximates second e : number second -> mean_entry e ->
  approximates 4 (mean_term real_ops second e) (dual_term second (node_of_entry e))
    (entry_l e * Rabs (entry_b e - second) + above_term second e) (1 + u).
Proof.
  intros Ns (L & H & W & O & B & C). unfold mean_term, dual_term. rewrite real_max, model_zero.
  cbn [add sub mul real_model.real_ops node_of_entry low high extremum].
  set (x := entry_b e - second). set (c := fl x).
  pose proof (u_positive prec) as U. pose proof (u_small prec emin) as US.
  pose proof (fl_plus_error prec emin (entry_b e) (- second) B (number_opp prec emin _ Ns)) as E.
  change (entry_b e + - second) with x in E. fold c in E.
  assert (G1 : growth 1 = u) by (unfold approximation.growth; simpl; ring).
  assert (AX : approximates 1 c x (Rabs x) 0).
  { split; [apply (fl_number prec emin) |]. split; [apply Rle_refl |]. rewrite G1. lra. }
  assert (AM : approximates 1 (Rmax c 0) (Rmax x 0) (Rmax x 0) 0).
  { destruct (Rle_or_lt 0 x) as [P | P].
    - assert (0 <= c) by (apply (fl_nonnegative prec emin); exact P). rewrite !Rmax_left by lra.
      rewrite (Rabs_pos_eq x P) in AX. exact AX.
    - assert (c <= 0) by (rewrite <- (fl_0 prec emin); apply (fl_le prec emin); lra). rewrite !Rmax_right by lra.
      split; [apply (number_0 prec emin) |]. rewrite Rminus_0_r, Rabs_R0. lra. }
  assert (AR : approximates 1 (fl (entry_h e - entry_l e)) (entry_h e - entry_l e) (entry_h e - entry_l e) 0).
  { split; [apply (fl_number prec emin) |]. rewrite Rabs_pos_eq by lra. split; [apply Rle_refl |]. rewrite G1.
    pose proof (fl_plus_error prec emin (entry_h e) (- entry_l e) H (number_opp prec emin _ L)) as R.
    change (entry_h e + - entry_l e) with (entry_h e - entry_l e) in R.
    rewrite (Rabs_pos_eq (entry_h e - entry_l e)) in R by lra. lra. }
  pose proof (approximates_mul prec emin 0 1 _ _ _ _ _ _ (approximates_exact prec emin _ L) AX) as T1.
  rewrite (Rabs_pos_eq (entry_l e)) in T1 by lra.
  pose proof (approximates_mul prec emin 1 1 _ _ _ _ _ _ AR AM) as T2.
  pose proof (approximates_weaken prec emin 2 3 _ _ _ _ _ ltac:(lia) (Rle_refl _) T1) as T1'.
  pose proof (approximates_add prec emin 3 _ _ _ _ _ _ _ _ T1' T2) as T.
  apply (approximates_weaken prec emin 4 4 _ _ _ ((1 + u) * (/ 2 + / 2))); [lia | lra | exact T].
Qed.

Definition lost_terms (n : nat) : R := INR n * (1 + u) ^ (n + 1).
Lemma sum_approximates second nodes : number second -> Forall mean_entry nodes -> forall n s e X,
  approximates (n + 4) s e X (lost_terms n) ->
  approximates (n + length nodes + 4) (fold_left (fun s m => fl (s + mean_term real_ops second m)) nodes s)
    (e + sum (fun m => dual_term second (node_of_entry m)) nodes)
    (X + sum (fun m => entry_l m * Rabs (entry_b m - second) + above_term second m) nodes)
    (lost_terms (n + length nodes)).
Proof.
  intros Ns. induction 1 as [| m nodes M F IH]; intros n s e X A; cbn [fold_left length].
  - unfold sum. simpl. rewrite !Rplus_0_r, Nat.add_0_r. exact A.
  - rewrite !sum_cons, <- (Rplus_assoc e), <- (Rplus_assoc X). replace (n + S (length nodes))%nat with (S n + length
    nodes)%nat by lia.
    apply IH. pose proof (u_positive prec) as U.
    pose proof (approximates_weaken prec emin 4 (n + 4) _ _ _ _ _ ltac:(lia) (Rle_refl _)
                  (term_approximates second m Ns M)) as T.
    pose proof (approximates_add prec emin _ _ _ _ _ _ _ _ _ A T) as R.
    apply (approximates_weaken prec emin _ (S n + 4) _ _ _ _ (lost_terms (S n))) in R; [exact R | lia |].
    unfold lost_terms. rewrite S_INR. replace (S n + 1)%nat with (S (n + 1)) by lia. rewrite <- tech_pow_Rmult.
    pose proof (power_at_least_1 prec n). pose proof (pos_INR n). rewrite pow_add, pow_1.
    set (p := (1 + u) ^ n) in *.
    assert ((1 + u) * (1 + u) * 1 <= (1 + u) * (1 + u) * p) by (apply Rmult_le_compat_l; [apply Rmult_le_pos |]; lra).
    lra.
Qed.

(* D at the second-greatest, as computed and with its error term, is at least the exact one. *)
Theorem mean_value nodes weights : Forall mean_entry nodes -> INR (length nodes + 8) * u <= / 16 ->
  map fst weights = map node_of_entry nodes -> in_space weights ->
  let state := fold_left (mean_step real_ops) nodes (0, 0) in
  mean weights <= fst state /\
  mean weights <= fl (mean_sum real_ops (snd state) nodes + mean_error real_ops (length_of nodes) (fst state)).
Proof.
  intros F Sm E W state.
  destruct (two_greatest_fold nodes F 0 0 (fun _ => 0) (number_0 prec emin) (number_0 prec emin))
    as (NM & NS & O & M0 & B & A); [lra | intros t T; apply Rmax_r |]. fold state in NM, NS, O, M0, B, A.
  set (most := fst state) in *. set (second := snd state) in *.
  assert (Wl : Forall (fun p => 0 <= low (fst p) /\ extremum (fst p) <= most) weights).
  { assert (H : Forall (fun n => 0 <= low n /\ extremum n <= most) (map fst weights)).
    { rewrite E. apply Forall_map. rewrite Forall_forall in F, B |- *. intros e Ie. split; [| exact (B e Ie)].
      destruct (F e Ie) as (_ & _ & P & _). exact (proj1 P). }
    rewrite Forall_map in H. exact H. }
  split.
  { apply (convex_bound weights most W). destruct W as [Win _]. rewrite Forall_forall in Wl, Win |- *. intros p Ip.
    destruct (Wl p Ip) as [P Q]. destruct (Win p Ip) as [R _]. split; [lra | exact Q]. }
  assert (SL : sum entry_l nodes <= 1).
  { destruct W as [Win Wsum]. rewrite <- Wsum.
    assert (Q : sum entry_l nodes = sum (fun p => low (fst p)) weights).
    { transitivity (sum low (map node_of_entry nodes)); [symmetry; exact (sum_map node_of_entry low nodes) |].
      rewrite <- E. exact (sum_map fst low weights). }
    rewrite Q. apply sum_le. apply Forall_impl with (2 := Win). intros p [P _]. exact P. }
  pose proof (weak_duality second weights W) as D. rewrite E in D. unfold dual in D. rewrite sum_map in D.
  pose proof (u_positive prec) as U. pose proof (u_small prec emin) as US. pose proof (eta_positive emin) as E0.
  assert (A0 : approximates (0 + 4) second second (Rabs second) (lost_terms 0)).
  { apply (approximates_weaken prec emin 0 4 _ _ _ 0); [lia | unfold lost_terms; simpl; lra |].
    now apply approximates_exact. }
  pose proof (sum_approximates second nodes NS F 0 _ _ _ A0) as (NSum & _ & Err). cbn [Nat.add] in Err.
  fold (mean_sum real_ops second nodes) in Err, NSum.
  change (fold_left (fun s m => fl (s + mean_term real_ops second m)) nodes second) with (mean_sum real_ops second
    nodes)
    in Err, NSum.
  set (s := mean_sum real_ops second nodes) in *. set (n := length nodes) in *.
  set (exact := second + sum (fun m => dual_term second (node_of_entry m)) nodes) in *.
  set (X := Rabs second + sum (fun m => entry_l m * Rabs (entry_b m - second) + above_term second m) nodes) in *.
  assert (X0 : 0 <= X /\ X <= 2 * most).
  { unfold X. rewrite Rabs_pos_eq by lra. rewrite sum_plus.
    specialize (A second (Rle_refl _)). rewrite Rplus_0_l, Rmax_left in A by lra.
    assert (S1 : sum (fun m => entry_l m * Rabs (entry_b m - second)) nodes <= most * sum entry_l nodes).
    { rewrite <- sum_scale. apply sum_le. rewrite Forall_forall in F, B |- *. intros e Ie.
      destruct (F e Ie) as (_ & _ & P & _ & _ & C). specialize (B e Ie). rewrite (Rmult_comm most).
      apply Rmult_le_compat_l; [lra |]. apply Rabs_le. lra. }
    assert (most * sum entry_l nodes <= most * 1) by (apply Rmult_le_compat_l; lra).
    assert (0 <= sum (fun m => entry_l m * Rabs (entry_b m - second)) nodes).
    { apply sum_nonnegative. apply Forall_impl with (2 := F). intros e (_ & _ & P & _).
      apply Rmult_le_pos; [lra | apply Rabs_pos]. }
    assert (0 <= sum (above_term second) nodes).
    { apply sum_nonnegative. apply Forall_impl with (2 := F). intros e (_ & _ & P & _).
      apply Rmult_le_pos; [lra | apply Rmax_r]. }
    change (fun a => above_term second a) with (above_term second). lra. }
  destruct nodes as [| e0 rest].
  { exfalso. apply map_eq_nil in E. subst weights. destruct W as [_ W]. unfold sum in W. simpl in W. lra. }
  assert (N1 : 1 <= INR n) by (apply (le_INR 1); unfold n; simpl; lia).
  rewrite plus_INR in Sm. replace (INR 8) with 8 in Sm by (simpl; ring).
  (* growth and underflow *)
  assert (K : INR (n + 4) * u <= / 16).
  { rewrite plus_INR. replace (INR 4) with 4 by (simpl; ring). apply Rle_trans with (2 := Sm).
    apply Rmult_le_compat_r; lra. }
  assert (K0 : 0 <= INR (n + 4) * u) by (apply Rmult_le_pos; [apply pos_INR | lra]).
  pose proof (growth_small prec (n + 4) ltac:(lra)) as G. pose proof (growth_nonnegative prec (n + 4)) as G0.
  assert (KK : INR (n + 4) * u * (INR (n + 4) * u) <= / 16 * (INR (n + 4) * u)) by (apply Rmult_le_compat_r; lra).
  assert (G2 : growth (n + 4) <= 17 / 16 * ((INR n + 4) * u)).
  { rewrite plus_INR in *. replace (INR 4) with 4 in * by (simpl; ring). lra. }
  assert (LT : lost_terms n <= 1.07 * INR n).
  { unfold lost_terms. pose proof (growth_le prec (n + 1) (n + 4) ltac:(lia)) as GL.
    unfold approximation.growth in GL, G. rewrite (Rmult_comm 1.07). apply Rmult_le_compat_l; lra. }
  assert (GX : growth (n + 4) * X <= 17 / 16 * ((INR n + 4) * u) * (2 * most)) by (apply Rmult_le_compat; lra).
  assert (LE : lost_terms n * eta <= 1.07 * INR n * eta) by (apply Rmult_le_compat_r; lra).
  assert (XE : Rabs exact <= X).
  { pose proof (sum_approximates second (e0 :: rest) NS F 0 _ _ _ A0) as (_ & Q & _). exact Q. }
  apply Rabs_le_inv in Err. apply Rabs_le_inv in XE.
  (* the error term *)
  assert (Big : (4 * (Z.of_nat n + 8) < 2 ^ prec)%Z).
  { pose proof (@prec_large prec emin format). apply lt_IZR. rewrite IZR_power, mult_IZR, plus_IZR, <- INR_IZR_INZ by
    lia.
    assert (HU : u * bpow radix2 prec = 1)
      by (unfold u, rounding.u; rewrite <- bpow_plus, Z.add_opp_diag_l; reflexivity).
    pose proof (bpow_gt_0 radix2 prec).
    assert ((INR n + 8) * (u * bpow radix2 prec) <= / 16 * bpow radix2 prec)
      by (rewrite <- Rmult_assoc; apply Rmult_le_compat_r; lra). rewrite HU in *. lra. }
  assert (U4 : bpow radix2 (2 - prec) = 4 * u).
  { unfold u, rounding.u. unfold Z.sub. rewrite bpow_plus. change (bpow radix2 2) with 4. reflexivity. }
  assert (T : mean_error real_ops (length_of (e0 :: rest)) most = fl (fl (4 * (INR n + 8) * u * most) + 2 * INR n *
    eta)).
  { unfold mean_error. rewrite model_smallest. cbn [add mul constant precision real_model.real_ops].
    simpl (bpow radix2 0). rewrite !Rmult_1_r, Rmult_1_l, U4. unfold length_of. fold n. rewrite <- plus_IZR.
    rewrite (fl_id prec emin (IZR _)) by (apply (integer_number prec emin); lia).
    replace (IZR (Z.of_nat n + 8) * (4 * u)) with (IZR (4 * (Z.of_nat n + 8)) * u) by (rewrite mult_IZR; ring).
    rewrite (integer_u prec emin (4 * (Z.of_nat n + 8))) by lia. rewrite !mult_IZR, plus_IZR, <- INR_IZR_INZ.
      reflexivity. }
  rewrite T. set (q := 4 * (INR n + 8) * u * most). set (t := fl q). set (r := fl (t + 2 * INR n * eta)).
  assert (UM : 0 <= u * most) by (apply Rmult_le_pos; lra).
  assert (NUM : 0 <= INR n * (u * most)) by (apply Rmult_le_pos; lra).
  assert (Q0 : 0 <= q) by (unfold q; replace (4 * (INR n + 8) * u * most) with (4 * (INR n * (u * most)) + 32 * (u *
    most)) by ring; lra).
  assert (QM : q <= / 4 * most).
  { unfold q. replace (4 * (INR n + 8) * u * most) with (4 * ((INR n + 8) * u) * most) by ring.
    apply Rmult_le_compat_r; lra. }
  pose proof (fl_error prec emin q) as ET. fold t in ET. rewrite (Rabs_pos_eq q) in ET by exact Q0.
  apply Rabs_le_inv in ET.
  assert (N2 : number (2 * INR n * eta)).
  { replace (2 * INR n * eta) with (IZR (2 * Z.of_nat n) * eta) by (rewrite mult_IZR, <- INR_IZR_INZ; ring).
    apply (scaled_number prec emin); lia. }
  assert (NE : 0 <= INR n * eta) by (apply Rmult_le_pos; lra).
  pose proof (fl_plus_error prec emin t (2 * INR n * eta) (fl_number prec emin q) N2) as ER. fold r in ER.
  assert (T0 : 0 <= t) by (apply (fl_nonnegative prec emin); exact Q0).
  rewrite (Rabs_pos_eq (t + _)) in ER by lra. apply Rabs_le_inv in ER.
  pose proof (fl_plus_error prec emin s r NSum (fl_number prec emin _)) as EF.
  assert (UQ : u * q <= / 16777216 * q) by (apply Rmult_le_compat_r; lra).
  assert (UQ2 : u * q <= u * (/ 4 * most)) by (apply Rmult_le_compat_l; lra).
  assert (UT : u * (t + 2 * INR n * eta) <= u * (q + u * q + eta / 2 + 2 * INR n * eta))
    by (apply Rmult_le_compat_l; lra).
  assert (UE : u * eta <= / 16777216 * eta) by (apply Rmult_le_compat_r; lra).
  assert (UNE : INR n * u * eta <= / 16 * eta).
  { apply Rmult_le_compat_r; [lra |]. assert (INR n * u <= (INR n + 8) * u) by (apply Rmult_le_compat_r; lra). lra. }
  assert (UUQ : u * (u * q) <= / 16777216 * (u * q)) by (apply Rmult_le_compat_r; [apply Rmult_le_pos |]; lra).
  (* all that is added is at most 3 most, and little *)
  assert (GXM : growth (n + 4) * X <= / 7 * most).
  { apply Rle_trans with (1 := GX). replace (17 / 16 * ((INR n + 4) * u) * (2 * most))
      with (17 / 8 * ((INR n + 4) * u) * most) by field. apply Rmult_le_compat_r; [lra |].
    rewrite plus_INR in K. replace (INR 4) with 4 in K by (simpl; ring). lra. }
  assert (Rs : Rabs (s + r) <= 3 * most + (4 * INR n + 1) * eta).
  { assert (R0 : 0 <= r) by (apply (fl_nonnegative prec emin); lra).
    assert (R1 : r <= q + 3 * (INR n * eta) + eta + / 16 * most) by lra.
    assert (S1 : Rabs s <= 2.2 * most + 1.07 * (INR n * eta)) by (apply Rabs_le; lra).
    apply Rabs_le_inv in S1. apply Rabs_le. lra. }
  assert (Us : u * Rabs (s + r) <= u * (3 * most + (4 * INR n + 1) * eta)) by (apply Rmult_le_compat_l; lra).
  apply Rabs_le_inv in EF.
  replace (u * (3 * most + (4 * INR n + 1) * eta)) with (3 * (u * most) + 4 * (INR n * u * eta) + u * eta) in Us by
    ring.
  replace (17 / 16 * ((INR n + 4) * u) * (2 * most)) with (17 / 8 * (INR n * (u * most)) + 17 / 2 * (u * most)) in GX
    by field.
  replace (u * (q + u * q + eta / 2 + 2 * INR n * eta))
    with (u * q + u * (u * q) + u * eta / 2 + 2 * (INR n * u * eta)) in UT by field.
  assert (QE : q = 4 * (INR n * (u * most)) + 32 * (u * most)) by (unfold q; ring).
  assert (NEE : eta <= INR n * eta) by (rewrite <- (Rmult_1_l eta) at 1; apply Rmult_le_compat_r; lra).
  lra.
Qed.
End Real.

Section Ieee.
Variables prec emin : Z.
Context {format : Format prec emin}.
Notation u := (u prec).
Notation real_ops := (real_ops prec emin).
Context {num : Type} {o : ops num} {view : num -> value}.
Variable I : ieee prec emin o view.
Notation finite := (finite (view := view)).
Notation val := (val (view := view)).
Notation entry := (entry (num := num)).
Notation entry_value := (entry_value (view := view)).

Lemma min_value x y : finite x -> finite y ->
  finite (min o x y) /\ val (min o x y) = min real_ops (val x) (val y).
Proof.
  intros X Y. unfold min. rewrite (less_finite prec emin I y x Y X). cbn [less real_model.real_ops].
  destruct Rlt_bool; auto.
Qed.

Lemma state_value nodes : Forall (fun e => finite (entry_b e)) nodes -> forall most second,
  finite most -> finite second ->
  let r := fold_left (mean_step o) nodes (most, second) in
  finite (fst r) /\ finite (snd r) /\
  (val (fst r), val (snd r)) = fold_left (mean_step real_ops) (map entry_value nodes) (val most, val second).
Proof.
  induction 1 as [| e nodes B F IH]; intros most second M S; cbn [fold_left map]; [auto |].
  destruct (min_value (entry_b e) most B M) as [F1 V1].
  destruct (max_finite prec emin I most (entry_b e) M B) as [F2 _].
  destruct (max_finite prec emin I second _ S F1) as [F3 _].
  destruct (IH _ _ F2 F3) as (R1 & R2 & R3). split; [exact R1 |]. split; [exact R2 |]. cbv zeta in R3 |- *.
  unfold mean_step at 2 4. rewrite R3, !(max_value prec emin I), V1 by assumption. reflexivity.
Qed.

Lemma most_is_greatest nodes : forall most second,
  fst (fold_left (mean_step o) nodes (most, second)) = greatest o most (map (fun e => entry_b e) nodes).
Proof. unfold greatest. induction nodes as [| e nodes IH]; intros most second; [reflexivity |]. apply IH. Qed.

Lemma mean_sum_backward second nodes : forall s, finite second ->
  finite (fold_left (fun s n => add o s (mean_term o second n)) nodes s) ->
  finite s /\ val (fold_left (fun s n => add o s (mean_term o second n)) nodes s) =
  fold_left (fun s n => add real_ops s (mean_term real_ops (val second) n)) (map entry_value nodes) (val s).
Proof.
  induction nodes as [| e nodes IH]; intros s S F; cbn [fold_left map] in *; [auto |].
  destruct (IH _ S F) as [A ->]. apply (add_backward prec emin I) in A. destruct A as (Fs & A & ->).
  split; [exact Fs |]. unfold mean_term in A |- *. apply (add_backward prec emin I) in A. destruct A as (A & B & ->).
  apply (mul_backward prec emin I) in A, B. destruct A as (_ & A & ->). destruct B as (B & C & ->).
  apply (sub_backward prec emin I) in B. destruct B as (_ & _ & ->).
  destruct (zero_value prec emin I) as [FZ VZ]. rewrite (max_value prec emin I _ _ A FZ), VZ.
  apply (sub_backward prec emin I) in A. destruct A as (_ & _ & ->). rewrite model_zero. reflexivity.
Qed.

Lemma mean_error_backward n most : (0 <= n)%Z -> (2 * (n + 8) < 2 ^ prec)%Z -> finite (mean_error o n most) ->
  val (mean_error o n most) = mean_error real_ops n (val most).
Proof.
  intros N B F. destruct (exponents prec emin) as (E & E1 & E2 & E3 & P). unfold mean_error in *.
  rewrite (law_precision _ _ _ _ I) in *.
  apply (add_backward prec emin I) in F. destruct F as (F & _ & ->).
  apply (mul_backward prec emin I) in F. destruct F as (F & _ & ->).
  apply (mul_backward prec emin I) in F. destruct F as (F & _ & ->).
  apply (add_backward prec emin I) in F. destruct F as (_ & _ & ->).
  rewrite (proj2 (smallest_value prec emin I (2 * n) ltac:(lia))).
  rewrite (proj2 (constant_value prec emin I n 0 ltac:(lia) ltac:(lia))).
  rewrite (proj2 (constant_value prec emin I 8 0 ltac:(lia) ltac:(lia))).
  rewrite (proj2 (constant_value prec emin I 1 (2 - prec) ltac:(lia) ltac:(lia))). reflexivity.
Qed.

(* Of c_j >= 0, +infinity among them, a finite result is at least every mean of W'. *)
Theorem greatest_mean_sound nodes weights :
  Forall (fun e => 0 <= val (entry_l e) <= val (entry_h e) /\ val (entry_h e) <= 1 /\
                   (finite (entry_b e) /\ 0 <= val (entry_b e) \/ view (entry_b e) = Plus)) nodes ->
  INR (length nodes + 8) * u <= / 16 ->
  map fst weights = map (fun e => node_of_entry (entry_value e)) nodes -> in_space weights ->
  finite (greatest_mean o nodes) ->
  Forall (fun e => finite (entry_b e)) nodes /\ mean weights <= val (greatest_mean o nodes).
Proof.
  intros H Sm E W F. unfold greatest_mean in *. destruct (zero_value prec emin I) as [FZ VZ].
  pose proof (most_is_greatest nodes (zero o) (zero o)) as MG. pose proof (state_value nodes) as SV.
  destruct (fold_left (mean_step o) nodes (zero o, zero o)) as [most second] eqn:St. cbn [fst] in MG.
  assert (FP : Forall (fun b => finite b \/ view b = Plus) (zero o :: map (fun e => entry_b e) nodes)).
  { constructor; [now left |]. apply Forall_map. apply Forall_impl with (2 := H).
    intros e (_ & _ & [[P _] | P]); [now left | now right]. }
  assert (G : forall s t, Forall (fun b => finite b \/ view b = Plus) (s :: t) ->
                finite (greatest o s t) \/ view (greatest o s t) = Plus).
  { intros s t. revert s. induction t as [| a t IH]; intros s K; unfold greatest; cbn [fold_left];
      inversion K as [| ? ? Hs K']; subst; [exact Hs |]. apply IH. inversion K' as [| ? ? Ha Ht]; subst.
    constructor; [unfold max; destruct (less o s a); assumption | exact Ht]. }
  assert (FM : finite most).
  { destruct (G _ _ FP) as [K | K]; rewrite <- MG in K; [exact K |]. exfalso.
    rewrite (law_less _ _ _ _ I most), K, (law_infinity _ _ _ _ I) in F. cbn [less_value negb orb] in F. destruct F
      as [r F]. congruence. }
  assert (FB : Forall (fun e => finite (entry_b e)) nodes).
  { rewrite MG in FM. pose proof (greatest_finite prec emin I _ _ FP FM) as K. apply Forall_inv_tail in K.
    rewrite Forall_map in K. apply Forall_impl with (2 := K). intros e [P _]. exact P. }
  split; [exact FB |]. destruct (SV FB _ _ FZ FZ) as (_ & FS & V). rewrite St, VZ in V. rewrite St in FS.
  cbn [fst snd] in V, FS. clear SV.
  assert (ME : Forall (mean_entry prec emin) (map entry_value nodes)).
  { apply Forall_map. rewrite Forall_forall in H, FB |- *. intros e Ie. destruct (H e Ie) as (P & Q & R).
    split; [apply (val_number prec emin I) |]. split; [apply (val_number prec emin I) |]. split; [exact P |].
    split; [exact Q |]. split; [apply (val_number prec emin I) |].
    destruct R as [[_ R] | R]; [exact R |]. destruct (FB e Ie) as [r K]. congruence. }
  assert (Len : length (map entry_value nodes) = length nodes) by apply map_length.
  rewrite <- (map_map entry_value node_of_entry) in E.
  rewrite <- Len in Sm. pose proof (mean_value prec emin _ weights ME Sm E W) as M. cbv zeta in M.
  rewrite <- V in M. cbn [fst snd] in M. destruct M as [M1 M2].
  destruct (negb _ || _); [exact M1 |]. unfold min in *. destruct less; [| exact M1].
  apply (add_backward prec emin I) in F. destruct F as (F1 & F2 & ->).
  destruct (mean_sum_backward second nodes second FS F1) as [_ VS].
  replace (val (mean_sum o second nodes)) with (mean_sum real_ops (val second) (map entry_value nodes))
    by (symmetry; exact VS).
  pose proof (u_positive prec) as U. rewrite Len in Sm.
  rewrite mean_error_backward; [| apply Zle_0_nat | | exact F2].
  - unfold length_of in M2 |- *. rewrite Len in M2. exact M2.
  - pose proof (@prec_large prec emin format). apply lt_IZR. unfold length_of.
    rewrite IZR_power, mult_IZR, plus_IZR, <- INR_IZR_INZ by lia.
    assert (HU : u * bpow radix2 prec = 1)
      by (unfold u, rounding.u; rewrite <- bpow_plus, Z.add_opp_diag_l; reflexivity).
    pose proof (bpow_gt_0 radix2 prec). rewrite plus_INR in Sm. replace (INR 8) with 8 in Sm by (simpl; ring).
    assert ((INR (length nodes) + 8) * (u * bpow radix2 prec) <= / 16 * bpow radix2 prec)
      by (rewrite <- Rmult_assoc; apply Rmult_le_compat_r; lra). rewrite HU in *. lra.
Qed.
End Ieee.
