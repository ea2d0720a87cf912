(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* The extremum of a box under an affine map along an axis of components -1, 0 and 1, as extrema() of
   toolkit/bounds/bound_box.cpp computes it, and what extremum_error covers; both sides of the axis. *)
From Coq Require Import Reals Lra Lia ZArith List.
From Flocq Require Import Core.
From CinchProof Require Import geometry rounding successor approximation model real_model.
Open Scope R_scope.

Definition point_of (t : triple R) : point := Point (at0 t) (at1 t) (at2 t).
Definition box_of_model (b : model.box (num := R)) : geometry.box :=
  geometry.Box (point_of (model.centre b)) (point_of (model.half b)).
Definition affine_of (m : map_rows (num := R)) : affine :=
  Affine (point_of (column (at0 m))) (point_of (column (at1 m))) (point_of (column (at2 m)))
         (Point (offset (at0 m)) (offset (at1 m)) (offset (at2 m))).
Definition all_of {A} (P : A -> Prop) (t : triple A) : Prop := P (at0 t) /\ P (at1 t) /\ P (at2 t).
Definition is_axis (axis : triple Z) : Prop := all_of (fun a => (-1 <= a <= 1)%Z) axis.
Definition side (along : bool) : R := if along then 1 else -1.
(* The direction: the axis or its opposite. *)
Definition direction (along : bool) (axis : triple Z) : point :=
  geometry.scale (side along) (Point (IZR (at0 axis)) (IZR (at1 axis)) (IZR (at2 axis))).

Section Extremum.
Variables prec emin : Z.
Context {format : Format prec emin}.
Notation fl := (fl prec emin).
Notation number := (number prec emin).
Notation u := (u prec).
Notation eta := (eta emin).
Notation real_ops := (real_ops prec emin).
Notation approximates := (approximates prec emin).
Notation growth := (growth prec).

Definition row_number (r : row (num := R)) : Prop := all_of number (column r) /\ number (offset r).
Definition map_number (m : map_rows (num := R)) : Prop := all_of row_number m.
Definition box_number (b : model.box (num := R)) : Prop :=
  all_of number (model.centre b) /\ all_of number (model.half b) /\ all_of (fun e => 0 <= e) (model.half b).

(* gamma . x for an axis, and the same of absolute values, exactly. *)
Definition along_axis (axis : triple Z) (x : triple R) : R :=
  IZR (at0 axis) * at0 x + IZR (at1 axis) * at1 x + IZR (at2 axis) * at2 x.
Definition size_along (axis : triple Z) (x : triple R) : R :=
  Rabs (IZR (at0 axis)) * Rabs (at0 x) + Rabs (IZR (at1 axis)) * Rabs (at1 x) + Rabs (IZR (at2 axis)) * Rabs (at2 x).

(* A sum that begins at 0: nothing yet, or some terms; the first of them is added exactly. *)
Definition started (k : nat) (c x X : R) : Prop := (c = 0 /\ x = 0 /\ X = 0) \/ approximates k c x X 0.

Lemma started_approximates k c x X : started k c x X -> approximates k c x X 0.
Proof.
  intros [(-> & -> & ->) | A]; [| exact A].
  apply (approximates_weaken prec emin 0 k 0 0 0 0 0); [lia | lra | apply approximates_0; exact format].
Qed.

Lemma term_exact a x : (-1 <= a <= 1)%Z -> number x -> fl (IZR a * bpow radix2 0 * x) = IZR a * x.
Proof. intros A F. simpl (bpow radix2 0). rewrite Rmult_1_r. now apply (signed_exact prec emin). Qed.

Lemma term_approximates a x :
  (-1 <= a <= 1)%Z -> number x -> approximates 0 (IZR a * x) (IZR a * x) (Rabs (IZR a) * Rabs x) 0.
Proof.
  intros A F. rewrite <- Rabs_mult. apply (approximates_exact prec emin).
  rewrite <- (signed_exact prec emin a x A F). apply (fl_number prec emin).
Qed.

Lemma add_to_0 x : number x -> fl (0 + x) = x.
Proof. intros F. rewrite Rplus_0_l. now apply (fl_id prec emin). Qed.

Lemma project_first a x : (-1 <= a <= 1)%Z -> number x ->
  started 0 (project_step real_ops a x 0) (IZR a * x) (Rabs (IZR a) * Rabs x).
Proof.
  intros A F. unfold project_step. destruct (Z.eqb_spec a 0) as [-> | N].
  - left. rewrite Rabs_R0, !Rmult_0_l. auto.
  - right. cbn [add mul constant real_model.real_ops]. rewrite term_exact by assumption.
    pose proof (term_approximates a x A F) as T. rewrite add_to_0 by apply T. exact T.
Qed.

Lemma project_next k a x s e X : (-1 <= a <= 1)%Z -> number x -> started k s e X ->
  started (S k) (project_step real_ops a x s) (e + IZR a * x) (X + Rabs (IZR a) * Rabs x).
Proof.
  intros A F St. unfold project_step. destruct (Z.eqb_spec a 0) as [-> | N].
  - rewrite Rabs_R0, !Rmult_0_l, !Rplus_0_r. destruct St as [St | St]; [now left | right].
    apply (approximates_weaken prec emin k (S k) _ _ _ 0 0); [lia | lra | exact St].
  - right. cbn [add mul constant real_model.real_ops]. rewrite term_exact by assumption.
    pose proof (term_approximates a x A F) as T. destruct St as [(-> & -> & ->) | St].
    + rewrite add_to_0, !Rplus_0_l by apply T.
      apply (approximates_weaken prec emin 0 (S k) _ _ _ 0 0); [lia | lra | exact T].
    + replace 0 with ((1 + u) * (0 + 0)) by ring. apply (approximates_add prec emin); [exact St |].
      apply (approximates_weaken prec emin 0 k _ _ _ 0 0); [lia | lra | exact T].
Qed.

Lemma project_approximates axis x : is_axis axis -> all_of number x ->
  approximates 2 (project real_ops axis x) (along_axis axis x) (size_along axis x) 0.
Proof.
  intros (A0 & A1 & A2) (F0 & F1 & F2). apply started_approximates.
  unfold project, along_axis, size_along. rewrite model_zero.
  apply project_next; trivial. apply project_next; trivial. now apply project_first.
Qed.

Lemma magnitude_first a x : (-1 <= a <= 1)%Z -> number x ->
  started 0 (magnitude_step real_ops a x 0) (Rabs (IZR a) * Rabs x) (Rabs (IZR a) * Rabs x).
Proof.
  intros A F. unfold magnitude_step. destruct (Z.eqb_spec a 0) as [-> | N].
  - left. rewrite Rabs_R0, !Rmult_0_l. auto.
  - right. cbn [add absolute real_model.real_ops]. pose proof (number_abs prec emin x F) as G.
    rewrite add_to_0 by exact G.
    replace (Rabs (IZR a)) with 1.
    + rewrite Rmult_1_l. rewrite <- (Rabs_Rabsolu x) at 3. now apply (approximates_exact prec emin).
    + assert (H : a = (-1)%Z \/ a = 1%Z) by lia. destruct H as [-> | ->]; [rewrite Rabs_left |]; try lra.
      now rewrite Rabs_R1.
Qed.

Lemma magnitude_next k a x s e : (-1 <= a <= 1)%Z -> number x -> started k s e e ->
  started (S k) (magnitude_step real_ops a x s) (e + Rabs (IZR a) * Rabs x) (e + Rabs (IZR a) * Rabs x).
Proof.
  intros A F St. pose proof (magnitude_first a x A F) as M. unfold magnitude_step in *.
  destruct (Z.eqb_spec a 0) as [-> | N].
  - rewrite Rabs_R0, !Rmult_0_l, !Rplus_0_r. destruct St as [St | St]; [now left | right].
    apply (approximates_weaken prec emin k (S k) _ _ _ 0 0); [lia | lra | exact St].
  - right. cbn [add absolute real_model.real_ops] in *. pose proof (number_abs prec emin x F) as G.
    rewrite add_to_0 in M by exact G. apply started_approximates in M. destruct St as [(-> & -> & _) | St].
    + rewrite add_to_0, !Rplus_0_l by exact G.
      apply (approximates_weaken prec emin 0 (S k) _ _ _ 0 0); [lia | lra | exact M].
    + replace 0 with ((1 + u) * (0 + 0)) by ring. apply (approximates_add prec emin); [exact St |].
      apply (approximates_weaken prec emin 0 k _ _ _ 0 0); [lia | lra | exact M].
Qed.

Lemma magnitude_approximates axis x : is_axis axis -> all_of number x ->
  approximates 2 (project_magnitude real_ops axis x) (size_along axis x) (size_along axis x) 0.
Proof.
  intros (A0 & A1 & A2) (F0 & F1 & F2). apply started_approximates.
  unfold project_magnitude, size_along. rewrite model_zero.
  apply magnitude_next; trivial. apply magnitude_next; trivial. now apply magnitude_first.
Qed.

(* Columns of a map, exactly. *)
Lemma columns_number m : map_number m ->
  all_of number (column0 m) /\ all_of number (column1 m) /\ all_of number (column2 m) /\ all_of number (column3 m).
Proof.
  intros (((A & B & C) & D) & ((E & F & G) & H) & ((I & J & K) & L)). repeat split; assumption.
Qed.

Definition sum3 (g x : triple R) : R := at0 g * at0 x + at1 g * at1 x + at2 g * at2 x.

(* Dot products of factors that pass j and k roundings: j + k + 3 in all. *)
Lemma dot3_approximates j k g h G x y Y :
  approximates j (at0 g) (at0 h) (at0 G) 0 -> approximates j (at1 g) (at1 h) (at1 G) 0 ->
  approximates j (at2 g) (at2 h) (at2 G) 0 ->
  approximates k (at0 x) (at0 y) (at0 Y) 0 -> approximates k (at1 x) (at1 y) (at1 Y) 0 ->
  approximates k (at2 x) (at2 y) (at2 Y) 0 ->
  approximates (S (S (S (j + k)))) (dot3 real_ops g x) (sum3 h y) (sum3 G Y) (1.51).
Proof.
  intros G0 G1 G2 X0 X1 X2. pose proof (u_positive prec). pose proof (u_small prec emin).
  pose proof (approximates_mul prec emin _ _ _ _ _ _ _ _ G0 X0) as P0.
  pose proof (approximates_mul prec emin _ _ _ _ _ _ _ _ G1 X1) as P1.
  pose proof (approximates_mul prec emin _ _ _ _ _ _ _ _ G2 X2) as P2.
  unfold dot3, sum3. cbn [add mul real_model.real_ops].
  eapply (approximates_weaken prec emin); [apply Nat.le_refl | |].
  2: { apply (approximates_add prec emin); [apply (approximates_add prec emin); eassumption |].
       eapply (approximates_weaken prec emin); [| | exact P2]; [lia | apply Rle_refl]. }
  nra.
Qed.

(* M: the sum of the absolute values of the leaves. *)
Definition column_sizes (axis : triple Z) (m : map_rows (num := R)) : triple R :=
  Triple (size_along axis (column0 m)) (size_along axis (column1 m)) (size_along axis (column2 m)).
Definition outermost_of (b : model.box (num := R)) : triple R :=
  Triple (Rabs (at0 (model.centre b)) + at0 (model.half b)) (Rabs (at1 (model.centre b)) + at1 (model.half b))
         (Rabs (at2 (model.centre b)) + at2 (model.half b)).
Definition exact_magnitude (axis : triple Z) (b : model.box) (m : map_rows) : R :=
  sum3 (column_sizes axis m) (outermost_of b) + size_along axis (column3 m).
Definition exact_extremum (along : bool) (axis : triple Z) (b : model.box) (m : map_rows) : R :=
  node_extremum (box_of_model b) (affine_of m) (direction along axis).

Definition absolutes (x : triple R) : triple R := Triple (Rabs (at0 x)) (Rabs (at1 x)) (Rabs (at2 x)).
Definition projected (axis : triple Z) (m : map_rows (num := R)) : triple R :=
  Triple (along_axis axis (column0 m)) (along_axis axis (column1 m)) (along_axis axis (column2 m)).

Lemma projected_approximates axis m : is_axis axis -> map_number m ->
  let g := columns (project real_ops axis) m in
  approximates 2 (at0 g) (at0 (projected axis m)) (at0 (column_sizes axis m)) 0 /\
  approximates 2 (at1 g) (at1 (projected axis m)) (at1 (column_sizes axis m)) 0 /\
  approximates 2 (at2 g) (at2 (projected axis m)) (at2 (column_sizes axis m)) 0.
Proof.
  intros A F. apply columns_number in F. destruct F as (F0 & F1 & F2 & _).
  split; [| split]; apply project_approximates; assumption.
Qed.

Lemma middle_approximates axis b m : is_axis axis -> box_number b -> map_number m ->
  approximates 6 (extremum_middle real_ops axis b m)
    (sum3 (projected axis m) (model.centre b) + along_axis axis (column3 m))
    (sum3 (column_sizes axis m) (absolutes (model.centre b)) + size_along axis (column3 m)) (1.52).
Proof.
  intros A ((C0 & C1 & C2) & _) F. pose proof (u_positive prec). pose proof (u_small prec emin).
  destruct (projected_approximates axis m A F) as (P0 & P1 & P2). apply columns_number in F.
  destruct F as (_ & _ & _ & F3). pose proof (project_approximates axis (column3 m) A F3) as T.
  unfold extremum_middle. cbn [add real_model.real_ops].
  eapply (approximates_weaken prec emin); [apply Nat.le_refl | |].
  2: { apply (approximates_add prec emin).
       - apply (dot3_approximates 2 0); try eassumption; now apply (approximates_exact prec emin).
       - eapply (approximates_weaken prec emin); [| apply Rle_refl | exact T]. lia. }
  nra.
Qed.

Lemma radius_approximates axis b m : is_axis axis -> box_number b -> map_number m ->
  approximates 6 (extremum_radius real_ops axis b m) (sum3 (absolutes (projected axis m)) (model.half b))
    (sum3 (column_sizes axis m) (model.half b)) (1.52).
Proof.
  intros A (_ & (E0 & E1 & E2) & (Q0 & Q1 & Q2)) F.
  destruct (projected_approximates axis m A F) as (P0 & P1 & P2).
  assert (H : forall e, number e -> 0 <= e -> approximates 0 e e e 0).
  { intros e Fe Pe. pose proof (approximates_exact prec emin e Fe) as X. now rewrite Rabs_pos_eq in X. }
  eapply (approximates_weaken prec emin);
    [| | apply (dot3_approximates 2 0) with (h := absolutes (projected axis m)) (G := column_sizes axis m)
           (y := model.half b) (Y := model.half b)]; try (apply approximates_abs; assumption); try (apply H;
             assumption).
  - lia.
  - lra.
Qed.

Theorem extremum_approximates along axis b m : is_axis axis -> box_number b -> map_number m ->
  approximates 7 (extremum_of real_ops along axis b m) (exact_extremum along axis b m) (exact_magnitude axis b m)
    (3.05).
Proof.
  intros A B F. pose proof (middle_approximates axis b m A B F) as P.
  pose proof (radius_approximates axis b m A B F) as R.
  pose proof (u_positive prec). pose proof (u_small prec emin).
  assert (X : exact_magnitude axis b m =
              sum3 (column_sizes axis m) (model.half b) +
              (sum3 (column_sizes axis m) (absolutes (model.centre b)) + size_along axis (column3 m)))
    by (unfold exact_magnitude, sum3, outermost_of, absolutes; simpl; ring).
  assert (E : exact_extremum along axis b m =
              sum3 (absolutes (projected axis m)) (model.half b) +
              side along * (sum3 (projected axis m) (model.centre b) + along_axis axis (column3 m))).
  { unfold exact_extremum, node_extremum, box_support, reach.
    assert (S : forall g x, g = side along * x -> Rabs g = Rabs x).
    { intros g x ->. rewrite Rabs_mult. destruct along; simpl; [rewrite Rabs_R1 | rewrite Rabs_left by lra]; ring. }
    set (q := pull (affine_of m) (direction along axis)).
    assert (Q0 : px q = side along * along_axis axis (column0 m)) by (unfold q, along_axis, pull, direction; simpl;
      ring).
    assert (Q1 : py q = side along * along_axis axis (column1 m)) by (unfold q, along_axis, pull, direction; simpl;
      ring).
    assert (Q2 : pz q = side along * along_axis axis (column2 m)) by (unfold q, along_axis, pull, direction; simpl;
      ring).
    assert (T : dot (direction along axis) (translation (affine_of m)) = side along * along_axis axis (column3 m))
      by (unfold dot, along_axis, direction; simpl; ring).
    rewrite T, (S _ _ Q0), (S _ _ Q1), (S _ _ Q2). unfold dot. rewrite Q0, Q1, Q2.
    unfold sum3, absolutes, projected. simpl. ring. }
  rewrite X, E. eapply (approximates_weaken prec emin); [apply Nat.le_refl | |].
  2: { unfold extremum_of. destruct along; cbn [add sub real_model.real_ops side].
       - rewrite Rmult_1_l. apply (approximates_add prec emin); eassumption.
       - replace (-1 * (sum3 (projected axis m) (model.centre b) + along_axis axis (column3 m)))
           with (- (sum3 (projected axis m) (model.centre b) + along_axis axis (column3 m))) by ring.
         apply (approximates_sub prec emin); eassumption. }
  nra.
Qed.

Lemma size_nonnegative axis x : 0 <= size_along axis x.
Proof.
  unfold size_along. pose proof (Rabs_pos (IZR (at0 axis))). pose proof (Rabs_pos (IZR (at1 axis))).
  pose proof (Rabs_pos (IZR (at2 axis))). pose proof (Rabs_pos (at0 x)). pose proof (Rabs_pos (at1 x)).
  pose proof (Rabs_pos (at2 x)). nra.
Qed.

Theorem magnitude_approximates_exact axis b m : is_axis axis -> box_number b -> map_number m ->
  approximates 7 (extremum_magnitude real_ops axis b m) (exact_magnitude axis b m) (exact_magnitude axis b m) (1.52).
Proof.
  intros A ((C0 & C1 & C2) & (E0 & E1 & E2) & (Q0 & Q1 & Q2)) F. apply columns_number in F.
  destruct F as (F0 & F1 & F2 & F3). pose proof (u_positive prec). pose proof (u_small prec emin).
  assert (Out : forall c e, number c -> number e -> 0 <= e -> approximates 1 (fl (Rabs c + e)) (Rabs c + e) (Rabs c +
    e) 0).
  { intros c e Fc Fe Pe. replace 0 with ((1 + u) * (0 + 0)) by ring. apply (approximates_add prec emin).
    - rewrite <- (Rabs_Rabsolu c) at 3. apply (approximates_exact prec emin). now apply (number_abs prec emin).
    - pose proof (approximates_exact prec emin e Fe) as X. now rewrite Rabs_pos_eq in X. }
  unfold extremum_magnitude. cbn [add real_model.real_ops].
  eapply (approximates_weaken prec emin); [apply Nat.le_refl | |].
  2: { apply (approximates_add prec emin).
       - apply (dot3_approximates 2 1) with (h := column_sizes axis m) (G := column_sizes axis m)
           (y := outermost_of b) (Y := outermost_of b); try (apply magnitude_approximates; assumption);
           apply Out; assumption.
       - eapply (approximates_weaken prec emin); [| apply Rle_refl | now apply magnitude_approximates]. lia. }
  nra.
Qed.

Lemma magnitude_step_nonnegative a x s : 0 <= s -> 0 <= magnitude_step real_ops a x s.
Proof.
  intros P. unfold magnitude_step. destruct (a =? 0)%Z; [exact P |]. apply (fl_nonnegative prec emin).
  pose proof (Rabs_pos x). cbn [absolute real_model.real_ops]. lra.
Qed.

Lemma magnitude_nonnegative axis b m : box_number b -> 0 <= extremum_magnitude real_ops axis b m.
Proof.
  intros (_ & _ & (Q0 & Q1 & Q2)).
  assert (P : forall x, 0 <= project_magnitude real_ops axis x).
  { intros x. unfold project_magnitude. rewrite model_zero.
    repeat apply magnitude_step_nonnegative. apply Rle_refl. }
  unfold extremum_magnitude, dot3. cbn [add mul real_model.real_ops].
  assert (O : forall c e, 0 <= e -> 0 <= fl (Rabs c + e)).
  { intros c e E. apply (fl_nonnegative prec emin). pose proof (Rabs_pos c). lra. }
  assert (M : forall x y, 0 <= x -> 0 <= y -> 0 <= fl (x * y)).
  { intros x y X Y. apply (fl_nonnegative prec emin). now apply Rmult_le_pos. }
  repeat (apply (fl_nonnegative prec emin); apply Rplus_le_le_0_compat); try apply P; apply M; try apply P;
    apply O; assumption.
Qed.

Lemma growth_7 : growth 7 <= 7.01 * u.
Proof.
  pose proof (u_positive prec). pose proof (u_small prec emin).
  pose proof (growth_small prec 7) as G. simpl INR in G.
  assert (7 * u * (7 * u) <= 49 * u * / 16777216) by nra. lra.
Qed.

(* M against a computed magnitude that is at least the node's. *)
Theorem magnitude_below_computed axis b m most : is_axis axis -> box_number b -> map_number m ->
  extremum_magnitude real_ops axis b m <= most ->
  exact_magnitude axis b m <= (1 + 7.02 * u) * most + 1.53 * eta.
Proof.
  intros A B F L. destruct (magnitude_approximates_exact axis b m A B F) as (_ & P & E).
  pose proof (Rabs_pos (exact_magnitude axis b m)).
  pose proof growth_7 as G. pose proof (growth_nonnegative prec 7).
  pose proof (u_positive prec). pose proof (u_small prec emin). pose proof (eta_positive emin).
  apply Rabs_le_inv in E. set (M := exact_magnitude axis b m) in *.
  assert (GM : growth 7 * M <= 7.01 * u * M) by (apply Rmult_le_compat_r; lra).
  assert (M1 : (1 - 7.01 * u) * M <= most + 1.52 * eta) by lra.
  assert (M2 : (1 - 7.01 * u) * M <= (1 - 7.01 * u) * ((1 + 7.02 * u) * most + 1.53 * eta)).
  { apply Rle_trans with (1 := M1).
    assert (MP : 0 <= most) by (apply Rle_trans with (2 := L); now apply magnitude_nonnegative).
    assert (0 <= most * (u * (0.01 - 7.01 * 7.02 * u))) by (repeat apply Rmult_le_pos; lra).
    assert (u * eta <= / 16777216 * eta) by (apply Rmult_le_compat_r; lra). lra. }
  apply Rmult_le_reg_l with (2 := M2). lra.
Qed.

(* What extremum_error is for: computed and exact extremum differ by at most the term. *)
Theorem extremum_error_covers along axis b m most : is_axis axis -> box_number b -> map_number m ->
  extremum_magnitude real_ops axis b m <= most ->
  Rabs (extremum_of real_ops along axis b m - exact_extremum along axis b m) <= extremum_error real_ops most.
Proof.
  intros A B F L. destruct (extremum_approximates along axis b m A B F) as (_ & _ & E).
  pose proof (magnitude_below_computed axis b m most A B F L) as M.
  pose proof growth_7 as G. pose proof (growth_nonnegative prec 7).
  pose proof (u_positive prec). pose proof (u_small prec emin). pose proof (eta_positive emin).
  destruct (magnitude_approximates_exact axis b m A B F) as (_ & P & _).
  pose proof (Rabs_pos (exact_magnitude axis b m)).
  apply Rle_trans with (1 := E).
  assert (Q : growth 7 * exact_magnitude axis b m <= 7.01 * u * ((1 + 7.02 * u) * most + 1.53 * eta))
    by (apply Rmult_le_compat; lra).
  assert (MP : 0 <= most).
  { apply Rle_trans with (2 := L). now apply magnitude_nonnegative. }
  rewrite (model_extremum_error prec emin).
  assert (K : (0 <= 10 < 2 ^ prec)%Z) by (split; [lia |]; pose proof (@prec_large prec emin format);
    apply Z.lt_le_trans with (2 ^ 24)%Z; [reflexivity | apply Z.pow_le_mono_r; lia]).
  pose proof (error_term prec emin 10 16 most K MP) as T.
  apply Rle_trans with (2 := T).
  assert (X0 : 0 <= u * most) by (apply Rmult_le_pos; lra).
  assert (X1 : u * (u * most) <= / 16777216 * (u * most)) by (apply Rmult_le_compat_r; lra).
  assert (X2 : u * eta <= / 16777216 * eta) by (apply Rmult_le_compat_r; lra). lra.
Qed.
End Extremum.
