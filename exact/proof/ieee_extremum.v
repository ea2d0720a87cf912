(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* Extrema over IEEE values: where the magnitude is finite nothing on the way to an extremum overflows, but for its last
   sum, and that only to +infinity. *)
From Coq Require Import Reals Lra Lia ZArith List Bool.
From Flocq Require Import Core.
From CinchProof Require Import rounding successor model real_model extremum ieee.
Import ListNotations.
Open Scope R_scope.

Section Ieee_extremum.
Variables prec emin : Z.
Context {format : Format prec emin}.
Notation fl := (fl prec emin).
Notation real_ops := (real_ops prec emin).
Context {num : Type} {o : ops num} {view : num -> value}.
Variable I : ieee prec emin o view.
Notation finite := (finite (view := view)).
Notation val := (val (view := view)).

Definition triple_value (t : triple num) : triple R := Triple (val (at0 t)) (val (at1 t)) (val (at2 t)).
Definition row_value (r : row (num := num)) : row (num := R) := Row (triple_value (column r)) (val (offset r)).
Definition map_value (m : map_rows (num := num)) : map_rows (num := R) :=
  Triple (row_value (at0 m)) (row_value (at1 m)) (row_value (at2 m)).
Definition box_value (b : box (num := num)) : box (num := R) :=
  Box (triple_value (centre b)) (triple_value (half b)).

Lemma sign_value a : (-1 <= a <= 1)%Z ->
  finite (constant o a 0) /\ val (constant o a 0) = IZR a * bpow radix2 0.
Proof.
  intros A. pose proof (two_power_large prec emin). destruct (exponents prec emin) as (E & _).
  apply (constant_value prec emin I); lia.
Qed.

(* A finite result is that of the model over real numbers. *)
Lemma step_backward a x s : (-1 <= a <= 1)%Z -> finite (project_step o a x s) ->
  finite s /\ val (project_step o a x s) = project_step real_ops a (val x) (val s).
Proof.
  intros A. unfold project_step. destruct (a =? 0)%Z; [auto |]. intros F.
  apply (add_backward prec emin I) in F. destruct F as (S & F & ->).
  apply (mul_backward prec emin I) in F. destruct F as (_ & _ & ->). rewrite (proj2 (sign_value a A)). auto.
Qed.
Lemma project_backward axis x : is_axis axis -> finite (project o axis x) ->
  val (project o axis x) = project real_ops axis (triple_value x).
Proof.
  intros (A0 & A1 & A2) F. unfold project in *. apply step_backward in F; [| exact A2]. destruct F as (F & ->).
  apply step_backward in F; [| exact A1]. destruct F as (F & ->).
  apply step_backward in F; [| exact A0]. destruct F as (_ & ->).
  rewrite (proj2 (zero_value prec emin I)), model_zero. reflexivity.
Qed.
Lemma magnitude_step_backward a x s : finite (magnitude_step o a x s) ->
  finite s /\ val (magnitude_step o a x s) = magnitude_step real_ops a (val x) (val s).
Proof.
  unfold magnitude_step. destruct (a =? 0)%Z; [auto |]. intros F.
  apply (add_backward prec emin I) in F. destruct F as (S & F & ->).
  apply (absolute_backward prec emin I) in F. destruct F as (_ & ->). auto.
Qed.
Lemma magnitude_backward axis x : finite (project_magnitude o axis x) ->
  val (project_magnitude o axis x) = project_magnitude real_ops axis (triple_value x).
Proof.
  intros F. unfold project_magnitude in *. apply magnitude_step_backward in F. destruct F as (F & ->).
  apply magnitude_step_backward in F. destruct F as (F & ->). apply magnitude_step_backward in F.
  destruct F as (_ & ->).
  rewrite (proj2 (zero_value prec emin I)), model_zero. reflexivity.
Qed.

Definition all_finite (t : triple num) : Prop := finite (at0 t) /\ finite (at1 t) /\ finite (at2 t).
Lemma dot3_backward g x : finite (dot3 o g x) ->
  all_finite g /\ all_finite x /\ val (dot3 o g x) = dot3 real_ops (triple_value g) (triple_value x).
Proof.
  unfold dot3. intros F. apply (add_backward prec emin I) in F. destruct F as (F & F2 & ->).
  apply (add_backward prec emin I) in F. destruct F as (F0 & F1 & ->).
  apply (mul_backward prec emin I) in F0, F1, F2. destruct F0 as (G0 & X0 & ->). destruct F1 as (G1 & X1 & ->).
  destruct F2 as (G2 & X2 & ->). split; [now split |]. split; [now split |]. reflexivity.
Qed.

Lemma columns_backward (f : triple num -> num) (g : triple R -> R) m :
  (forall x, finite (f x) -> val (f x) = g (triple_value x)) -> all_finite (columns f m) ->
  triple_value (columns f m) = columns g (map_value m).
Proof.
  intros H (F0 & F1 & F2). unfold columns, triple_value. cbn [at0 at1 at2].
  rewrite !H by assumption. reflexivity.
Qed.

Lemma outermost_backward b : all_finite (outermost o b) ->
  triple_value (outermost o b) = outermost real_ops (box_value b).
Proof.
  intros (F0 & F1 & F2). cbn [outermost at0 at1 at2] in *.
  apply (add_backward prec emin I) in F0, F1, F2. destruct F0 as (A0 & _ & V0). destruct F1 as (A1 & _ & V1).
  destruct F2 as (A2 & _ & V2). apply (absolute_backward prec emin I) in A0, A1, A2.
  unfold triple_value, outermost. cbn [at0 at1 at2]. rewrite V0, V1, V2, (proj2 A0), (proj2 A1), (proj2 A2).
  reflexivity.
Qed.

Lemma middle_backward axis b m : is_axis axis -> finite (extremum_middle o axis b m) ->
  val (extremum_middle o axis b m) = extremum_middle real_ops axis (box_value b) (map_value m).
Proof.
  intros A F. unfold extremum_middle in *. apply (add_backward prec emin I) in F. destruct F as (F & G & ->).
  apply dot3_backward in F. destruct F as (C & _ & ->).
  rewrite (columns_backward (project o axis) (project real_ops axis) m (fun x => project_backward axis x A) C).
  rewrite (project_backward axis _ A G). reflexivity.
Qed.

Lemma radius_backward axis b m : is_axis axis -> finite (extremum_radius o axis b m) ->
  val (extremum_radius o axis b m) = extremum_radius real_ops axis (box_value b) (map_value m).
Proof.
  intros A F. unfold extremum_radius in *. apply dot3_backward in F. destruct F as ((F0 & F1 & F2) & _ & ->).
  cbn [each at0 at1 at2] in *. apply (absolute_backward prec emin I) in F0, F1, F2.
  destruct F0 as (F0 & V0). destruct F1 as (F1 & V1). destruct F2 as (F2 & V2).
  f_equal. unfold triple_value at 1, each. cbn [at0 at1 at2]. rewrite V0, V1, V2.
  cbn [absolute real_model.real_ops].
  now rewrite <- (columns_backward (project o axis) (project real_ops axis) m (fun x => project_backward axis x A)
                    (conj F0 (conj F1 F2))).
Qed.

Lemma extremum_backward along axis b m : is_axis axis -> finite (extremum_of o along axis b m) ->
  val (extremum_of o along axis b m) = extremum_of real_ops along axis (box_value b) (map_value m).
Proof.
  intros A F. unfold extremum_of in *. destruct along.
  - apply (add_backward prec emin I) in F. destruct F as (F & G & ->).
    now rewrite (radius_backward axis b m A F), (middle_backward axis b m A G).
  - apply (sub_backward prec emin I) in F. destruct F as (F & G & ->).
    now rewrite (radius_backward axis b m A F), (middle_backward axis b m A G).
Qed.

Lemma extremum_magnitude_backward axis b m : finite (extremum_magnitude o axis b m) ->
  val (extremum_magnitude o axis b m) = extremum_magnitude real_ops axis (box_value b) (map_value m).
Proof.
  intros F. unfold extremum_magnitude in *. apply (add_backward prec emin I) in F. destruct F as (F & G & ->).
  apply dot3_backward in F. destruct F as (C & O & ->).
  rewrite (columns_backward (project_magnitude o axis) (project_magnitude real_ops axis) m (magnitude_backward axis) C).
  rewrite (outermost_backward b O), (magnitude_backward axis _ G). reflexivity.
Qed.

(* x is finite and at most z in magnitude, z finite. *)
Definition dominated (x z : num) : Prop := finite x /\ finite z /\ Rabs (val x) <= val z.

Lemma dominated_add x y z w : dominated x z -> dominated y w -> finite (add o z w) -> dominated (add o x y) (add o z w).
Proof.
  intros (X & Z0 & L) (Y & W & M) F. pose proof (add_backward prec emin I z w F) as (_ & _ & V).
  assert (B : Rabs (fl (val x + val y)) <= fl (val z + val w)).
  { rewrite <- (fl_abs prec emin). apply (fl_le prec emin). pose proof (Rabs_triang (val x) (val y)). lra. }
  destruct (law_add _ _ _ _ I x y _ _ (view_val _ X) (view_val _ Y)) as [E | [E _]].
  - apply val_is in E. destruct E as [E EV]. split; [exact E |]. split; [exact F |]. now rewrite EV, V.
  - exfalso. specialize (E _ _ (view_val _ F)). rewrite V in E. pose proof (RRle_abs (fl (val z + val w))). lra.
Qed.

Lemma dominated_mul x y z w : dominated x z -> dominated y w -> finite (mul o z w) -> dominated (mul o x y) (mul o z w).
Proof.
  intros (X & Z0 & L) (Y & W & M) F. pose proof (mul_backward prec emin I z w F) as (_ & _ & V).
  assert (B : Rabs (fl (val x * val y)) <= fl (val z * val w)).
  { rewrite <- (fl_abs prec emin). apply (fl_le prec emin). rewrite Rabs_mult.
    apply Rmult_le_compat; trivial; apply Rabs_pos. }
  destruct (law_mul _ _ _ _ I x y _ _ (view_val _ X) (view_val _ Y)) as [E | E].
  - apply val_is in E. destruct E as [E EV]. split; [exact E |]. split; [exact F |]. now rewrite EV, V.
  - exfalso. specialize (E _ _ (view_val _ F)). rewrite V in E. pose proof (RRle_abs (fl (val z * val w))). lra.
Qed.

Lemma dominated_step a x s t : (-1 <= a <= 1)%Z -> dominated s t -> finite (magnitude_step o a x t) ->
  dominated (project_step o a x s) (magnitude_step o a x t).
Proof.
  intros A D. unfold project_step, magnitude_step. destruct (a =? 0)%Z; [trivial |]. intros F.
  apply dominated_add; [exact D | | exact F]. apply (add_backward prec emin I) in F. destruct F as (_ & F & _).
  pose proof (absolute_backward prec emin I x F) as (X & V). destruct (sign_value a A) as [FA VA].
  assert (S : fl (IZR a * bpow radix2 0 * val x) = IZR a * val x).
  { simpl (bpow radix2 0). rewrite Rmult_1_r. apply (approximation.signed_exact prec emin); [exact A |].
    apply (val_number prec emin I). }
  assert (L : Rabs (IZR a * val x) <= Rabs (val x)).
  { rewrite Rabs_mult. rewrite <- (Rmult_1_l (Rabs (val x))) at 2. apply Rmult_le_compat_r; [apply Rabs_pos |].
    apply Rabs_le. split; [apply (IZR_le (-1)); lia | apply (IZR_le _ 1); lia]. }
  destruct (law_mul _ _ _ _ I _ x _ _ (view_val _ FA) (view_val _ X)) as [E | E].
  - apply val_is in E. destruct E as [E EV]. split; [exact E |]. split; [exact F |]. rewrite EV, VA, S, V. exact L.
  - exfalso. specialize (E _ _ (view_val _ X)). rewrite VA, S in E. lra.
Qed.

Lemma dominated_project axis x : is_axis axis -> finite (project_magnitude o axis x) ->
  dominated (project o axis x) (project_magnitude o axis x).
Proof.
  intros (A0 & A1 & A2) F. unfold project, project_magnitude in *.
  pose proof (magnitude_step_backward _ _ _ F) as (F1 & _). pose proof (magnitude_step_backward _ _ _ F1) as (F0 & _).
  destruct (zero_value prec emin I) as [Z0 V0].
  assert (D : dominated (zero o) (zero o)) by (split; [exact Z0 |]; split; [exact Z0 |]; rewrite V0, Rabs_R0; lra).
  apply dominated_step; trivial. apply dominated_step; trivial. now apply dominated_step.
Qed.

Definition good_box (b : box (num := num)) : Prop :=
  all_finite (centre b) /\ all_finite (half b) /\ all_of (fun e => 0 <= e) (triple_value (half b)).

Lemma dominated_dot3 g x h y : dominated (at0 g) (at0 h) -> dominated (at1 g) (at1 h) -> dominated (at2 g) (at2 h) ->
  dominated (at0 x) (at0 y) -> dominated (at1 x) (at1 y) -> dominated (at2 x) (at2 y) -> finite (dot3 o h y) ->
  dominated (dot3 o g x) (dot3 o h y).
Proof.
  intros G0 G1 G2 X0 X1 X2 F. unfold dot3 in *. pose proof (add_backward prec emin I _ _ F) as (F01 & F2 & _).
  pose proof (add_backward prec emin I _ _ F01) as (F0 & F1 & _).
  apply dominated_add; [apply dominated_add | |]; trivial; now apply dominated_mul.
Qed.

Lemma dominated_outermost c e : finite c -> finite e -> 0 <= val e -> finite (add o (absolute o c) e) ->
  dominated c (add o (absolute o c) e) /\ dominated e (add o (absolute o c) e).
Proof.
  intros C E P F. pose proof (add_backward prec emin I _ _ F) as (A & _ & V).
  pose proof (absolute_backward prec emin I c A) as (_ & VA). rewrite VA in V. pose proof (Rabs_pos (val c)).
  split; (split; [assumption |]; split; [exact F |]; rewrite V; apply (fl_above prec emin)).
  - lra.
  - apply (number_abs prec emin), (val_number prec emin I).
  - rewrite Rabs_pos_eq; lra.
  - apply (number_abs prec emin), (val_number prec emin I).
Qed.

Lemma dominated_absolute x z : dominated x z -> dominated (absolute o x) z.
Proof.
  intros (X & Z0 & L). pose proof (absolute_forward prec emin I x X) as (A & V). split; [exact A |].
  split; [exact Z0 |]. now rewrite V, Rabs_Rabsolu.
Qed.

(* The parts of an extremum are finite, the middle at most the magnitude and the radius at least 0. *)
Theorem parts_finite axis b m : is_axis axis -> good_box b -> finite (extremum_magnitude o axis b m) ->
  dominated (extremum_middle o axis b m) (extremum_magnitude o axis b m) /\
  finite (extremum_radius o axis b m) /\ 0 <= val (extremum_radius o axis b m).
Proof.
  intros A ((C0 & C1 & C2) & (E0 & E1 & E2) & (P0 & P1 & P2)) F. unfold extremum_magnitude in *.
  pose proof (add_backward prec emin I _ _ F) as (FD & F3 & _).
  pose proof (dot3_backward _ _ FD) as ((G0 & G1 & G2) & (O0 & O1 & O2) & _).
  pose proof (dominated_project axis _ A G0) as D0. pose proof (dominated_project axis _ A G1) as D1.
  pose proof (dominated_project axis _ A G2) as D2. pose proof (dominated_project axis _ A F3) as D3.
  destruct (dominated_outermost _ _ C0 E0 P0 O0) as [Q0 R0]. destruct (dominated_outermost _ _ C1 E1 P1 O1) as [Q1 R1].
  destruct (dominated_outermost _ _ C2 E2 P2 O2) as [Q2 R2].
  split; [| split].
  - unfold extremum_middle. apply dominated_add; [| exact D3 | exact F]. now apply dominated_dot3.
  - unfold extremum_radius.
    apply (dominated_dot3 (each (absolute o) (columns (project o axis) m)) (half b)
             (columns (project_magnitude o axis) m) (outermost o b)); trivial; now apply dominated_absolute.
  - assert (N : nonnegative (view (extremum_radius o axis b m))).
    { assert (H : forall e, finite e -> 0 <= val e -> nonnegative (view e)).
      { intros e Fe Pe. rewrite (view_val _ Fe). exact Pe. }
      unfold extremum_radius, dot3.
      repeat apply (law_add_nonnegative _ _ _ _ I); apply (law_mul_nonnegative _ _ _ _ I);
        try (apply (absolute_nonnegative prec emin I)); now apply H. }
    unfold ieee.val. destruct (view (extremum_radius o axis b m)); [exact N | lra ..].
Qed.

Theorem extremum_finite_or_plus along axis b m : is_axis axis -> good_box b ->
  finite (extremum_magnitude o axis b m) ->
  finite (extremum_of o along axis b m) \/ view (extremum_of o along axis b m) = Plus.
Proof.
  intros A B F. destruct (parts_finite axis b m A B F) as ((P & _ & L) & R & R0).
  set (p := extremum_middle o axis b m) in *. set (r := extremum_radius o axis b m) in *.
  set (z := extremum_magnitude o axis b m) in *.
  assert (H : forall s, Rabs s <= val z -> number prec emin s ->
    (forall y c, view y = Finite c -> Rabs c < Rabs (fl (val r + s))) -> 0 <= val r + s).
  { intros s S N Big. destruct (Rle_or_lt 0 (val r + s)) as [G | G]; [exact G | exfalso].
    specialize (Big z _ (view_val _ F)).
    assert (U : fl (val r + s) <= 0) by (rewrite <- (fl_0 prec emin); apply (fl_le prec emin); lra).
    assert (W : s <= fl (val r + s)) by (apply (fl_above prec emin); [lra | exact N]).
    rewrite (Rabs_left1 (fl _)) in Big by exact U. pose proof (RRle_abs (val z)). apply Rabs_le_inv in S. lra. }
  unfold extremum_of. fold p. fold r. destruct along.
  - destruct (law_add _ _ _ _ I r p _ _ (view_val _ R) (view_val _ P)) as [E | [Big E]].
    + left. now exists (fl (val r + val p)).
    + right. rewrite E, Rlt_bool_false; [reflexivity |]. apply (H _ L); [apply (val_number prec emin I) | exact Big].
  - destruct (law_sub _ _ _ _ I r p _ _ (view_val _ R) (view_val _ P)) as [E | [Big E]].
    + left. now exists (fl (val r - val p)).
    + right. rewrite E, Rlt_bool_false; [reflexivity |]. unfold Rminus. apply H.
      * now rewrite Rabs_Ropp.
      * apply (number_opp prec emin), (val_number prec emin I).
      * exact Big.
Qed.

Lemma magnitude_view axis b m : good_box b -> nonnegative (view (extremum_magnitude o axis b m)).
Proof.
  intros ((C0 & C1 & C2) & (E0 & E1 & E2) & (P0 & P1 & P2)).
  assert (S : forall a x s, nonnegative (view s) -> nonnegative (view (magnitude_step o a x s))).
  { intros a x s N. unfold magnitude_step. destruct (a =? 0)%Z; [exact N |].
    apply (law_add_nonnegative _ _ _ _ I); [exact N | apply (absolute_nonnegative prec emin I)]. }
  assert (M : forall x, nonnegative (view (project_magnitude o axis x))).
  { intros x. unfold project_magnitude. apply S, S, S. destruct (zero_value prec emin I) as [F V].
    rewrite (view_val _ F), V. simpl. lra. }
  assert (H : forall c e, finite e -> 0 <= val e -> nonnegative (view (add o (absolute o c) e))).
  { intros c e Fe Pe. apply (law_add_nonnegative _ _ _ _ I); [apply (absolute_nonnegative prec emin I) |].
    rewrite (view_val _ Fe). exact Pe. }
  unfold extremum_magnitude, dot3.
  repeat apply (law_add_nonnegative _ _ _ _ I); try apply M; apply (law_mul_nonnegative _ _ _ _ I);
    try apply M; now apply H.
Qed.
End Ieee_extremum.
