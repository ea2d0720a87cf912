(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* The main theorems for double and for float, with their conditions in numbers. *)
From Coq Require Import Reals Lra Lia ZArith List.
From Flocq Require Import Core BinarySingleNaN.
From CinchProof Require Import duality geometry rounding successor model real_model dual_bound extremum evaluation chain
  ieee ieee_instances ieee_dual ieee_corners ieee_extremum ieee_bound_box vertex_bound greatest_mean greatest_between.
Import ListNotations.
Open Scope R_scope.

Lemma u_double : rounding.u 53 = / 9007199254740992.
Proof. unfold rounding.u. simpl. lra. Qed.
Lemma u_float : rounding.u 24 = / 16777216.
Proof. unfold rounding.u. simpl. lra. Qed.

(* Vertices of at most 2^20 simulation nodes in double, 4088 in float. *)
Lemma few_in_double k : (1 <= Z.of_nat k <= 1048576)%Z -> few_influences 53 k.
Proof.
  intros K. split; [lia |]. rewrite u_double, plus_INR. replace (INR 8) with 8 by (simpl; ring).
  assert (INR k <= 1048576) by (rewrite INR_IZR_INZ; apply (IZR_le _ 1048576); lia).
  pose proof (pos_INR k). assert ((INR k + 8) * (INR k + 8) <= 1048584 * 1048584) by (apply Rmult_le_compat; lra). lra.
Qed.
Lemma few_in_float k : (1 <= Z.of_nat k <= 4088)%Z -> few_influences 24 k.
Proof.
  intros K. split; [lia |]. rewrite u_float, plus_INR. replace (INR 8) with 8 by (simpl; ring).
  assert (INR k <= 4088) by (rewrite INR_IZR_INZ; apply (IZR_le _ 4088); lia).
  pose proof (pos_INR k). assert ((INR k + 8) * (INR k + 8) <= 4096 * 4096) by (apply Rmult_le_compat; lra). lra.
Qed.

(* BVs of at most 2^50 simulation nodes in double, 2^21 in float. *)
Lemma nodes_in_double n : (n <= 2 ^ 50)%Z -> IZR n * rounding.u 53 <= / 8.
Proof. intros N. rewrite u_double. assert (IZR n <= IZR (2 ^ 50)) by now apply IZR_le. simpl in H. lra. Qed.
Lemma nodes_in_float n : (n <= 2 ^ 21)%Z -> IZR n * rounding.u 24 <= / 8.
Proof. intros N. rewrite u_float. assert (IZR n <= IZR (2 ^ 21)) by now apply IZR_le. simpl in H. lra. Qed.

Notation double := (binary_float 53 1024).
Notation view64 := (ieee_instances.view 53 1024).

(* dual_bound as it runs: for doubles whose result is finite it is at least D of the real values. *)
Theorem dual_bound_double (lambda : double) nodes :
  (length_of nodes <= 2 ^ 50)%Z -> finite (view := view64) (dual_bound binary64_ops lambda nodes) ->
  dual (val (view := view64) lambda) (map (fun e => node_of_entry (entry_value (view := view64) e)) nodes) <=
  val (view := view64) (dual_bound binary64_ops lambda nodes).
Proof. intros N F. exact (proj2 (proj2 (dual_bound_finite 53 (-1074) binary64_ieee lambda nodes (nodes_in_double _ N)
  F))). Qed.

(* bound_box as it runs. *)
Theorem bound_box_double how along axis (b : box (num := double)) k nodes x weights row :
  fit_for 53 (view := view64) nodes how -> is_axis axis -> good_box (view := view64) b -> (1 <= Z.of_nat k <=
    1048576)%Z ->
  (length_of nodes <= 2 ^ 50)%Z -> vertex_of_bv (view := view64) b k nodes x weights row ->
  finite (view := view64) (bound_box binary64_ops how along axis b (Z.of_nat k) nodes) ->
  let support := val (view := view64) (bound_box binary64_ops how along axis b (Z.of_nat k) nodes) in
  dot (direction along axis)
      (exact_position (box_value (view := view64) b) (triple_value (view := view64) x)
                      (weight_values (view := view64) weights)) <= support /\
  (all_finite (view := view64) (evaluate_vertex binary64_ops x row) ->
   dot (direction along axis) (point_of (triple_value (view := view64) (evaluate_vertex binary64_ops x row))) <=
     support).
Proof.
  intros H A B K N V F. apply (bound_box_sound 53 (-1074) binary64_ieee); trivial.
  - now apply few_in_double.
  - now apply nodes_in_double.
Qed.

(* bound_vertex as it runs. *)
Theorem bound_vertex_double along axis (x : triple double) nodes :
  is_axis axis -> (1 <= length_of nodes <= 1048576)%Z ->
  Forall (fun n => 0 <= val (view := view64) (fst n) <= 1) nodes ->
  finite (view := view64) (bound_vertex binary64_ops along axis x nodes) ->
  let support := val (view := view64) (bound_vertex binary64_ops along axis x nodes) in
  side along * along_axis axis
    (exact_vertex (triple_value (view := view64) x) (row_values (view := view64) nodes)) <= support /\
  (all_finite (view := view64) (evaluate_vertex binary64_ops x nodes) ->
   side along * along_axis axis (triple_value (view := view64) (evaluate_vertex binary64_ops x nodes)) <= support).
Proof. intros A K W F. apply (bound_vertex_sound 53 (-1074) binary64_ieee); trivial. now apply few_in_double. Qed.

(* Means over W', and bounds over an interval of time, as they run. *)
Definition greatest_mean_double := greatest_mean_sound 53 (-1074) binary64_ieee.
Definition greatest_between_double := greatest_between_sound 53 (-1074) binary64_ieee.
