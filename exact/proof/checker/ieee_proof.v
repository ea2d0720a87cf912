(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* The computed statement for IEEE 754 itself: Flocq's binary64 with signed zeros, infinities and NaN. *)
From Coq Require Import ZArith List Bool Reals Lia Lra.
From Flocq Require Import Core BinarySingleNaN.
From CinchChecker Require Import content statement.
Import ListNotations.
Open Scope R_scope.

Definition double := binary_float 53 1024.
Definition precision_positive : Prec_gt_0 53 := eq_refl.
Definition precision_below : Prec_lt_emax 53 1024 := eq_refl.
Global Existing Instance precision_positive.
Global Existing Instance precision_below.

Definition add (x y : double) : double := Bplus mode_NE x y.
Definition mul (x y : double) : double := Bmult mode_NE x y.
Notation real := (@B2R 53 1024).
Notation finite := (@is_finite 53 1024).

(* A double that is the number of a file; of 0, either sign *)
Definition spells (d : dyadic) (x : double) : Prop := finite x = true /\ real x = value d.

(* A row of a map, and a vertex's position and weights, as a machine holds them *)
Record ieee_row := IeeeRow { ia : double; ib : double; ic : double; it : double }.
Definition spells_row (r : row) (x : ieee_row) : Prop :=
  spells (ra r) (ia x) /\ spells (rb r) (ib x) /\ spells (rc r) (ic x) /\ spells (rt r) (it x).

(* sum[r] + w * (((m[r][0] * x + m[r][1] * y) + m[r][2] * z) + m[r][3]) of evaluate_vertex *)
Definition ieee_image (m : ieee_row) (x y z : double) : double :=
  add (add (add (mul (ia m) x) (mul (ib m) y)) (mul (ic m) z)) (it m).
Definition ieee_sum (x y z : double) : list (ieee_row * double) -> double -> double :=
  fold_left (fun s mw => add s (mul (snd mw) (ieee_image (fst mw) x y z))).

(* What a double stands for, where an overflow or NaN is nothing *)
Definition known (x : double) (r : option R) : Prop := forall v, r = Some v -> finite x = true /\ real x = v.

Lemma fl_some x y : fl x = Some y ->
  y = round radix2 (SpecFloat.fexp 53 1024) ZnearestE x /\
  Rlt_bool (Rabs (round radix2 (SpecFloat.fexp 53 1024) ZnearestE x)) (bpow radix2 1024) = true.
Proof.
  unfold fl. change (SpecFloat.fexp 53 1024) with (FLT_exp (-1074) 53). cbv zeta.
  destruct (Rlt_bool _ _) eqn:E; [| easy]. intro H. injection H as <-. now split.
Qed.

Lemma add_known x y a b : known x a -> known y b -> known (add x y) (fadd a b).
Proof.
  intros X Y v. destruct a as [a |], b as [b |]; try easy. cbn. intro F.
  destruct (X a eq_refl) as [Fx <-], (Y b eq_refl) as [Fy <-]. apply fl_some in F as [-> B].
  pose proof (Bplus_correct 53 1024 precision_positive precision_below mode_NE x y Fx Fy) as H.
  cbn [round_mode] in H. rewrite B in H. destruct H as (V & G & _). now split.
Qed.

Lemma mul_known x y a b : known x a -> known y b -> known (mul x y) (fmul a b).
Proof.
  intros X Y v. destruct a as [a |], b as [b |]; try easy. cbn. intro F.
  destruct (X a eq_refl) as [Fx <-], (Y b eq_refl) as [Fy <-]. apply fl_some in F as [-> B].
  pose proof (Bmult_correct 53 1024 precision_positive precision_below mode_NE x y) as H.
  cbn [round_mode] in H. rewrite B in H. destruct H as (V & G & _). rewrite Fx, Fy in G. now split.
Qed.

Lemma spells_known d x : spells d x -> known x (Some (value d)).
Proof. intros [F V] v E. injection E as <-. now split. Qed.

Section Vertex.
  Context (pick : affine -> row) (ms : list affine) (p : point) (x y z : double).
  Context (Hx : spells (px p) x) (Hy : spells (py p) y) (Hz : spells (pz p) z).

  Lemma image_known r m : spells_row r m ->
    known (ieee_image m x y z) (computed_image r (value (px p)) (value (py p)) (value (pz p))).
  Proof.
    intros (A & B & C & T). unfold ieee_image, computed_image.
    apply add_known; [apply add_known; [apply add_known |] |]; try apply mul_known; now apply spells_known.
  Qed.

  Lemma sum_known l : forall ls s r, known s r ->
    Forall2 (fun jw mw => spells_row (row_of pick ms (fst jw)) (fst mw) /\ spells (snd jw) (snd mw)) l ls ->
    known (ieee_sum x y z ls s) (computed_sum pick ms (value (px p)) (value (py p)) (value (pz p)) l r).
  Proof.
    induction l as [| jw l IH]; intros ls s r K F; inversion F as [| a mw b ls' [Row W] F']; subst; [exact K |].
    unfold ieee_sum, computed_sum. cbn [fold_left]. apply IH; [| easy].
    apply add_known; [easy |]. apply mul_known; [now apply spells_known |]. now apply image_known.
  Qed.
End Vertex.

(* Rows of one coordinate, and weights, as a machine holds those of a vertex *)
Definition spells_influences (pick : affine -> row) (ms : list affine) (v : vertex)
    (l : list (ieee_row * double)) : Prop :=
  Forall2 (fun jw mw => spells_row (row_of pick ms (fst jw)) (fst mw) /\ spells (snd jw) (snd mw)) (influences v) l.

Definition zero : double := B754_zero false.

Lemma zero_known : known zero (Some 0).
Proof. intros v E. injection E as <-. now split. Qed.

Lemma part_known a x r q : known x r -> part a r = Some q -> (a <> 0%Z -> finite x = true) /\ IZR a * real x = q.
Proof.
  intros K P. unfold part in P. destruct (Z.eqb_spec a 0) as [-> | N].
  - injection P as <-. split; [easy | ring].
  - destruct r as [v |]; [| easy]. cbn in P. injection P as <-. destruct (K v eq_refl) as [F ->]. now split.
Qed.

(* What evaluate_vertex computes is within the bound, and no coordinate that the direction has overflows. *)
Theorem enclosed_in_ieee a b c ms v bound x y z lx ly lz :
  encloses (a, b, c) ms v bound ->
  spells (px (rest v)) x -> spells (py (rest v)) y -> spells (pz (rest v)) z ->
  spells_influences row_x ms v lx -> spells_influences row_y ms v ly -> spells_influences row_z ms v lz ->
  let p := ieee_sum x y z lx zero in let q := ieee_sum x y z ly zero in let r := ieee_sum x y z lz zero in
  (a <> 0%Z -> finite p = true) /\ (b <> 0%Z -> finite q = true) /\ (c <> 0%Z -> finite r = true) /\
  along (a, b, c) (real p) (real q) (real r) <= bound.
Proof.
  intros [_ (s & S & L)] X Y Z Lx Ly Lz p q r. unfold computed_along, along_computed in S.
  destruct (part a _) as [u |] eqn:A; [| easy]. destruct (part b _) as [v' |] eqn:B; [| easy].
  destruct (part c _) as [w |] eqn:C; [| easy]. injection S as <-.
  apply (part_known a p) in A as [Fp <-]; [| exact (sum_known row_x ms (rest v) x y z X Y Z _ _ _ _ zero_known Lx)].
  apply (part_known b q) in B as [Fq <-]; [| exact (sum_known row_y ms (rest v) x y z X Y Z _ _ _ _ zero_known Ly)].
  apply (part_known c r) in C as [Fr <-]; [| exact (sum_known row_z ms (rest v) x y z X Y Z _ _ _ _ zero_known Lz)].
  split; [exact Fp |]. split; [exact Fq |]. split; [exact Fr | exact L].
Qed.
