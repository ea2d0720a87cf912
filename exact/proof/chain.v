(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* The whole chain with rounding: what bound_box computes along an axis or against it is at least every vertex of the
   BV, exact and as evaluate_vertex computes it. In real numbers with rounding; ieee_bound_box.v adds overflow. *)
From Coq Require Import Reals Lra Lia ZArith List Permutation.
From Flocq Require Import Core.
From CinchProof Require Import duality geometry rounding successor approximation model real_model extremum evaluation.
Import ListNotations.
Open Scope R_scope.

Section Chain.
Variables prec emin : Z.
Context {format : Format prec emin}.
Notation fl := (fl prec emin).
Notation number := (number prec emin).
Notation u := (u prec).
Notation eta := (eta emin).
Notation real_ops := (real_ops prec emin).
Notation map_number := (map_number prec emin).
Notation box_number := (box_number prec emin).
Notation is_weight := (is_weight prec emin).
Notation influence := (influence (num := R)).

Variables (axis : triple Z) (b : model.box (num := R)) (x : triple R).

(* A vertex of the BV: the weight of each of the BV's simulation nodes, 0 for those that do not influence it. *)
Definition exact_position (weights : list (influence * R)) : point :=
  vertex (map (fun p => Share (influence_l (fst p), influence_h (fst p)) (affine_of (influence_map (fst p)))
                              (box_of_model b) (snd p)) weights) (point_of x).
(* Its row of weights, in any order and without the zeros. *)
Definition is_row (weights : list (influence * R)) (row : list (R * map_rows (num := R))) : Prop :=
  exists zeros, Permutation (map (fun p => (snd p, influence_map (fst p))) weights) (row ++ zeros) /\
                Forall (fun n => fst n = 0) zeros.

Lemma sum_of_row (f : map_rows (num := R) -> R) weights row : is_row weights row ->
  sum (fun p => snd p * f (influence_map (fst p))) weights = sum (fun n => fst n * f (snd n)) row.
Proof.
  intros (zeros & P & Z0).
  transitivity (sum (fun n : R * map_rows => fst n * f (snd n)) (map (fun p => (snd p,
    influence_map (fst p))) weights)).
  - now rewrite sum_map.
  - rewrite (sum_permutation _ _ _ P), sum_app.
  assert (N : sum (fun n => fst n * f (snd n)) zeros = 0); [| rewrite N; ring].
    clear P. induction Z0 as [| n s E _ IH]; [reflexivity |]. rewrite sum_cons, IH, E. ring.
Qed.

Lemma exact_position_along along weights row : is_row weights row ->
  dot (direction along axis) (exact_position weights) = side along * along_axis axis (exact_vertex x row).
Proof.
  intros P. unfold exact_position, vertex. rewrite dot_combine, !sum_map. cbn [fst snd weight map_of].
  rewrite (sum_of_row (fun m => dot (direction along axis) (apply (affine_of m) (point_of x))) weights row P).
  unfold along_axis, exact_vertex, exact_coordinate, rows_of. cbn [at0 at1 at2]. rewrite !sum_map. cbn [fst snd].
  rewrite <- !sum_scale, <- !sum_plus, <- sum_scale. apply sum_ext. apply Forall_forall. intros n _.
  unfold exact_row, sum3, direction, dot, apply, affine_of. simpl. unfold dot. simpl. ring.
Qed.

(* The nodes with their computed extrema. *)
Definition computed_node (along : bool) (n : influence) : node :=
  Node (influence_l n) (influence_h n) (extremum_of real_ops along axis b (influence_map n)).
Definition computed_nodes along (weights : list (influence * R)) : list (node * R) :=
  map (fun p => (computed_node along (fst p), snd p)) weights.

Record bounded_vertex (most : R) (k : nat) (weights : list (influence * R)) (row : list (R * map_rows (num := R))) :
  Prop := {
  rest_inside : in_box (box_of_model b) (point_of x);
  rest_number : all_of number x;
  maps_numbers : Forall (fun p => map_number (influence_map (fst p))) weights;
  magnitudes : Forall (fun p => extremum_magnitude real_ops axis b (influence_map (fst p)) <= most) weights;
  weights_ok : Forall (fun p => is_weight (snd p) /\
                                influence_l (fst p) <= snd p <= influence_h (fst p)) weights;
  weights_sum : sum snd weights = 1;
  row_ok : is_row weights row;
  row_length : (length row <= k)%nat;
  k_ok : (1 <= k)%nat /\ INR (k + 8) * INR (k + 8) * u <= 1
}.

Lemma computed_in_space along most k weights row : bounded_vertex most k weights row ->
  in_space (computed_nodes along weights).
Proof.
  intros V. destruct V. split.
  - unfold computed_nodes. apply Forall_map. apply Forall_impl with (2 := weights_ok0). intros p (_ & I). exact I.
  - unfold computed_nodes. rewrite sum_map. exact weights_sum0.
Qed.

Lemma row_facts most k weights row : bounded_vertex most k weights row -> is_axis axis -> box_number b ->
  Forall (fun n => is_weight (fst n) /\ map_number (snd n) /\
                   exact_magnitude axis b (snd n) <= (1 + 7.02 * u) * most + 1.53 * eta) row /\
  sum fst row = 1.
Proof.
  intros V A B. destruct V. split.
  - destruct row_ok0 as (zeros & P & _).
    assert (F : Forall (fun n => is_weight (fst n) /\ map_number (snd n) /\
                                 exact_magnitude axis b (snd n) <= (1 + 7.02 * u) * most + 1.53 * eta) (row ++ zeros)).
    { apply (Permutation_Forall P). apply Forall_map. apply Forall_forall. intros p I. cbn [fst snd].
      rewrite Forall_forall in maps_numbers0, magnitudes0, weights_ok0.
      specialize (maps_numbers0 p I). specialize (magnitudes0 p I). specialize (weights_ok0 p I).
      split; [apply weights_ok0 |]. split; [exact maps_numbers0 |].
      now apply (magnitude_below_computed prec emin). }
    apply Forall_app in F. apply F.
  - pose proof (sum_of_row (fun _ => 1) weights row row_ok0) as S.
    replace (sum fst row) with (sum (fun n => fst n * 1) row) by (apply sum_ext, Forall_forall; intros; cbv beta; ring).
    transitivity (sum snd weights); [| exact weights_sum0].
    transitivity (sum (fun p : influence * R => snd p * 1) weights); [symmetry; exact S |].
    apply sum_ext, Forall_forall. intros; cbv beta; ring.
Qed.

Lemma most_nonnegative most k weights row : bounded_vertex most k weights row -> box_number b -> 0 <= most.
Proof.
  intros V B. destruct V. destruct weights as [| p weights]; [unfold sum in weights_sum0; simpl in weights_sum0; lra |].
  apply Forall_inv in magnitudes0. apply Rle_trans with (2 := magnitudes0). now apply (magnitude_nonnegative prec emin).
Qed.

(* The exact vertex against the computed extrema: extremum_error. *)
Theorem exact_vertex_below along most k weights row bound :
  is_axis axis -> box_number b -> bounded_vertex most k weights row ->
  mean (computed_nodes along weights) <= bound ->
  dot (direction along axis) (exact_position weights) <= bound + extremum_error real_ops most.
Proof.
  intros A B V M. pose proof V as V0. destruct V.
  apply Rle_trans with (mean (computed_nodes along weights) + extremum_error real_ops most); [| lra].
  unfold exact_position. eapply Rle_trans; [apply vertex_below_mean |].
  - apply Forall_map. apply Forall_impl with (2 := weights_ok0). intros p ((_ & P) & I).
    split; [exact I |]. split; [apply P |]. intros _. exact rest_inside0.
  - unfold mean, computed_nodes. rewrite !sum_map. cbn [fst snd weight node_of extremum computed_node].
    replace (extremum_error real_ops most) with (extremum_error real_ops most * sum snd weights)
      by (rewrite weights_sum0; ring).
    rewrite <- sum_scale, <- sum_plus. apply sum_le. apply Forall_forall. intros p I.
    rewrite Forall_forall in maps_numbers0, magnitudes0, weights_ok0.
    specialize (maps_numbers0 p I). specialize (magnitudes0 p I). specialize (weights_ok0 p I).
    destruct weights_ok0 as ((_ & W) & _).
    pose proof (extremum_error_covers prec emin along axis b _ most A B maps_numbers0 magnitudes0) as E.
    apply Rabs_le_inv in E. rewrite (Rmult_comm (extremum_error real_ops most)), <- Rmult_plus_distr_l.
    apply Rmult_le_compat_l; [lra |]. fold (exact_extremum along axis b (influence_map (fst p))).
    unfold exact_extremum in *. unfold box_of, map_of. lra.
Qed.

(* The computed vertex against the exact one: evaluation_error. *)
Theorem computed_vertex_near along most k weights row :
  is_axis axis -> box_number b -> bounded_vertex most k weights row ->
  dot (direction along axis) (point_of (evaluate_vertex real_ops x row)) <=
  dot (direction along axis) (exact_position weights) + evaluation_error real_ops (Z.of_nat k) most.
Proof.
  intros A B V. destruct (row_facts _ _ _ _ V A B) as [F S]. pose proof (most_nonnegative _ _ _ _ V B) as P.
  destruct V as [RI RN _ _ _ _ RO RL (K1 & KO)].
  pose proof (vertex_error prec emin axis b x row _ A RI RN F S) as E.
  pose proof (evaluation_error_covers prec emin k (length row) most ((1 + 7.02 * u) * most + 1.53 * eta) RL K1 KO P)
    as C.
  assert (I : 0 <= (1 + 7.02 * u) * most + 1.53 * eta <= (1 + 7.02 * u) * most + 1.53 * eta).
  { split; [| apply Rle_refl]. pose proof (u_positive prec). pose proof (eta_positive emin).
    assert (0 <= (1 + 7.02 * u) * most) by (apply Rmult_le_pos; lra). lra. }
  specialize (C I). pose proof (Rle_trans _ _ _ E C) as D.
  rewrite (exact_position_along along weights row RO).
  assert (H : dot (direction along axis) (point_of (evaluate_vertex real_ops x row)) =
              side along * along_axis axis (evaluate_vertex real_ops x row))
    by (unfold dot, direction, point_of, along_axis; simpl; ring).
  rewrite H. apply Rabs_le_inv in D. destruct along; unfold side; lra.
Qed.

(* succ(bound + succ(extremum_error + evaluation_error)). *)
Definition widened (k : nat) (most bound : R) : R :=
  model.succ real_ops (add real_ops bound (model.succ real_ops
    (add real_ops (extremum_error real_ops most) (evaluation_error real_ops (Z.of_nat k) most)))).

Lemma widened_covers k most bound :
  bound + (extremum_error real_ops most + evaluation_error real_ops (Z.of_nat k) most) <= widened k most bound.
Proof.
  unfold widened. rewrite !(model_succ prec emin). cbn [add real_model.real_ops].
  set (e := extremum_error real_ops most). set (f := evaluation_error real_ops (Z.of_nat k) most).
  pose proof (below_succ_fl prec emin (e + f)) as E.
  pose proof (below_succ_fl prec emin (bound + successor.succ prec emin (fl (e + f)))). lra.
Qed.

Lemma error_terms_nonnegative k most : 0 <= most -> (1 <= k)%nat -> INR (k + 8) * INR (k + 8) * u <= 1 ->
  0 <= evaluation_error real_ops (Z.of_nat k) most.
Proof.
  intros P K S. pose proof (u_positive prec). pose proof (eta_positive emin).
  apply Rle_trans with (2 := evaluation_error_covers prec emin k 0 most 0 ltac:(lia) K S P
    ltac:(split; [lra |]; assert (0 <= (1 + 7.02 * u) * most) by (apply Rmult_le_pos; lra); lra)).
  unfold underflow. simpl (INR 0). pose proof (growth_nonnegative prec (4 + 0)). lra.
Qed.

Theorem bound_box_real along most k weights row bound :
  is_axis axis -> box_number b -> bounded_vertex most k weights row ->
  mean (computed_nodes along weights) <= bound ->
  dot (direction along axis) (exact_position weights) <= widened k most bound /\
  dot (direction along axis) (point_of (evaluate_vertex real_ops x row)) <= widened k most bound.
Proof.
  intros A B V M. pose proof (exact_vertex_below along most k weights row bound A B V M) as E.
  pose proof (computed_vertex_near along most k weights row A B V) as C.
  pose proof (widened_covers k most bound) as W. pose proof (most_nonnegative _ _ _ _ V B) as P.
  destruct V as [_ _ _ _ _ _ _ _ (K1 & KO)]. pose proof (error_terms_nonnegative k most P K1 KO). lra.
Qed.
End Chain.
