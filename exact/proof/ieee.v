(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* IEEE arithmetic as far as the proofs need it: values that are finite, infinite or no number, and what the operations
   make of them. Flocq's binary64 and binary32 fulfil the laws (ieee_instances.v). *)
From Coq Require Import Reals Lra Lia ZArith List Bool.
From Flocq Require Import Core.
From CinchProof Require Import rounding successor model real_model.
Import ListNotations.
Open Scope R_scope.

Inductive value := Finite (r : R) | Plus | Minus | Nan.

Definition nonnegative (v : value) : Prop := match v with Finite r => 0 <= r | Plus | Nan => True | Minus => False end.
Definition absolute_value (v : value) : value := match v with Finite r => Finite (Rabs r) | Minus => Plus | v => v end.
Definition less_value (v w : value) : bool :=
  match v, w with
  | Finite a, Finite b => Rlt_bool a b
  | Nan, _ | _, Nan => false
  | Minus, Minus => false | Minus, _ => true
  | _, Minus => false
  | Plus, _ => false
  | Finite _, Plus => true
  end.

Definition less_equal_value (v w : value) : bool :=
  match v, w with
  | Finite a, Finite b => Rle_bool a b
  | Nan, _ | _, Nan => false
  | Minus, _ => true
  | _, Minus => false
  | _, Plus => true
  | Plus, _ => false
  end.

Section Ieee.
Variables prec emin : Z.
Context {format : Format prec emin}.
Notation fl := (fl prec emin).
Notation number := (number prec emin).
Notation u := (u prec).
Notation eta := (eta emin).
Notation real_ops := (real_ops prec emin).

Record ieee {num : Type} (o : ops num) (view : num -> value) : Prop := {
  law_precision : precision o = prec;
  law_least : least o = emin;
  law_number x r : view x = Finite r -> number r;
  law_constant m e : (Z.abs m < 2 ^ prec)%Z -> (emin <= e <= 0)%Z ->
    view (constant o m e) = Finite (IZR m * bpow radix2 e);
  law_power e : (0 <= e <= 2 - emin - prec)%Z -> view (constant o 1 e) = Finite (1 * bpow radix2 e);
  law_infinity : view (infinity o) = Plus;
  (* Finite numbers give the rounded result, unless that is beyond every finite number. *)
  law_add x y a b : view x = Finite a -> view y = Finite b ->
    view (add o x y) = Finite (fl (a + b)) \/
    ((forall z c, view z = Finite c -> Rabs c < Rabs (fl (a + b))) /\
     view (add o x y) = if Rlt_bool (a + b) 0 then Minus else Plus);
  law_sub x y a b : view x = Finite a -> view y = Finite b ->
    view (sub o x y) = Finite (fl (a - b)) \/
    ((forall z c, view z = Finite c -> Rabs c < Rabs (fl (a - b))) /\
     view (sub o x y) = if Rlt_bool (a - b) 0 then Minus else Plus);
  law_mul x y a b : view x = Finite a -> view y = Finite b ->
    view (mul o x y) = Finite (fl (a * b)) \/
    (forall z c, view z = Finite c -> Rabs c < Rabs (fl (a * b)));
  law_divide x y a b : view x = Finite a -> view y = Finite b -> b <> 0 ->
    view (divide o x y) = Finite (fl (a / b)) \/
    (forall z c, view z = Finite c -> Rabs c < Rabs (fl (a / b)));
  (* A finite result has finite operands, and has not overflowed. *)
  law_add_finite x y r : view (add o x y) = Finite r ->
    exists a b, view x = Finite a /\ view y = Finite b /\ r = fl (a + b);
  law_sub_finite x y r : view (sub o x y) = Finite r ->
    exists a b, view x = Finite a /\ view y = Finite b /\ r = fl (a - b);
  law_mul_finite x y r : view (mul o x y) = Finite r ->
    exists a b, view x = Finite a /\ view y = Finite b /\ r = fl (a * b);
  law_add_nonnegative x y : nonnegative (view x) -> nonnegative (view y) -> nonnegative (view (add o x y));
  law_mul_nonnegative x y : nonnegative (view x) -> nonnegative (view y) -> nonnegative (view (mul o x y));
  law_add_minus x y : view (add o x y) = Minus -> view y <> Plus /\ view y <> Nan;
  law_absolute x : view (absolute o x) = absolute_value (view x);
  law_less x y : less o x y = less_value (view x) (view y);
  law_less_equal x y : less_equal o x y = less_equal_value (view x) (view y)
}.

Context {num : Type} {o : ops num} {view : num -> value}.
Variable I : ieee o view.

Definition finite (x : num) : Prop := exists r, view x = Finite r.
Definition val (x : num) : R := match view x with Finite r => r | _ => 0 end.

Lemma view_val x : finite x -> view x = Finite (val x).
Proof. intros [r E]. unfold val. now rewrite E. Qed.
Lemma val_is x r : view x = Finite r -> finite x /\ val x = r.
Proof. intros E. split; [now exists r | unfold val; now rewrite E]. Qed.
Lemma val_number x : number (val x).
Proof.
  unfold val. destruct (view x) eqn:E; try apply (number_0 prec emin). exact (law_number _ _ I x r E).
Qed.

Lemma add_backward x y : finite (add o x y) -> finite x /\ finite y /\ val (add o x y) = fl (val x + val y).
Proof.
  intros [r E]. destruct (law_add_finite _ _ I x y r E) as (a & b & A & B & ->).
  apply val_is in A, B, E. destruct A as [FA ->]. destruct B as [FB ->]. destruct E as [_ ->]. auto.
Qed.
Lemma sub_backward x y : finite (sub o x y) -> finite x /\ finite y /\ val (sub o x y) = fl (val x - val y).
Proof.
  intros [r E]. destruct (law_sub_finite _ _ I x y r E) as (a & b & A & B & ->).
  apply val_is in A, B, E. destruct A as [FA ->]. destruct B as [FB ->]. destruct E as [_ ->]. auto.
Qed.
Lemma mul_backward x y : finite (mul o x y) -> finite x /\ finite y /\ val (mul o x y) = fl (val x * val y).
Proof.
  intros [r E]. destruct (law_mul_finite _ _ I x y r E) as (a & b & A & B & ->).
  apply val_is in A, B, E. destruct A as [FA ->]. destruct B as [FB ->]. destruct E as [_ ->]. auto.
Qed.
Lemma absolute_backward x : finite (absolute o x) -> finite x /\ val (absolute o x) = Rabs (val x).
Proof.
  intros [r E]. rewrite (law_absolute _ _ I) in E. unfold finite, val. rewrite (law_absolute _ _ I).
  destruct (view x) as [a | | |]; try discriminate. split; [now exists a | reflexivity].
Qed.
Lemma absolute_forward x : finite x -> finite (absolute o x) /\ val (absolute o x) = Rabs (val x).
Proof.
  intros F. apply val_is. rewrite (law_absolute _ _ I), (view_val x F). reflexivity.
Qed.
Lemma absolute_nonnegative x : nonnegative (view (absolute o x)).
Proof. rewrite (law_absolute _ _ I). destruct (view x); simpl; trivial. apply Rabs_pos. Qed.

Lemma constant_value m e : (Z.abs m < 2 ^ prec)%Z -> (emin <= e <= 0)%Z ->
  finite (constant o m e) /\ val (constant o m e) = IZR m * bpow radix2 e.
Proof. intros M E. apply val_is. now apply (law_constant _ _ I). Qed.

Lemma exponents : (emin <= 0)%Z /\ (emin <= - prec)%Z /\ (emin <= 1 - 2 * prec)%Z /\ (1 - 2 * prec <= 0)%Z /\
  (24 <= prec)%Z.
Proof. pose proof (@prec_large prec emin format). pose proof (@emin_small prec emin format). lia. Qed.

Lemma two_power_large : (2 ^ 24 <= 2 ^ prec)%Z.
Proof. apply Z.pow_le_mono_r; [lia | exact (@prec_large prec emin format)]. Qed.

Lemma zero_value : finite (zero o) /\ val (zero o) = 0.
Proof.
  unfold zero. destruct exponents as (E & _). pose proof two_power_large.
  destruct (constant_value 0 0) as [F V]; [change (Z.abs 0) with 0%Z; lia | lia |]. split; [exact F |]. rewrite V.
  simpl. ring.
Qed.

Lemma smallest_value n : (Z.abs n < 2 ^ prec)%Z ->
  finite (smallest_times o n) /\ val (smallest_times o n) = smallest_times real_ops n.
Proof.
  intros N. unfold smallest_times. rewrite (law_least _ _ I). destruct exponents as (E & _).
  apply constant_value; [exact N | lia].
Qed.

Lemma unit_value : finite (unit_roundoff o) /\ val (unit_roundoff o) = unit_roundoff real_ops.
Proof.
  unfold unit_roundoff. rewrite (law_precision _ _ I). destruct exponents as (E & F & G & H & P).
  pose proof two_power_large.
  apply constant_value; lia.
Qed.

Lemma phi_value : finite (model.phi o) /\ val (model.phi o) = model.phi real_ops.
Proof.
  unfold model.phi. rewrite (law_precision _ _ I). destruct exponents as (E & F & G & H & P).
  apply constant_value; [| lia]. rewrite Z.abs_eq by (pose proof (Z.pow_nonneg 2 (prec - 1)); lia).
  replace prec with (prec - 1 + 1)%Z at 2 by lia. rewrite Z.pow_add_r by lia.
  assert (2 ^ 1 <= 2 ^ (prec - 1))%Z by (apply Z.pow_le_mono_r; lia). lia.
Qed.

(* Comparisons with infinity, as the code makes them. *)
Lemma below_infinity x : less o x (infinity o) = true -> finite x \/ view x = Minus.
Proof.
  rewrite (law_less _ _ I), (law_infinity _ _ I). unfold finite.
  destruct (view x) as [r | | |]; try discriminate; [left; now exists r | now right].
Qed.
Lemma nonnegative_below_infinity x : nonnegative (view x) -> less o x (infinity o) = true -> finite x /\ 0 <= val x.
Proof.
  intros N L. apply below_infinity in L. destruct L as [F | M]; [| rewrite M in N; contradiction].
  split; [exact F |]. destruct F as [r E]. unfold val. rewrite E in *. exact N.
Qed.
Lemma finite_below_infinity x : finite x -> less o x (infinity o) = true.
Proof. intros [r E]. rewrite (law_less _ _ I), (law_infinity _ _ I), E. reflexivity. Qed.
Lemma infinity_not_finite : ~ finite (infinity o).
Proof. intros [r E]. rewrite (law_infinity _ _ I) in E. discriminate. Qed.
Lemma less_finite x y : finite x -> finite y -> less o x y = Rlt_bool (val x) (val y).
Proof. intros F G. rewrite (law_less _ _ I), (view_val x F), (view_val y G). reflexivity. Qed.

Lemma max_finite x y : finite x -> finite y -> finite (max o x y) /\ val (max o x y) = Rmax (val x) (val y).
Proof.
  intros F G. unfold max. rewrite (less_finite x y F G). case Rlt_bool_spec; intros L.
  - split; [exact G |]. now rewrite Rmax_right by lra.
  - split; [exact F |]. now rewrite Rmax_left by lra.
Qed.

(* succ. *)
Lemma succ_backward x : finite (model.succ o x) -> finite x /\ val (model.succ o x) = model.succ real_ops (val x).
Proof.
  unfold model.succ. intros F. apply add_backward in F. destruct F as (X & S & V).
  split; [exact X |]. rewrite V.
  apply add_backward in S. destruct S as (P & _ & W). apply mul_backward in P. destruct P as (_ & A & Q).
  apply absolute_backward in A. destruct A as (_ & A). rewrite W, Q, A.
  rewrite (proj2 phi_value). destruct (smallest_value 1) as [_ S1].
  { pose proof two_power_large. change (Z.abs 1) with 1%Z. lia. }
  rewrite S1. reflexivity.
Qed.

(* succ gives a finite number, +infinity or no number, never -infinity: of -infinity it makes no number. *)
Lemma succ_below_infinity x : less o (model.succ o x) (infinity o) = true -> finite (model.succ o x).
Proof.
  intros L. apply below_infinity in L. destruct L as [F | M]; [exact F | exfalso].
  unfold model.succ in M. set (step := add o (mul o (model.phi o) (absolute o x)) (smallest_times o 1)) in *.
  assert (P1 : (Z.abs 1 < 2 ^ prec)%Z) by (pose proof two_power_large; change (Z.abs 1) with 1%Z; lia).
  destruct (smallest_value 1 P1) as [[e E] E1]. destruct phi_value as [Fp Vp].
  assert (N : nonnegative (view step)).
  { apply (law_add_nonnegative _ _ I).
    - apply (law_mul_nonnegative _ _ I); [| apply absolute_nonnegative]. rewrite (view_val _ Fp), Vp. simpl.
      apply Rmult_le_pos; [apply IZR_le; pose proof (Z.pow_nonneg 2 (prec - 1)); lia | apply bpow_ge_0].
    - rewrite (view_val _ (ex_intro _ e E)), E1, model_smallest. simpl. pose proof (eta_positive emin). lra. }
  destruct (law_add_minus _ _ I _ _ M) as [A B].
  destruct (view step) as [s | | |] eqn:S; try (simpl in N; contradiction); try congruence.
  assert (F : finite x).
  { assert (Fs : finite step) by now exists s. apply add_backward in Fs. destruct Fs as (Fm & _).
    apply mul_backward in Fm. destruct Fm as (_ & Fa & _). now apply absolute_backward in Fa. }
  destruct (law_add _ _ I x step _ _ (view_val x F) S) as [K | [K1 K2]]; [rewrite K in M; discriminate |].
  rewrite K2 in M. revert M. case Rlt_bool_spec; [| discriminate]. intros Neg _. simpl in N.
  specialize (K1 x _ (view_val x F)).
  assert (H : fl (val x + s) <= 0) by (rewrite <- (fl_0 prec emin); apply (fl_le prec emin); lra).
  assert (H2 : val x <= fl (val x + s)) by (apply (fl_above prec emin); [lra | apply val_number]).
  rewrite 2!Rabs_left1 in K1 by lra. lra.
Qed.
End Ieee.
