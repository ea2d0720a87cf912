(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* The filter of orientation() in three dimensions over IEEE values: for finite coordinates nothing that decides has
   overflowed, so that it decides as the exact determinant does. *)
From Coq Require Import Reals Lra Lia ZArith List Bool.
From Flocq Require Import Core.
From CinchProof Require Import rounding approximation model real_model extremum ieee ieee_forward ieee_extremum
  ieee_bound_box orientation.
Import ListNotations.
Open Scope R_scope.

Section Ieee_orientation.
Variables prec emin : Z.
Context {format : Format prec emin}.
Notation fl := (fl prec emin).
Notation real_ops := (real_ops prec emin).
Context {num : Type} {o : ops num} {view : num -> value}.
Variable I : ieee prec emin o view.
Notation finite := (finite (view := view)).
Notation val := (val (view := view)).
Notation triple_value := (triple_value (view := view)).

Definition top : Z := (- emin - prec)%Z.
(* Finite and at most 2^k. *)
Definition small (k : Z) (x : num) : Prop := finite x /\ Rabs (val x) <= bpow radix2 k.

Lemma fl_small k z : (0 <= k)%Z -> Rabs z <= bpow radix2 k -> Rabs (fl z) <= bpow radix2 k.
Proof.
  intros K B. rewrite <- (fl_abs prec emin). apply (fl_below prec emin); [exact B |].
  apply (power_number prec emin). pose proof (@prec_large prec emin format).
  pose proof (@emin_small prec emin format). lia.
Qed.

Lemma not_beyond k r : (0 <= k <= top)%Z -> Rabs r <= bpow radix2 k ->
  ~ (forall y c, view y = Finite c -> Rabs c < Rabs r).
Proof.
  intros K B H. specialize (H _ _ (law_power _ _ _ _ I k ltac:(unfold top in K; lia))).
  rewrite Rmult_1_l, Rabs_pos_eq in H by apply bpow_ge_0. lra.
Qed.

Lemma weaken_small j k x : (j <= k)%Z -> small j x -> small k x.
Proof. intros L [F B]. split; [exact F |]. apply Rle_trans with (1 := B). now apply bpow_le. Qed.

Lemma add_small k x y : (0 <= k)%Z -> (k + 1 <= top)%Z -> small k x -> small k y -> small (k + 1) (add o x y).
Proof.
  intros K T [X A] [Y B].
  assert (S : Rabs (fl (val x + val y)) <= bpow radix2 (k + 1)).
  { apply fl_small; [lia |]. rewrite bpow_plus. change (bpow radix2 1) with 2.
    pose proof (Rabs_triang (val x) (val y)). lra. }
  destruct (law_add _ _ _ _ I x y _ _ (view_val _ X) (view_val _ Y)) as [E | [E _]].
  - apply val_is in E. destruct E as [F V]. split; [exact F | now rewrite V].
  - exfalso. exact (not_beyond (k + 1) _ ltac:(lia) S E).
Qed.
Lemma sub_small k x y : (0 <= k)%Z -> (k + 1 <= top)%Z -> small k x -> small k y -> small (k + 1) (sub o x y).
Proof.
  intros K T [X A] [Y B].
  assert (S : Rabs (fl (val x - val y)) <= bpow radix2 (k + 1)).
  { apply fl_small; [lia |]. rewrite bpow_plus. change (bpow radix2 1) with 2.
    pose proof (Rabs_triang (val x) (- val y)) as Tr. rewrite Rabs_Ropp in Tr. unfold Rminus. lra. }
  destruct (law_sub _ _ _ _ I x y _ _ (view_val _ X) (view_val _ Y)) as [E | [E _]].
  - apply val_is in E. destruct E as [F V]. split; [exact F | now rewrite V].
  - exfalso. exact (not_beyond (k + 1) _ ltac:(lia) S E).
Qed.
Lemma mul_small j k x y : (0 <= j)%Z -> (0 <= k)%Z -> (j + k <= top)%Z -> small j x -> small k y ->
  small (j + k) (mul o x y).
Proof.
  intros J K T [X A] [Y B].
  assert (S : Rabs (fl (val x * val y)) <= bpow radix2 (j + k)).
  { apply fl_small; [lia |]. rewrite bpow_plus, Rabs_mult. apply Rmult_le_compat; trivial; apply Rabs_pos. }
  destruct (law_mul _ _ _ _ I x y _ _ (view_val _ X) (view_val _ Y)) as [E | E].
  - apply val_is in E. destruct E as [F V]. split; [exact F | now rewrite V].
  - exfalso. exact (not_beyond (j + k) _ ltac:(lia) S E).
Qed.

(* Determinants of small differences. *)
Definition all_small (k : Z) (t : triple num) : Prop := small k (at0 t) /\ small k (at1 t) /\ small k (at2 t).

Lemma minor_small k a b c d : (0 <= k)%Z -> (2 * k + 1 <= top)%Z -> small k a -> small k b -> small k c -> small k d ->
  small (2 * k + 1) (minor o a b c d).
Proof.
  intros K T A B C D. unfold minor. replace (2 * k)%Z with (k + k)%Z in * by lia.
  apply sub_small; [lia | exact T | |]; apply mul_small; trivial; lia.
Qed.

Lemma determinant_small k p q r : (0 <= k)%Z -> (3 * k + 3 <= top)%Z -> all_small k p -> all_small k q -> all_small k
  r ->
  finite (determinant3 o p q r).
Proof.
  intros K T (P0 & P1 & P2) (Q0 & Q1 & Q2) (R0 & R1 & R2).
  assert (M : forall a m, small k a -> small (2 * k + 1) m -> small (3 * k + 1) (mul o a m)).
  { intros a m A B. replace (3 * k + 1)%Z with (k + (2 * k + 1))%Z by lia. apply mul_small; trivial; lia. }
  assert (F : small (3 * k + 1 + 1 + 1) (determinant3 o p q r)); [| apply F].
  unfold determinant3. apply add_small; [lia | lia | |].
  - apply sub_small; [lia | lia | |]; apply M; trivial; apply minor_small; trivial; lia.
  - apply (weaken_small (3 * k + 1)); [lia |]. apply M; trivial. apply minor_small; trivial; lia.
Qed.

(* Finite results are those of the model over real numbers. *)
Lemma minor_backward a b c d : finite (minor o a b c d) ->
  val (minor o a b c d) = minor real_ops (val a) (val b) (val c) (val d).
Proof.
  unfold minor. intros F. apply (sub_backward prec emin I) in F. destruct F as (F & G & ->).
  apply (mul_backward prec emin I) in F, G. destruct F as (_ & _ & ->). destruct G as (_ & _ & ->). reflexivity.
Qed.
Lemma determinant_backward p q r : finite (determinant3 o p q r) ->
  val (determinant3 o p q r) = determinant3 real_ops (triple_value p) (triple_value q) (triple_value r).
Proof.
  unfold determinant3. intros F. apply (add_backward prec emin I) in F. destruct F as (F & F2 & ->).
  apply (sub_backward prec emin I) in F. destruct F as (F0 & F1 & ->).
  apply (mul_backward prec emin I) in F0, F1, F2. destruct F0 as (_ & F0 & ->). destruct F1 as (_ & F1 & ->).
  destruct F2 as (_ & F2 & ->). rewrite (minor_backward _ _ _ _ F0), (minor_backward _ _ _ _ F1),
    (minor_backward _ _ _ _ F2).
  reflexivity.
Qed.

(* A difference of finite numbers is finite, or its magnitude is +infinity. *)
Lemma magnitude_of_difference x y : finite x -> finite y ->
  finite (absolute o (sub o x y)) \/ view (absolute o (sub o x y)) = Plus.
Proof.
  intros X Y. unfold ieee.finite. rewrite (law_absolute _ _ _ _ I).
  destruct (law_sub _ _ _ _ I x y _ _ (view_val _ X) (view_val _ Y)) as [E | [_ E]]; rewrite E.
  - left. eexists. reflexivity.
  - right. destruct Rlt_bool; reflexivity.
Qed.

(* What the greatest of a coordinate says of its differences, if it is at most a finite number. *)
Lemma greatest_bounds a0 x y z w : finite a0 -> finite x -> finite y -> finite z -> finite w ->
  let p := sub o x a0 in let q := sub o y a0 in let r := sub o z a0 in
  less_equal o (greatest3 o p q r) w = true ->
  finite p /\ finite q /\ finite r /\
  val (greatest3 o p q r) = greatest3 real_ops (val p) (val q) (val r) /\
  finite (greatest3 o p q r) /\ val (greatest3 o p q r) <= val w /\
  Rabs (val p) <= val w /\ Rabs (val q) <= val w /\ Rabs (val r) <= val w.
Proof.
  intros A X Y Z0 W p q r L. pose proof (magnitude_of_difference x a0 X A) as P.
  pose proof (magnitude_of_difference y a0 Y A) as Q. pose proof (magnitude_of_difference z a0 Z0 A) as R.
  fold p in P. fold q in Q. fold r in R.
  assert (G : greatest3 o p q r = greatest o (absolute o p) [absolute o q; absolute o r]) by reflexivity.
  assert (FG : finite (greatest3 o p q r)).
  { rewrite (law_less_equal _ _ _ _ I), (view_val _ W) in L.
    assert (V : finite (greatest3 o p q r) \/ view (greatest3 o p q r) = Plus).
    { unfold greatest3, max. destruct (less o (absolute o p) (absolute o q));
        [destruct (less o (absolute o q) (absolute o r)) | destruct (less o (absolute o p) (absolute o r))];
          assumption. }
    destruct V as [V | V]; [exact V |]. rewrite V in L. discriminate. }
  rewrite G in FG |- *.
  pose proof (greatest_finite prec emin I [absolute o q; absolute o r] (absolute o p)
                (Forall_cons _ P (Forall_cons _ Q (Forall_cons _ R (Forall_nil _)))) FG) as B.
  inversion B as [| ? ? [Fp Lp] B1]; subst. inversion B1 as [| ? ? [Fq Lq] B2]; subst.
  inversion B2 as [| ? ? [Fr Lr] _]; subst.
  assert (LW : val (greatest o (absolute o p) [absolute o q; absolute o r]) <= val w).
  { rewrite <- G in FG |- *. rewrite (law_less_equal _ _ _ _ I), (view_val _ FG), (view_val _ W) in L. cbn in L.
    revert L. case Rle_bool_spec; [trivial | discriminate]. }
  pose proof (absolute_backward prec emin I p Fp) as (Pf & Vp).
  pose proof (absolute_backward prec emin I q Fq) as (Qf & Vq).
  pose proof (absolute_backward prec emin I r Fr) as (Rf & Vr). rewrite Vp in Lp. rewrite Vq in Lq. rewrite Vr in Lr.
  split; [exact Pf |]. split; [exact Qf |]. split; [exact Rf |]. split; [| split; [exact FG |]; lra].
  rewrite <- G. unfold greatest3. cbn [absolute real_model.real_ops]. rewrite <- Vp, <- Vq, <- Vr.
  assert (MM : forall a b, finite a -> finite b -> finite (max o a b) /\
    val (max o a b) = max real_ops (val a) (val b)).
  { intros a b Fa Fb. unfold max. rewrite (less_finite prec emin I a b Fa Fb). cbn [less real_model.real_ops].
    destruct Rlt_bool; auto. }
  destruct (MM _ _ Fp Fq) as [F1 V1]. destruct (MM _ _ F1 Fr) as [_ V2]. now rewrite V2, V1.
Qed.

Ltac open_signs :=
  cbn [orb]; unfold sign_is, exact3, exact_difference, ieee_extremum.triple_value; cbn [at0 at1 at2].

Theorem filter3_sound range a b c d : range_ok prec emin range -> (3 * range + 3 <= top)%Z ->
  all_finite (view := view) a -> all_finite (view := view) b -> all_finite (view := view) c ->
  all_finite (view := view) d ->
  sign_is (filter3 o range a b c d)
          (exact3 (exact_difference (triple_value a) (triple_value b)) (exact_difference (triple_value a)
            (triple_value c))
                  (exact_difference (triple_value a) (triple_value d))).
Proof.
  intros R T (A0 & A1 & A2) (B0 & B1 & B2) (C0 & C1 & C2) (D0 & D1 & D2).
  destruct (zero_value prec emin I) as [Z0 V0]. pose proof (two_power_large prec emin) as U.
  set (x := exact_difference (triple_value a) (triple_value b)).
  set (y := exact_difference (triple_value a) (triple_value c)).
  set (z := exact_difference (triple_value a) (triple_value d)).
  (* a greatest difference of at most 0 *)
  assert (N : forall e, number prec emin (val e)) by (intros e; apply (val_number prec emin I)).
  assert (Zero_of : forall a0 x0 y0 z0, finite a0 -> finite x0 -> finite y0 -> finite z0 ->
    less_equal o (greatest3 o (sub o x0 a0) (sub o y0 a0) (sub o z0 a0)) (zero o) = true ->
    val x0 - val a0 = 0 /\ val y0 - val a0 = 0 /\ val z0 - val a0 = 0).
  { intros a0 x0 y0 z0 Fa Fx Fy Fz L.
    destruct (greatest_bounds a0 x0 y0 z0 (zero o) Fa Fx Fy Fz Z0 L) as (P & Q & S & _ & _ & _ & LP & LQ & LS).
    rewrite V0 in *. apply (sub_backward prec emin I) in P, Q, S. destruct P as (_ & _ & VP).
    destruct Q as (_ & _ & VQ).
    destruct S as (_ & _ & VS). rewrite VP in LP. rewrite VQ in LQ. rewrite VS in LS.
    split; [| split]; apply (difference_zero prec emin _ _ 0); trivial; lra. }
  pose proof (Zero_of _ _ _ _ A0 B0 C0 D0) as N0. pose proof (Zero_of _ _ _ _ A1 B1 C1 D1) as N1.
  pose proof (Zero_of _ _ _ _ A2 B2 C2 D2) as N2.
  unfold filter3. set (p := difference o a b). set (q := difference o a c). set (r := difference o a d).
  unfold filtered_sign. cbn [existsb forallb fold_left]. rewrite !orb_false_r, !andb_true_r.
  destruct (less_equal o (greatest3 o (at0 p) (at0 q) (at0 r)) (zero o)) eqn:E0.
  { destruct (N0 E0) as (H1 & H2 & H3). unfold x, y, z. open_signs. rewrite H1, H2, H3. ring. }
  destruct (less_equal o (greatest3 o (at1 p) (at1 q) (at1 r)) (zero o)) eqn:E1.
  { destruct (N1 E1) as (H1 & H2 & H3). unfold x, y, z. open_signs. rewrite H1, H2, H3. ring. }
  destruct (less_equal o (greatest3 o (at2 p) (at2 q) (at2 r)) (zero o)) eqn:E2.
  { destruct (N2 E2) as (H1 & H2 & H3). unfold x, y, z. open_signs. rewrite H1, H2, H3. ring. }
  cbn [orb]. destruct (_ && _) eqn:In; [| exact Logic.I].
  pose proof (@prec_large prec emin format) as PL. pose proof (@emin_small prec emin format) as ES.
  destruct R as [R0 RE].
  destruct (val_is _ _ (law_power _ _ _ _ I range ltac:(unfold top in T; lia))) as [WF WV]. rewrite Rmult_1_l in WV.
  destruct (constant_value prec emin I 1 (- range) ltac:(change (Z.abs 1) with 1%Z; lia) ltac:(unfold top in T;
    lia)) as [LF LV].
  rewrite Rmult_1_l in LV.
  apply andb_prop in In. destruct In as [I0 In]. apply andb_prop in In. destruct In as [I1 I2].
  apply andb_prop in I0, I1, I2. destruct I0 as [J0 I0]. destruct I1 as [J1 I1]. destruct I2 as [J2 I2].
  destruct (greatest_bounds _ _ _ _ _ A0 B0 C0 D0 WF I0) as (P0 & Q0 & S0 & G0 & F0 & H0 & BP0 & BQ0 & BS0).
  destruct (greatest_bounds _ _ _ _ _ A1 B1 C1 D1 WF I1) as (P1 & Q1 & S1 & G1 & F1 & H1 & BP1 & BQ1 & BS1).
  destruct (greatest_bounds _ _ _ _ _ A2 B2 C2 D2 WF I2) as (P2 & Q2 & S2 & G2 & F2 & H2 & BP2 & BQ2 & BS2).
  rewrite WV in *.
  assert (SP : all_small range p) by (split; [| split]; split; assumption).
  assert (SQ : all_small range q) by (split; [| split]; split; assumption).
  assert (SR : all_small range r) by (split; [| split]; split; assumption).
  pose proof (determinant_small range p q r R0 T SP SQ SR) as FD. pose proof (determinant_backward p q r FD) as VD.
  (* the error bound *)
  set (g0 := greatest3 o (at0 p) (at0 q) (at0 r)) in *. set (g1 := greatest3 o (at1 p) (at1 q) (at1 r)) in *.
  set (g2 := greatest3 o (at2 p) (at2 q) (at2 r)) in *.
  change (greatest3 o (sub o (at0 b) (at0 a)) (sub o (at0 c) (at0 a)) (sub o (at0 d) (at0 a))) with g0 in *.
  change (greatest3 o (sub o (at1 b) (at1 a)) (sub o (at1 c) (at1 a)) (sub o (at1 d) (at1 a))) with g1 in *.
  change (greatest3 o (sub o (at2 b) (at2 a)) (sub o (at2 c) (at2 a)) (sub o (at2 d) (at2 a))) with g2 in *.
  rewrite (law_precision _ _ _ _ I).
  destruct (constant_value prec emin I 49 (- prec) ltac:(lia) ltac:(lia)) as [CF CV].
  assert (Low : forall g, finite g -> less_equal o (constant o 1 (- range)) g = true -> bpow radix2 (- range) <= val g).
  { intros g Fg L. rewrite (law_less_equal _ _ _ _ I), (view_val _ LF), (view_val _ Fg) in L. cbn in L. rewrite LV in L.
    revert L. case Rle_bool_spec; [trivial | discriminate]. }
  pose proof (Low g0 F0 J0) as L0. pose proof (Low g1 F1 J1) as L1. pose proof (Low g2 F2 J2) as L2.
  pose proof (bpow_gt_0 radix2 (- range)) as LP.
  assert (Sm : forall g, finite g -> bpow radix2 (- range) <= val g -> val g <= bpow radix2 range -> small range g)
    by (intros g Fg Lg Hg; split; [exact Fg | apply Rabs_le; lra]).
  assert (SC : small 0 (constant o 49 (- prec))).
  { split; [exact CF |]. rewrite CV. pose proof (u_small prec emin). pose proof (u_positive prec).
    change (bpow radix2 (- prec)) with (rounding.u prec). apply Rabs_le; simpl; lra. }
  pose proof (mul_small 0 range _ _ ltac:(lia) R0 ltac:(lia) SC (Sm g0 F0 L0 H0)) as M0.
  pose proof (mul_small (0 + range) range _ _ ltac:(lia) R0 ltac:(lia) M0 (Sm g1 F1 L1 H1)) as M1.
  pose proof (mul_small (0 + range + range) range _ _ ltac:(lia) R0 ltac:(lia) M1 (Sm g2 F2 L2 H2)) as [FE _].
  set (e := mul o (mul o (mul o (constant o 49 (- prec)) g0) g1) g2) in *.
  assert (VE : val e = fl (fl (fl (49 * rounding.u prec * val g0) * val g1) * val g2)).
  { unfold e in *. apply (mul_backward prec emin I) in FE. destruct FE as (FE & _ & ->).
    apply (mul_backward prec emin I) in FE. destruct FE as (FE & _ & ->).
    apply (mul_backward prec emin I) in FE. destruct FE as (_ & _ & ->). rewrite CV. reflexivity. }
  (* the same as over real numbers *)
  assert (NP : near prec emin (triple_value p) x (Triple (val g0) (val g1) (val g2)) /\
               near prec emin (triple_value q) y (Triple (val g0) (val g1) (val g2)) /\
               near prec emin (triple_value r) z (Triple (val g0) (val g1) (val g2))).
  { assert (Near1 : forall e0 f0 g x0 y0 z0, finite (sub o e0 f0) -> val g = greatest3 real_ops x0 y0 z0 ->
      (val (sub o e0 f0) = x0 \/ val (sub o e0 f0) = y0 \/ val (sub o e0 f0) = z0) ->
      approximates prec emin 1 (val (sub o e0 f0)) (val e0 - val f0) ((1 + rounding.u prec) * val g) 0).
    { intros e0 f0 g x0 y0 z0 F V H. destruct (greatest3_real prec emin x0 y0 z0) as (X1 & Y1 & W1).
      apply (sub_backward prec emin I) in F. destruct F as (_ & _ & VS). rewrite VS in *.
      apply (difference_approximates prec emin); trivial. rewrite V. destruct H as [-> | [-> | ->]]; assumption. }
    split; [| split].
    - exact (conj (Near1 _ _ _ _ _ _ P0 G0 (or_introl eq_refl))
        (conj (Near1 _ _ _ _ _ _ P1 G1 (or_introl eq_refl))
          (Near1 _ _ _ _ _ _ P2 G2 (or_introl eq_refl)))).
    - exact (conj (Near1 _ _ _ _ _ _ Q0 G0 (or_intror (or_introl eq_refl)))
        (conj (Near1 _ _ _ _ _ _ Q1 G1 (or_intror (or_introl eq_refl)))
          (Near1 _ _ _ _ _ _ Q2 G2 (or_intror (or_introl eq_refl))))).
    - exact (conj (Near1 _ _ _ _ _ _ S0 G0 (or_intror (or_intror eq_refl)))
        (conj (Near1 _ _ _ _ _ _ S1 G1 (or_intror (or_intror eq_refl)))
          (Near1 _ _ _ _ _ _ S2 G2 (or_intror (or_intror eq_refl))))). }
  destruct NP as (NP & NQ & NR).
  pose proof (determinant3_error prec emin _ _ _ _ _ _ (Triple (val g0) (val g1) (val g2))
                ltac:(simpl; lra) ltac:(simpl; lra) ltac:(simpl; lra) NP NQ NR) as E.
  cbn [at0 at1 at2] in E.
  pose proof (error3_at_least prec emin range _ _ _ (conj R0 RE) L0 L1 L2) as F.
  destruct (underflow_small prec emin range _ _ _ (conj R0 RE) L0 L1 L2) as (U1 & U2 & _).
  assert (UM : 0 <= rounding.u prec * (val g0 * (val g1 * val g2)))
    by (pose proof (u_positive prec); repeat apply Rmult_le_pos; lra).
  rewrite <- VE in F. rewrite <- VD in E.
  assert (Near : Rabs (val (determinant3 o p q r) - exact3 x y z) <= val e) by lra. apply Rabs_le_inv in Near.
  destruct (less o e (determinant3 o p q r)) eqn:Lt.
  - rewrite (less_finite prec emin I _ _ FE FD) in Lt. revert Lt. case Rlt_bool_spec; [| discriminate]. intros Lt _.
  simpl. lra.
  - destruct (less o (determinant3 o p q r) (sub o (zero o) e)) eqn:Gt; [| exact Logic.I].
    rewrite (law_less _ _ _ _ I), (view_val _ FD) in Gt.
    destruct (law_sub _ _ _ _ I _ _ _ _ (view_val _ Z0) (view_val _ FE)) as [Es | [Big _]].
    + rewrite Es in Gt. cbn in Gt. revert Gt. case Rlt_bool_spec; [| discriminate]. intros Gt _.
      rewrite V0 in Gt. unfold Rminus in Gt. rewrite Rplus_0_l, (fl_opp prec emin), (fl_id prec emin) in Gt by apply N.
      simpl. lra.
    + exfalso. specialize (Big _ _ (view_val _ FE)). rewrite V0 in Big. unfold Rminus in Big.
      rewrite Rplus_0_l, (fl_opp prec emin), Rabs_Ropp, (fl_id prec emin) in Big by apply N. lra.
Qed.
End Ieee_orientation.

(* In double, within the toolkit's range of 2^-320 to 2^320. *)
Corollary filter3_binary64 {num} (o : ops num) view (I : ieee 53 (-1074) o view) a b c d :
  all_finite (view := view) a -> all_finite (view := view) b -> all_finite (view := view) c ->
  all_finite (view := view) d ->
  sign_is (filter3 o 320 a b c d)
          (exact3 (exact_difference (triple_value (view := view) a) (triple_value (view := view) b))
                  (exact_difference (triple_value (view := view) a) (triple_value (view := view) c))
                  (exact_difference (triple_value (view := view) a) (triple_value (view := view) d))).
Proof. apply (filter3_sound 53 (-1074) I); [exact range_binary64 | unfold top; lia]. Qed.
