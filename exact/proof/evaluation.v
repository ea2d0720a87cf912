(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* evaluate_vertex of toolkit/deform/evaluate.cpp against the exact vertex, along any axis, and what evaluation_error
   covers. *)
From Coq Require Import Reals Lra Lia ZArith List.
From Flocq Require Import Core.
From CinchProof Require Import duality geometry rounding successor approximation model real_model extremum.
Import ListNotations.
Open Scope R_scope.

Section Evaluation.
Variables prec emin : Z.
Context {format : Format prec emin}.
Notation fl := (fl prec emin).
Notation number := (number prec emin).
Notation u := (u prec).
Notation eta := (eta emin).
Notation real_ops := (real_ops prec emin).
Notation approximates := (approximates prec emin).
Notation growth := (growth prec).
Notation row_number := (row_number prec emin).
Notation map_number := (map_number prec emin).
Notation box_number := (box_number prec emin).

Definition exact_row (x : triple R) (r : row (num := R)) : R := sum3 (column r) x + offset r.
Definition size_row (x : triple R) (r : row (num := R)) : R :=
  sum3 (absolutes (column r)) (absolutes x) + Rabs (offset r).
Definition exact_coordinate (x : triple R) (nodes : list (R * row (num := R))) : R :=
  sum (fun n => fst n * exact_row x (snd n)) nodes.
Definition size_coordinate (x : triple R) (nodes : list (R * row (num := R))) : R :=
  sum (fun n => fst n * size_row x (snd n)) nodes.
Definition is_weight (w : R) : Prop := number w /\ 0 <= w <= 1.

Lemma row_approximates x r : all_of number x -> row_number r ->
  approximates 4 (evaluate_row real_ops x r) (exact_row x r) (size_row x r) (1.52).
Proof.
  intros (X0 & X1 & X2) ((C0 & C1 & C2) & O). pose proof (u_positive prec). pose proof (u_small prec emin).
  unfold evaluate_row, exact_row, size_row. cbn [add real_model.real_ops].
  eapply (approximates_weaken prec emin); [apply Nat.le_refl | |].
  2: { apply (approximates_add prec emin).
       - apply (dot3_approximates prec emin 0 0) with (h := column r) (G := absolutes (column r)) (y := x)
           (Y := absolutes x); now apply (approximates_exact prec emin).
       - eapply (approximates_weaken prec emin); [| apply Rle_refl | now apply (approximates_exact prec emin)]. lia. }
  nra.
Qed.

Lemma term_of_node x w r : all_of number x -> row_number r -> is_weight w ->
  approximates 5 (fl (w * evaluate_row real_ops x r)) (w * exact_row x r) (w * size_row x r) (2.03).
Proof.
  intros X R (F & I). pose proof (u_positive prec). pose proof (u_small prec emin).
  eapply (approximates_weaken prec emin); [apply Nat.le_refl | |].
  2: { apply (approximates_weighted prec emin); [exact F | exact I | | now apply row_approximates]. lra. }
  nra.
Qed.

Definition underflow (n : nat) : R := 2.03 * INR n * (1 + u) ^ n.

Lemma coordinate_from x nodes : all_of number x ->
  Forall (fun n => is_weight (fst n) /\ row_number (snd n)) nodes ->
  forall n s e X, (1 <= n)%nat -> approximates (4 + n) s e X (underflow n) ->
  approximates (4 + (n + length nodes))
    (fold_left (fun sum n => fl (sum + fl (fst n * evaluate_row real_ops x (snd n)))) nodes s)
    (e + exact_coordinate x nodes) (X + size_coordinate x nodes) (underflow (n + length nodes)).
Proof.
  intros Fx F. unfold exact_coordinate, size_coordinate.
  induction F as [| [w r] nodes [W R] _ IH]; intros n s e X N A.
  - unfold sum. simpl. rewrite !Rplus_0_r, Nat.add_0_r. exact A.
  - rewrite !sum_cons. cbn [fold_left fst snd length]. rewrite <- !Rplus_assoc.
    replace (n + S (length nodes))%nat with (S n + length nodes)%nat by lia.
    apply IH; [lia |]. cbn [fst snd] in *.
    pose proof (term_of_node x w r Fx R W) as T. pose proof (u_positive prec) as U.
    pose proof (power_at_least_1 prec n) as Pn.
    eapply (approximates_weaken prec emin); [apply Nat.le_refl | |].
    2: { apply (approximates_add prec emin); [exact A |].
         eapply (approximates_weaken prec emin); [| | exact T]; [lia | apply Rle_refl]. }
    unfold underflow. rewrite S_INR. simpl ((1 + u) ^ S n).
    replace (2.03 * (INR n + 1) * ((1 + u) * (1 + u) ^ n))
      with ((1 + u) * (2.03 * INR n * (1 + u) ^ n + 2.03 * (1 + u) ^ n)) by ring.
    apply Rmult_le_compat_l; lra.
Qed.

Theorem coordinate_approximates x nodes : all_of number x ->
  Forall (fun n => is_weight (fst n) /\ row_number (snd n)) nodes ->
  approximates (4 + length nodes) (evaluate_coordinate real_ops x nodes)
    (exact_coordinate x nodes) (size_coordinate x nodes) (underflow (length nodes)).
Proof.
  intros Fx F. unfold evaluate_coordinate. rewrite model_zero. destruct nodes as [| [w r] nodes].
  - unfold exact_coordinate, size_coordinate, sum, underflow. simpl.
    apply (approximates_weaken prec emin 0 4 0 0 0 0); [lia | lra |]. apply approximates_0; exact format.
  - cbn [fold_left fst snd]. inversion F as [| ? ? [W R] G]; subst. cbn [fst snd] in *.
    pose proof (term_of_node x w r Fx R W) as T.
    assert (Z0 : add real_ops 0 (mul real_ops w (evaluate_row real_ops x r)) =
                 fl (w * evaluate_row real_ops x r)).
    { cbn [add mul real_model.real_ops]. rewrite Rplus_0_l. apply (fl_id prec emin), (fl_number prec emin). }
    rewrite Z0. change (length ((w, r) :: nodes)) with (1 + length nodes)%nat.
    unfold exact_coordinate, size_coordinate. rewrite !sum_cons. cbn [fst snd].
    apply (coordinate_from x nodes Fx G 1); [lia |].
    apply (approximates_weaken prec emin 5 (4 + 1) _ _ _ (2.03)); [lia | | exact T].
    unfold underflow. pose proof (u_positive prec). simpl. nra.
Qed.

(* Along an axis. *)
Definition rows_of (f : map_rows (num := R) -> row (num := R)) (nodes : list (R * map_rows (num := R))) :
  list (R * row (num := R)) :=
  map (fun n => (fst n, f (snd n))) nodes.
Definition exact_vertex (x : triple R) (nodes : list (R * map_rows (num := R))) : triple R :=
  Triple (exact_coordinate x (rows_of at0 nodes)) (exact_coordinate x (rows_of at1 nodes))
         (exact_coordinate x (rows_of at2 nodes)).
Definition row_along (axis : triple Z) (x : triple R) (m : map_rows (num := R)) : R :=
  Rabs (IZR (at0 axis)) * size_row x (at0 m) + Rabs (IZR (at1 axis)) * size_row x (at1 m) +
  Rabs (IZR (at2 axis)) * size_row x (at2 m).

Lemma in_box_outermost c e x : Rabs (x - c) <= e -> Rabs x <= Rabs c + e.
Proof.
  intros H. replace x with (c + (x - c)) by ring. pose proof (Rabs_triang c (x - c)). lra.
Qed.

(* A vertex in the box has no leaves beyond M. *)
Lemma row_along_below axis b x m : in_box (box_of_model b) (point_of x) -> row_along axis x m <= exact_magnitude axis
  b m.
Proof.
  intros (X0 & X1 & X2). simpl in *. apply in_box_outermost in X0, X1, X2.
  unfold row_along, exact_magnitude, size_row, sum3, column_sizes, outermost_of, absolutes, size_along. simpl.
  set (o0 := Rabs (at0 (model.centre b)) + at0 (model.half b)) in *.
  set (o1 := Rabs (at1 (model.centre b)) + at1 (model.half b)) in *.
  set (o2 := Rabs (at2 (model.centre b)) + at2 (model.half b)) in *.
  assert (P : forall a c y o, Rabs y <= o -> Rabs a * (Rabs c * Rabs y) <= Rabs a * (Rabs c * o)).
  { intros a c y o L. apply Rmult_le_compat_l; [apply Rabs_pos |].
  apply Rmult_le_compat_l; [apply Rabs_pos | exact L]. }
  pose proof (P (IZR (at0 axis)) (at0 (column (at0 m))) _ _ X0).
  pose proof (P (IZR (at0 axis)) (at1 (column (at0 m))) _ _ X1).
  pose proof (P (IZR (at0 axis)) (at2 (column (at0 m))) _ _ X2).
  pose proof (P (IZR (at1 axis)) (at0 (column (at1 m))) _ _ X0).
  pose proof (P (IZR (at1 axis)) (at1 (column (at1 m))) _ _ X1).
  pose proof (P (IZR (at1 axis)) (at2 (column (at1 m))) _ _ X2).
  pose proof (P (IZR (at2 axis)) (at0 (column (at2 m))) _ _ X0).
  pose proof (P (IZR (at2 axis)) (at1 (column (at2 m))) _ _ X1).
  pose proof (P (IZR (at2 axis)) (at2 (column (at2 m))) _ _ X2). lra.
Qed.

Lemma axis_component a d e : (-1 <= a <= 1)%Z -> Rabs d <= e -> Rabs (IZR a * d) <= Rabs (IZR a) * e.
Proof. intros A D. rewrite Rabs_mult. apply Rmult_le_compat_l; [apply Rabs_pos | exact D]. Qed.

Lemma axis_at_most_1 a : (-1 <= a <= 1)%Z -> 0 <= Rabs (IZR a) <= 1.
Proof.
  intros A. split; [apply Rabs_pos |]. apply Rabs_le. split.
  - apply (IZR_le (-1)); lia.
  - apply (IZR_le _ 1); lia.
Qed.

Lemma size_sum_along axis x nodes :
  Rabs (IZR (at0 axis)) * size_coordinate x (rows_of at0 nodes) +
  Rabs (IZR (at1 axis)) * size_coordinate x (rows_of at1 nodes) +
  Rabs (IZR (at2 axis)) * size_coordinate x (rows_of at2 nodes) =
  sum (fun n => fst n * row_along axis x (snd n)) nodes.
Proof.
  unfold size_coordinate, rows_of. rewrite !sum_map. cbn [fst snd]. rewrite <- !sum_scale, <- !sum_plus.
  apply sum_ext. apply Forall_forall. intros n _. unfold row_along. ring.
Qed.

Theorem vertex_error axis b x nodes most :
  is_axis axis -> in_box (box_of_model b) (point_of x) -> all_of number x ->
  Forall (fun n => is_weight (fst n) /\ map_number (snd n) /\ exact_magnitude axis b (snd n) <= most) nodes ->
  sum fst nodes = 1 ->
  Rabs (along_axis axis (evaluate_vertex real_ops x nodes) - along_axis axis (exact_vertex x nodes)) <=
  growth (4 + length nodes) * most + 3 * underflow (length nodes) * eta.
Proof.
  intros (A0 & A1 & A2) I X F S.
  assert (C : forall f, (forall m, map_number m -> row_number (f m)) ->
    Rabs (evaluate_coordinate real_ops x (rows_of f nodes) - exact_coordinate x (rows_of f nodes)) <=
    growth (4 + length nodes) * size_coordinate x (rows_of f nodes) + underflow (length nodes) * eta).
  { intros f N. assert (G : Forall (fun n => is_weight (fst n) /\ row_number (snd n)) (rows_of f nodes)).
    { unfold rows_of. apply Forall_map. apply Forall_impl with (2 := F). intros n (W & M & _).
    split; [exact W | now apply N]. }
    destruct (coordinate_approximates x (rows_of f nodes) X G) as (_ & _ & E).
    unfold rows_of in E at 3 5. rewrite !map_length in E. exact E. }
  pose proof (C at0 (fun m M => proj1 M)) as C0. pose proof (C at1 (fun m M => proj1 (proj2 M))) as C1.
  pose proof (C at2 (fun m M => proj2 (proj2 M))) as C2.
  pose proof (axis_component _ _ _ A0 C0) as D0. pose proof (axis_component _ _ _ A1 C1) as D1.
  pose proof (axis_component _ _ _ A2 C2) as D2.
  pose proof (size_sum_along axis x nodes) as Z.
  assert (B : sum (fun n => fst n * row_along axis x (snd n)) nodes <= most).
  { replace most with (most * sum fst nodes) by (rewrite S; ring). rewrite <- sum_scale. apply sum_le.
    apply Forall_impl with (2 := F). intros n ((_ & W) & _ & L). rewrite (Rmult_comm most).
    apply Rmult_le_compat_l; [lra |]. apply Rle_trans with (2 := L). now apply row_along_below. }
  pose proof (growth_nonnegative prec (4 + length nodes)) as G.
  assert (growth (4 + length nodes) * sum (fun n => fst n * row_along axis x (snd n)) nodes <=
          growth (4 + length nodes) * most) by (apply Rmult_le_compat_l; assumption).
  rewrite <- Z in H. unfold along_axis. cbn [at0 at1 at2 evaluate_vertex exact_vertex].
  fold (rows_of at0 nodes). fold (rows_of at1 nodes). fold (rows_of at2 nodes).
  set (e0 := evaluate_coordinate real_ops x (rows_of at0 nodes)) in *.
  set (e1 := evaluate_coordinate real_ops x (rows_of at1 nodes)) in *.
  set (e2 := evaluate_coordinate real_ops x (rows_of at2 nodes)) in *.
  set (x0 := exact_coordinate x (rows_of at0 nodes)) in *. set (x1 := exact_coordinate x (rows_of at1 nodes)) in *.
  set (x2 := exact_coordinate x (rows_of at2 nodes)) in *.
  replace (IZR (at0 axis) * e0 + IZR (at1 axis) * e1 + IZR (at2 axis) * e2 -
           (IZR (at0 axis) * x0 + IZR (at1 axis) * x1 + IZR (at2 axis) * x2))
    with (IZR (at0 axis) * (e0 - x0) + IZR (at1 axis) * (e1 - x1) + IZR (at2 axis) * (e2 - x2)) by ring.
  pose proof (Rabs_triang (IZR (at0 axis) * (e0 - x0) + IZR (at1 axis) * (e1 - x1)) (IZR (at2 axis) * (e2 - x2))).
  pose proof (Rabs_triang (IZR (at0 axis) * (e0 - x0)) (IZR (at1 axis) * (e1 - x1))).
  assert (UP : 0 <= underflow (length nodes) * eta).
  { apply Rmult_le_pos; [| apply Rlt_le, eta_positive]. unfold underflow.
    pose proof (pos_INR (length nodes)). pose proof (power_at_least_1 prec (length nodes)). nra. }
  assert (One : forall a, (-1 <= a <= 1)%Z ->
    Rabs (IZR a) * (underflow (length nodes) * eta) <= underflow (length nodes) * eta).
  { intros a Ia. apply axis_at_most_1 in Ia. rewrite <- (Rmult_1_l (underflow (length nodes) * eta)) at 2.
    apply Rmult_le_compat_r; lra. }
  pose proof (One _ A0). pose proof (One _ A1). pose proof (One _ A2). lra.
Qed.

(* k: the most simulation nodes of any vertex. *)
Theorem evaluation_error_covers k n most magnitude :
  (n <= k)%nat -> (1 <= k)%nat -> INR (k + 8) * INR (k + 8) * u <= 1 -> 0 <= most ->
  0 <= magnitude <= (1 + 7.02 * u) * most + 1.53 * eta ->
  growth (4 + n) * magnitude + 3 * underflow n * eta <= evaluation_error real_ops (Z.of_nat k) most.
Proof.
  intros L K1 S P M. pose proof (u_positive prec) as U. pose proof (u_small prec emin) as US.
  pose proof (eta_positive emin) as E0.
  assert (KP : 1 <= INR k) by (apply (le_INR 1); exact K1).
  assert (NK : INR n <= INR k) by now apply le_INR. pose proof (pos_INR n) as N0.
  rewrite plus_INR in S. replace (INR 8) with 8 in S by (simpl; ring).
  set (q := (INR k + 8) * u).
  assert (Q0 : 0 <= q) by (apply Rmult_le_pos; lra).
  assert (Q : q <= / 4096).
  { apply Rsqr_incr_0_var; [| lra]. unfold Rsqr.
    replace (q * q) with ((INR k + 8) * (INR k + 8) * u * u) by (unfold q; ring).
    assert ((INR k + 8) * (INR k + 8) * u * u <= 1 * u) by (apply Rmult_le_compat_r; lra). lra. }
  assert (Q2 : (INR k + 8) * q <= 1) by (unfold q; rewrite <- Rmult_assoc; exact S).
  (* growth of 4 + n and of n *)
  assert (IN : INR (4 + n) * u <= q).
  { unfold q. rewrite plus_INR. replace (INR 4) with 4 by (simpl; ring). apply Rmult_le_compat_r; lra. }
  assert (IP : 0 <= INR (4 + n) * u) by (apply Rmult_le_pos; [apply pos_INR | lra]).
  pose proof (growth_small prec (4 + n) ltac:(lra)) as G.
  assert (GQ : INR (4 + n) * u * (INR (4 + n) * u) <= u).
  { apply Rle_trans with (q * q); [apply Rmult_le_compat; lra |].
    replace (q * q) with ((INR k + 8) * q * u) by (unfold q; ring).
    rewrite <- (Rmult_1_l u) at 2. apply Rmult_le_compat_r; lra. }
  assert (G1 : growth (4 + n) <= (INR k + 5) * u).
  { apply Rle_trans with (1 := G). rewrite plus_INR in *. replace (INR 4) with 4 in * by (simpl; ring).
    assert (INR n * u <= INR k * u) by (apply Rmult_le_compat_r; lra). lra. }
  assert (IN2 : INR n * u <= / 4096).
  { apply Rle_trans with (2 := Q). unfold q. apply Rmult_le_compat_r; lra. }
  assert (IN3 : 0 <= INR n * u) by (apply Rmult_le_pos; lra).
  pose proof (growth_small prec n ltac:(lra)) as Gn. unfold growth in Gn.
  assert (INR n * u * (INR n * u) <= / 4096 * / 4096) by (apply Rmult_le_compat; lra).
  assert (UF : 3 * underflow n <= 6.2 * INR k).
  { unfold underflow. assert (PW : (1 + u) ^ n <= 1.001) by lra. pose proof (power_at_least_1 prec n).
    assert (INR n * (1 + u) ^ n <= INR k * 1.001) by (apply Rmult_le_compat; lra). lra. }
  assert (UF2 : 3 * underflow n * eta <= 6.2 * INR k * eta) by (apply Rmult_le_compat_r; lra).
  (* what the term is *)
  assert (ZK : IZR (Z.of_nat k + 8) = INR k + 8) by (rewrite plus_IZR, <- INR_IZR_INZ; reflexivity).
  assert (Big : (Z.of_nat k + 8 < 2 ^ prec)%Z).
  { pose proof (@prec_large prec emin format). apply lt_IZR. rewrite IZR_power, ZK by lia.
    assert (HU : u * bpow radix2 prec = 1) by (unfold u, rounding.u; rewrite <- bpow_plus, Z.add_opp_diag_l;
      reflexivity).
    pose proof (bpow_gt_0 radix2 prec).
    assert (q * bpow radix2 prec <= / 4096 * bpow radix2 prec) by (apply Rmult_le_compat_r; lra).
    unfold q in H2. rewrite Rmult_assoc, HU in H2. lra. }
  rewrite (model_evaluation_error prec emin) by lia.
  pose proof (error_term prec emin (Z.of_nat k + 8) (8 * Z.of_nat k) most ltac:(lia) P) as T.
  apply Rle_trans with (2 := T). rewrite ZK, mult_IZR, <- INR_IZR_INZ.
  pose proof (growth_nonnegative prec (4 + n)).
  assert (H2 : growth (4 + n) * magnitude <= (INR k + 5) * u * ((1 + 7.02 * u) * most + 1.53 * eta))
    by (apply Rmult_le_compat; lra).
  set (Y := u * most) in *. assert (Y0 : 0 <= Y) by (apply Rmult_le_pos; lra).
  assert (QY : q * Y <= / 4096 * Y) by (apply Rmult_le_compat_r; lra).
  assert (QE : q * eta <= / 4096 * eta) by (apply Rmult_le_compat_r; lra).
  assert (KE : 1 * eta <= INR k * eta) by (apply Rmult_le_compat_r; lra).
  assert (UY : 0 <= u * Y) by (apply Rmult_le_pos; lra).
  assert (UE : 0 <= u * eta) by (apply Rmult_le_pos; lra).
  replace ((INR k + 5) * u * ((1 + 7.02 * u) * most + 1.53 * eta))
    with (INR k * Y + 5 * Y + 7.02 * (q * Y - 3 * (u * Y)) + 1.53 * (q * eta - 3 * (u * eta))) in H2
    by (unfold q, Y; ring).
  replace ((INR k + 8) * u * (1 - u) * most) with (INR k * Y + 8 * Y - q * Y) by (unfold q, Y; ring).
  lra.
Qed.
End Evaluation.
