(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* IEEE values from operands to results: where nothing can overflow, results are finite. The greatest of values. *)
From Coq Require Import Reals Lra Lia ZArith List Bool.
From Flocq Require Import Core.
From CinchProof Require Import rounding successor model real_model ieee.
Import ListNotations.
Open Scope R_scope.

Section Forward.
Variables prec emin : Z.
Context {format : Format prec emin}.
Notation fl := (fl prec emin).
Notation number := (number prec emin).
Notation u := (u prec).
Notation eta := (eta emin).
Notation real_ops := (real_ops prec emin).
Context {num : Type} {o : ops num} {view : num -> value}.
Variable I : ieee prec emin o view.
Notation finite := (finite (view := view)).
Notation val := (val (view := view)).

(* 2^1020 in double. *)
Definition safe : R := bpow radix2 (- emin - prec - 1).
Lemma top_safe : bpow radix2 (2 - emin - prec) = 8 * safe.
Proof.
  unfold safe. replace (2 - emin - prec)%Z with (3 + (- emin - prec - 1))%Z by lia. rewrite bpow_plus.
  change (bpow radix2 3) with 8. reflexivity.
Qed.
Lemma safe_at_least_1 : 1 <= safe.
Proof.
  destruct (exponents prec emin) as (_ & _ & E & F & P). unfold safe. change 1 with (bpow radix2 0). apply bpow_le. lia.
Qed.
Lemma eta_below_safe : eta <= u * safe.
Proof.
  destruct (exponents prec emin) as (_ & _ & E & F & P). unfold safe, eta, u, rounding.eta, rounding.u.
  rewrite <- bpow_plus. apply bpow_le. lia.
Qed.
Lemma safe_number k : (0 <= k <= 3)%Z -> number (bpow radix2 k * safe).
Proof.
  intros K. destruct (exponents prec emin) as (_ & _ & E & F & P). unfold safe. rewrite <- bpow_plus.
  apply (power_number prec emin). lia.
Qed.
Lemma most_safe_value : finite (most_safe o) /\ val (most_safe o) = safe.
Proof.
  destruct (exponents prec emin) as (_ & _ & E & F & P). unfold most_safe.
  rewrite (law_least _ _ _ _ I), (law_precision _ _ _ _ I). apply val_is.
  rewrite (law_power _ _ _ _ I) by lia. now rewrite Rmult_1_l.
Qed.

Lemma not_beyond x : Rabs x <= 8 * safe -> ~ (forall z c, view z = Finite c -> Rabs c < Rabs (fl x)).
Proof.
  intros B H. destruct (exponents prec emin) as (_ & _ & E & F & P).
  specialize (H _ _ (law_power _ _ _ _ I (2 - emin - prec)%Z ltac:(lia))).
  rewrite Rmult_1_l, top_safe, Rabs_pos_eq in H by (pose proof safe_at_least_1; lra).
  rewrite <- (fl_abs prec emin) in H. pose proof (fl_below prec emin _ _ B (safe_number 3 ltac:(lia))). lra.
Qed.
Lemma add_forward x y : finite x -> finite y -> Rabs (val x + val y) <= 8 * safe ->
  finite (add o x y) /\ val (add o x y) = fl (val x + val y).
Proof.
  intros X Y B. apply val_is.
  destruct (law_add _ _ _ _ I x y _ _ (view_val x X) (view_val y Y)) as [H | [H _]]; [exact H |].
  now apply not_beyond in H.
Qed.
Lemma sub_forward x y : finite x -> finite y -> Rabs (val x - val y) <= 8 * safe ->
  finite (sub o x y) /\ val (sub o x y) = fl (val x - val y).
Proof.
  intros X Y B. apply val_is.
  destruct (law_sub _ _ _ _ I x y _ _ (view_val x X) (view_val y Y)) as [H | [H _]]; [exact H |].
  now apply not_beyond in H.
Qed.
Lemma mul_forward x y : finite x -> finite y -> Rabs (val x * val y) <= 8 * safe ->
  finite (mul o x y) /\ val (mul o x y) = fl (val x * val y).
Proof.
  intros X Y B. apply val_is.
  destruct (law_mul _ _ _ _ I x y _ _ (view_val x X) (view_val y Y)) as [H | H]; [exact H |].
  now apply not_beyond in H.
Qed.
Lemma divide_forward x y : finite x -> finite y -> val y <> 0 -> Rabs (val x / val y) <= 8 * safe ->
  finite (divide o x y) /\ val (divide o x y) = fl (val x / val y).
Proof.
  intros X Y N B. apply val_is.
  destruct (law_divide _ _ _ _ I x y _ _ (view_val x X) (view_val y Y) N) as [H | H]; [exact H |].
  now apply not_beyond in H.
Qed.
(* A factor of at most 1 overflows nothing. *)
Lemma mul_shrinks x y : finite x -> finite y -> Rabs (val x) <= 1 ->
  finite (mul o x y) /\ val (mul o x y) = fl (val x * val y) /\ Rabs (val (mul o x y)) <= Rabs (val y).
Proof.
  intros X Y L.
  assert (B : Rabs (fl (val x * val y)) <= Rabs (val y)).
  { rewrite <- (fl_abs prec emin). apply (fl_below prec emin).
    - rewrite Rabs_mult. pose proof (Rabs_pos (val y)).
      assert (Rabs (val x) * Rabs (val y) <= 1 * Rabs (val y)) by now apply Rmult_le_compat_r. lra.
    - apply (number_abs prec emin), (val_number prec emin I). }
  assert (H : finite (mul o x y) /\ val (mul o x y) = fl (val x * val y)).
  { apply val_is.
    destruct (law_mul _ _ _ _ I x y _ _ (view_val x X) (view_val y Y)) as [H | H]; [exact H |].
    specialize (H y _ (view_val y Y)). lra. }
  destruct H as [F V]. split; [exact F |]. split; [exact V |]. now rewrite V.
Qed.

Lemma max_value x y : finite x -> finite y -> val (max o x y) = max real_ops (val x) (val y).
Proof.
  intros X Y. unfold max. rewrite (less_finite prec emin I x y X Y). cbn [less real_model.real_ops].
  now destruct Rlt_bool.
Qed.

(* The greatest of values that are finite or +infinity, if it is finite. *)
Lemma greatest_finite others : forall b0,
  Forall (fun b => finite b \/ view b = Plus) (b0 :: others) -> finite (greatest o b0 others) ->
  Forall (fun b => finite b /\ val b <= val (greatest o b0 others)) (b0 :: others).
Proof.
  unfold greatest. induction others as [| b1 others IH]; intros b0 F G; cbn [fold_left] in *.
  - constructor; [| constructor]. split; [exact G | apply Rle_refl].
  - inversion F as [| ? ? F0 F' ]; subst. inversion F' as [| ? ? F1 F2]; subst.
    assert (M : finite (max o b0 b1) \/ view (max o b0 b1) = Plus) by (unfold max; destruct less; assumption).
    specialize (IH (max o b0 b1) (Forall_cons _ M F2) G). inversion IH as [| ? ? [FM LM] R]; subst.
    assert (H : finite b0 /\ finite b1).
    { unfold max in FM. rewrite (law_less _ _ _ _ I) in FM.
      destruct F0 as [[r0 E0] | E0], F1 as [[r1 E1] | E1]; rewrite E0, E1 in FM; simpl in FM.
      - split; [now exists r0 | now exists r1].
      - destruct FM as [r Er]. rewrite E1 in Er. discriminate.
      - destruct FM as [r Er]. rewrite E0 in Er. discriminate.
      - destruct FM as [r Er]. rewrite E0 in Er. discriminate. }
    destruct H as [H0 H1]. destruct (max_finite prec emin I b0 b1 H0 H1) as [_ V]. rewrite V in LM.
    pose proof (Rmax_l (val b0) (val b1)). pose proof (Rmax_r (val b0) (val b1)).
    constructor; [split; [exact H0 | lra] |]. constructor; [split; [exact H1 | lra] | exact R].
Qed.

(* The greatest of finite values by std::max, whatever it starts from, if it is finite. *)
Lemma fold_max_finite {A} (f : A -> num) s : forall r, Forall (fun a => finite (f a)) s ->
  let top := fold_left (fun r a => max o r (f a)) s r in
  finite top -> (finite r \/ view r = Minus) /\ (finite r -> val r <= val top) /\ Forall (fun a => val (f a) <= val
    top) s.
Proof.
  induction s as [| a s IH]; intros r F top T; unfold top in *; cbn [fold_left] in *.
  - split; [now left |]. split; [intros _; apply Rle_refl | constructor].
  - inversion F as [| ? ? Fa Fs]; subst. destruct (IH _ Fs T) as (R & L & G). clear IH.
    destruct (view r) eqn:E.
    + assert (Fr : finite r) by now exists r0. destruct (max_finite prec emin I r (f a) Fr Fa) as [Fm V].
      specialize (L Fm). rewrite V in L. pose proof (Rmax_l (val r) (val (f a))).
      pose proof (Rmax_r (val r) (val (f a))). split; [now left |]. split; [intros _; lra |]. constructor; [lra |
        exact G].
    + unfold max in R. rewrite (law_less _ _ _ _ I), E, (view_val _ Fa) in R. simpl in R.
      destruct R as [[q Q] | Q]; congruence.
    + assert (M : max o r (f a) = f a).
      { unfold max. now rewrite (law_less _ _ _ _ I), E, (view_val _ Fa). }
      rewrite M in *. specialize (L Fa). split; [now right |]. split; [intros [q Q]; congruence |].
      constructor; [exact L | exact G].
    + unfold max in R. rewrite (law_less _ _ _ _ I), E in R. simpl in R. destruct R as [[q Q] | Q]; congruence.
Qed.
End Forward.
