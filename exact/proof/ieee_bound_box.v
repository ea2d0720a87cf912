(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* bound_box of toolkit/bounds/bound_box.cpp over IEEE values: a finite support is at least every vertex of the BV,
   exact and as evaluate_vertex computes it, along every axis and against it, by any of its methods. *)
From Coq Require Import Reals Lra Lia ZArith List Bool Permutation.
From Flocq Require Import Core.
From CinchProof Require Import duality geometry rounding successor model real_model dual_bound extremum evaluation
  chain ieee ieee_forward ieee_dual ieee_corners ieee_extremum.
Import ListNotations.
Open Scope R_scope.

Section Ieee_bound_box.
Variables prec emin : Z.
Context {format : Format prec emin}.
Notation u := (u prec).
Notation real_ops := (real_ops prec emin).
Context {num : Type} {o : ops num} {view : num -> value}.
Variable I : ieee prec emin o view.
Notation finite := (finite (view := view)).
Notation val := (val (view := view)).
Notation triple_value := (triple_value (view := view)).
Notation map_value := (map_value (view := view)).
Notation box_value := (box_value (view := view)).
Notation influence := (influence (num := num)).

Definition influence_value (n : influence) : model.influence (num := R) :=
  Influence (val (influence_l n)) (val (influence_h n)) (map_value (influence_map n)).

(* The largest magnitude. *)
Lemma largest_finite axis b maps : good_box (view := view) b -> finite (largest_magnitude o axis b maps) ->
  Forall (fun m => finite (extremum_magnitude o axis b m) /\
                   val (extremum_magnitude o axis b m) <= val (largest_magnitude o axis b maps)) maps.
Proof.
  intros B F. unfold largest_magnitude in *.
  destruct forallb eqn:E; [| now apply (infinity_not_finite prec emin I) in F].
  rewrite forallb_forall in E.
  assert (A : Forall (fun m => finite (extremum_magnitude o axis b m)) maps).
  { apply Forall_forall. intros m In. apply (nonnegative_below_infinity prec emin I).
    - now apply (magnitude_view prec emin I).
    - apply E. apply in_map_iff. now exists m. }
  clear E F.
  assert (H : forall s, finite s ->
    let r := fold_left (max o) (map (extremum_magnitude o axis b) maps) s in
    finite r /\ val s <= val r /\
    Forall (fun m => finite (extremum_magnitude o axis b m) /\ val (extremum_magnitude o axis b m) <= val r) maps).
  { induction A as [| m maps Fm _ IH]; intros s Fs; cbn [map fold_left].
    - split; [exact Fs |]. split; [apply Rle_refl | constructor].
    - destruct (max_finite prec emin I s _ Fs Fm) as [FM V]. destruct (IH _ FM) as (Fr & L & R). rewrite V in L.
      pose proof (Rmax_l (val s) (val (extremum_magnitude o axis b m))).
      pose proof (Rmax_r (val s) (val (extremum_magnitude o axis b m))).
      split; [exact Fr |]. split; [cbv zeta in *; lra |].
      constructor; [split; [exact Fm | cbv zeta in *; lra] | exact R]. }
  apply (H (zero o)). apply (zero_value prec emin I).
Qed.

(* What a bound over W' is: if finite, so are the extrema, and it is at least every mean. *)
Section Methods.
Variables (nodes : list influence) (extremum_at : influence -> num).
Definition node_at (n : influence) : node :=
  Node (val (influence_l n)) (val (influence_h n)) (val (extremum_at n)).
Definition weights_in_space (weights : list (influence * R)) : Prop :=
  map fst weights = nodes /\ in_space (map (fun p => (node_at (fst p), snd p)) weights) /\
  Forall (fun p => 0 <= snd p) weights.
Definition sound (bound : num) : Prop := finite bound ->
  Forall (fun n => finite (extremum_at n)) nodes /\
  forall weights, weights_in_space weights -> mean (map (fun p => (node_at (fst p), snd p)) weights) <= val bound.

Lemma min_sound x y : sound x -> sound y -> sound (min o x y).
Proof. intros X Y. unfold min. now destruct less. Qed.

Lemma entries_map : entries nodes (map extremum_at nodes) =
  map (fun n => Entry (influence_l n) (influence_h n) (extremum_at n)) nodes.
Proof. unfold entries. induction nodes as [| n s IH]; simpl; [reflexivity | now rewrite IH]. Qed.

Lemma dual_sound lambda : IZR (length_of nodes) * u <= / 8 ->
  sound (dual_bound o lambda (entries nodes (map extremum_at nodes))).
Proof.
  intros N F. rewrite entries_map in *.
  assert (L : length_of (map (fun n => Entry (influence_l n) (influence_h n) (extremum_at n)) nodes) = length_of nodes)
    by (unfold length_of; now rewrite map_length).
  rewrite <- L in N. destruct (dual_bound_finite prec emin I lambda _ N F) as (_ & B & D).
  split; [rewrite Forall_map in B; exact B |]. intros weights (M & W & _). rewrite map_map in D.
  apply Rle_trans with (2 := D). apply Rle_trans with (1 := weak_duality (val lambda) _ W).
  rewrite map_map. cbn [fst]. rewrite <- (map_map fst node_at), M. apply Rle_refl.
Qed.

Lemma greatest_sound b0 others : map extremum_at nodes = b0 :: others ->
  Forall (fun n => finite (extremum_at n) \/ view (extremum_at n) = Plus) nodes -> sound (greatest o b0 others).
Proof.
  intros E F G.
  assert (F' : Forall (fun b => finite b \/ view b = Plus) (b0 :: others)) by (rewrite <- E; now apply Forall_map).
  pose proof (greatest_finite prec emin I others b0 F' G) as A. rewrite <- E in A. rewrite Forall_map in A.
  split; [apply Forall_impl with (2 := A); now intros n [H _] |].
  intros weights (M & W & P). apply (convex_bound _ _ W). apply Forall_map. apply Forall_forall. intros p In.
  cbn [fst snd node_at extremum]. rewrite Forall_forall in A, P. split; [now apply P |].
  apply A. rewrite <- M. now apply in_map.
Qed.

(* What corners needs besides: weight intervals in units of u. *)
Definition fit_for (how : method (num := num)) : Prop := how = corners ->
  Forall (fun n => unit_interval prec (view := view) (influence_l n) (influence_h n)) nodes /\
  INR (length nodes + 8) * u <= / 16.

Lemma corners_sound : fit_for corners -> nodes <> [] ->
  Forall (fun n => finite (extremum_at n) \/ view (extremum_at n) = Plus) nodes ->
  sound (best_corner o (entries nodes (map extremum_at nodes))).
Proof.
  intros Fit Ne E F. destruct (Fit eq_refl) as [U S]. rewrite entries_map in *.
  set (all := map (fun n => Entry (influence_l n) (influence_h n) (extremum_at n)) nodes) in *.
  assert (H : forall weights, map fst weights = map (fun e => node_of_entry (entry_value (view := view) e)) all ->
    in_space weights -> mean weights <= val (best_corner o all)).
  { intros weights M W. apply (best_corner_sound prec emin I); trivial.
    - unfold all. intros Z. now apply map_eq_nil in Z.
    - unfold all. apply Forall_map. rewrite Forall_forall in U, E |- *. intros n In. split; [exact (U n In) | exact (E n
        In)].
    - unfold all. now rewrite map_length. }
  split.
  - apply (best_corner_finite prec emin I) in F.
    + unfold all in F. rewrite Forall_map in F. exact F.
    + unfold all. intros Z. now apply map_eq_nil in Z.
    + unfold all. apply Forall_map. exact E.
  - intros weights (M & W & _). apply H; [| exact W]. unfold all. rewrite !map_map. cbn [fst].
    rewrite <- (map_map fst node_at), M. reflexivity.
Qed.

Theorem methods_sound how : fit_for how -> IZR (length_of nodes) * u <= / 8 ->
  Forall (fun n => finite (extremum_at n) \/ view (extremum_at n) = Plus) nodes -> nodes <> [] ->
  sound (box_free_bound o how nodes (map extremum_at nodes)).
Proof.
  intros How N F Ne. unfold box_free_bound. destruct (map extremum_at nodes) as [| b0 others] eqn:E.
  - apply map_eq_nil in E. congruence.
  - pose proof (greatest_sound b0 others E F) as G. rewrite <- E.
    destruct how as [| | lambda |]; [exact G | | | now apply corners_sound].
    + apply min_sound; [exact G | now apply dual_sound].
    + apply min_sound; [apply min_sound; [exact G | now apply dual_sound] | now apply dual_sound].
Qed.
End Methods.

(* evaluate_vertex. *)
Lemma row_backward x r : finite (evaluate_row o x r) ->
  val (evaluate_row o x r) = evaluate_row real_ops (triple_value x) (row_value (view := view) r).
Proof.
  unfold evaluate_row. intros F. apply (add_backward prec emin I) in F. destruct F as (F & _ & ->).
  apply (dot3_backward prec emin I) in F. destruct F as (_ & _ & ->). reflexivity.
Qed.

Lemma coordinate_backward x nodes : finite (evaluate_coordinate o x nodes) ->
  val (evaluate_coordinate o x nodes) =
  evaluate_coordinate real_ops (triple_value x)
    (map (fun n => (val (fst n), row_value (view := view) (snd n))) nodes).
Proof.
  unfold evaluate_coordinate.
  assert (H : forall s, finite (fold_left (fun sum n => add o sum (mul o (fst n) (evaluate_row o x (snd n)))) nodes
    s) ->
    finite s /\ val (fold_left (fun sum n => add o sum (mul o (fst n) (evaluate_row o x (snd n)))) nodes s) =
    fold_left (fun sum n => add real_ops sum (mul real_ops (fst n) (evaluate_row real_ops (triple_value x) (snd n))))
      (map (fun n => (val (fst n), row_value (view := view) (snd n))) nodes) (val s)).
  { induction nodes as [| [w r] nodes IH]; intros s F; cbn [fold_left map fst snd] in *; [auto |].
    destruct (IH _ F) as [S ->]. apply (add_backward prec emin I) in S. destruct S as (S & P & ->).
    apply (mul_backward prec emin I) in P. destruct P as (_ & P & ->). rewrite (row_backward x r P). auto. }
  intros F. destruct (H _ F) as [_ ->]. now rewrite (proj2 (zero_value prec emin I)), model_zero.
Qed.

Definition row_values (row : list (num * map_rows (num := num))) : list (R * map_rows (num := R)) :=
  map (fun n => (val (fst n), map_value (snd n))) row.

Lemma vertex_backward x row : all_finite (view := view) (evaluate_vertex o x row) ->
  triple_value (evaluate_vertex o x row) = evaluate_vertex real_ops (triple_value x) (row_values row).
Proof.
  intros (F0 & F1 & F2). unfold evaluate_vertex in *. cbn [at0 at1 at2] in *.
  unfold ieee_extremum.triple_value at 1. cbn [at0 at1 at2].
  rewrite (coordinate_backward _ _ F0), (coordinate_backward _ _ F1), (coordinate_backward _ _ F2).
  unfold row_values. rewrite !map_map. reflexivity.
Qed.

(* A vertex of the BV: rest position, weights of all of the BV's simulation nodes, and its own row of weights. *)
Record vertex_of_bv (b : box (num := num)) (k : nat) (nodes : list influence) (x : triple num)
    (weights : list (influence * num)) (row : list (num * map_rows (num := num))) : Prop := {
  v_rest : in_box (box_of_model (box_value b)) (point_of (triple_value x));
  v_nodes : map fst weights = nodes;
  v_weights : Forall (fun p => 0 <= val (snd p) <= 1 /\
                               val (influence_l (fst p)) <= val (snd p) <= val (influence_h (fst p))) weights;
  v_sum : sum (fun p => val (snd p)) weights = 1;
  v_row : exists zeros, Permutation (map (fun p => (snd p, influence_map (fst p))) weights) (row ++ zeros) /\
                        Forall (fun n => val (fst n) = 0) zeros;
  v_length : (length row <= k)%nat
}.

Definition weight_values (weights : list (influence * num)) : list (model.influence (num := R) * R) :=
  map (fun p => (influence_value (fst p), val (snd p))) weights.

(* k u is small: n_k < 2^20 in double is far below. *)
Definition few_influences (k : nat) : Prop := (1 <= k)%nat /\ INR (k + 8) * INR (k + 8) * u <= 1.

Lemma few_is_small k : few_influences k -> (8 * (Z.of_nat k + 8) < 2 ^ prec)%Z.
Proof.
  intros [_ S]. pose proof (@prec_large prec emin format). pose proof (u_positive prec). pose proof (u_small prec emin).
  apply lt_IZR. rewrite IZR_power, mult_IZR, plus_IZR, <- INR_IZR_INZ by lia.
  rewrite plus_INR in S. replace (INR 8) with 8 in S by (simpl; ring). pose proof (pos_INR k).
  assert (HU : u * bpow radix2 prec = 1) by (unfold u, rounding.u; rewrite <- bpow_plus, Z.add_opp_diag_l; reflexivity).
  assert (Q : (INR k + 8) * u <= / 4096).
  { apply Rsqr_incr_0_var; [| lra]. unfold Rsqr.
    replace ((INR k + 8) * u * ((INR k + 8) * u)) with ((INR k + 8) * (INR k + 8) * u * u) by ring.
    assert ((INR k + 8) * (INR k + 8) * u * u <= 1 * u) by (apply Rmult_le_compat_r; lra). lra. }
  pose proof (bpow_gt_0 radix2 prec).
  assert ((INR k + 8) * (u * bpow radix2 prec) <= / 4096 * bpow radix2 prec)
    by (rewrite <- Rmult_assoc; apply Rmult_le_compat_r; lra).
  rewrite HU in *. lra.
Qed.

Theorem bound_box_sound how along axis b k nodes x weights row :
  fit_for nodes how -> is_axis axis -> good_box (view := view) b -> few_influences k -> IZR (length_of nodes) * u <=
    / 8 ->
  vertex_of_bv b k nodes x weights row ->
  finite (bound_box o how along axis b (Z.of_nat k) nodes) ->
  let support := val (bound_box o how along axis b (Z.of_nat k) nodes) in
  dot (direction along axis)
      (exact_position (box_value b) (triple_value x) (weight_values weights)) <= support /\
  (all_finite (view := view) (evaluate_vertex o x row) ->
   dot (direction along axis) (point_of (triple_value (evaluate_vertex o x row))) <= support).
Proof.
  intros How A B K N V F support. unfold support, bound_box in *. clear support.
  destruct forallb; [| now apply (infinity_not_finite prec emin I) in F].
  destruct (less o (largest_magnitude o axis b (map influence_map nodes)) (infinity o)) eqn:LM;
    [| now apply (infinity_not_finite prec emin I) in F].
  set (most := largest_magnitude o axis b (map influence_map nodes)) in *.
  set (extremum_at := fun n => extremum_of o along axis b (influence_map n)) in *.
  set (bound := box_free_bound o how nodes (map extremum_at nodes)) in *.
  set (error := model.succ o (add o (extremum_error o most) (evaluation_error o (Z.of_nat k) most))) in *.
  destruct (less o (model.succ o (add o bound error)) (infinity o));
    [| now apply (infinity_not_finite prec emin I) in F].
  unfold error in *. clear error.
  apply (succ_backward prec emin I) in F. destruct F as (F & ->).
  apply (add_backward prec emin I) in F. destruct F as (FB & F & ->).
  apply (succ_backward prec emin I) in F. destruct F as (F & ->).
  apply (add_backward prec emin I) in F. destruct F as (F & G & ->).
  apply (extremum_error_backward prec emin I) in F. destruct F as (FM & ->).
  apply (evaluation_error_backward prec emin I) in G; [| lia | now apply few_is_small]. destruct G as (_ & ->).
  pose proof (largest_finite axis b (map influence_map nodes) B FM) as L. fold most in L. rewrite Forall_map in L.
  destruct V as [VR VN VW VS (zeros & VP & VZ) VL].
  assert (Ne : nodes <> []).
  { intros E. rewrite E in VN. apply map_eq_nil in VN. subst weights. unfold sum in VS. simpl in VS. lra. }
  assert (E : Forall (fun n => finite (extremum_at n) \/ view (extremum_at n) = Plus) nodes).
  { apply Forall_impl with (2 := L). intros n (Fm & _). now apply (extremum_finite_or_plus prec emin I). }
  destruct (methods_sound nodes extremum_at how How N E Ne FB) as (FE & SB). fold bound in SB.
  assert (BN : box_number prec emin (box_value b)).
  { destruct B as (_ & _ & P). split; [| split]; [| | exact P]; repeat split; apply (val_number prec emin I). }
  assert (MN : forall m, map_number prec emin (map_value m)) by (intros m; repeat split;
    apply (val_number prec emin I)).
  assert (BV : bounded_vertex prec emin axis (box_value b) (triple_value x) (val most) k (weight_values weights)
                 (row_values row)).
  { constructor.
    - exact VR.
    - repeat split; apply (val_number prec emin I).
    - apply Forall_map. apply Forall_forall. intros p _. apply MN.
    - apply Forall_map. apply Forall_forall. intros p In. cbn [fst influence_value influence_map].
      rewrite Forall_forall in L. specialize (L (fst p) ltac:(rewrite <- VN; now apply in_map)).
      destruct L as [Lf Lm]. now rewrite <- (extremum_magnitude_backward prec emin I axis b _ Lf).
    - apply Forall_map. apply Forall_impl with (2 := VW). intros p [W J]. split; [| exact J].
      split; [apply (val_number prec emin I) | exact W].
    - unfold weight_values. rewrite sum_map. exact VS.
    - exists (row_values zeros). split.
      + unfold weight_values, row_values. rewrite <- map_app, map_map. cbn [fst snd influence_value influence_map].
        apply (Permutation_map (fun n => (val (fst n), map_value (snd n)))) in VP. rewrite map_map in VP. exact VP.
      + unfold row_values. apply Forall_map. exact VZ.
    - unfold row_values. now rewrite map_length.
    - exact K. }
  assert (M : mean (computed_nodes prec emin axis (box_value b) along (weight_values weights)) <= val bound).
  { set (w := map (fun p : influence * num => (fst p, val (snd p))) weights).
    assert (Q : computed_nodes prec emin axis (box_value b) along (weight_values weights) =
                map (fun p => (node_at extremum_at (fst p), snd p)) w).
    { unfold computed_nodes, weight_values, w. rewrite !map_map. apply map_ext_in. intros p In. cbn [fst snd].
      f_equal. unfold computed_node, node_at. cbn [influence_value influence_l influence_h influence_map]. f_equal.
      rewrite Forall_forall in FE. specialize (FE (fst p) ltac:(rewrite <- VN; now apply in_map)).
      unfold extremum_at in *. now rewrite (extremum_backward prec emin I along axis b _ A FE). }
    rewrite Q. apply SB. split; [unfold w; rewrite map_map; exact VN |]. split.
    - rewrite <- Q. exact (computed_in_space prec emin axis _ _ along _ k _ _ BV).
    - unfold w. apply Forall_map. apply Forall_impl with (2 := VW). intros p [[P _] _]. exact P. }
  destruct (bound_box_real prec emin axis _ _ along _ k _ _ (val bound) A BN BV M) as [X C].
  split; [exact X |]. intros Fv. now rewrite (vertex_backward x row Fv).
Qed.

(* It is finite or +infinity: never NaN, never -infinity. *)
Theorem bound_box_value_or_infinity how along axis b k nodes :
  finite (bound_box o how along axis b k nodes) \/ view (bound_box o how along axis b k nodes) = Plus.
Proof.
  unfold bound_box. destruct forallb; [| right; apply (law_infinity _ _ _ _ I)].
  destruct (less o (largest_magnitude o axis b (map influence_map nodes)) (infinity o));
    [| right; apply (law_infinity _ _ _ _ I)].
  destruct less eqn:L; [left; now apply (succ_below_infinity prec emin I) | right; apply (law_infinity _ _ _ _ I)].
Qed.
End Ieee_bound_box.
