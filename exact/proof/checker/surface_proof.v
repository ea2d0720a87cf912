(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* A checked surface is whole: convex weights, triangles that exist, one tree over all of them. *)
From Coq Require Import ZArith List Bool Reals Permutation Lia Lra.
From Flocq Require Import Core.
From CinchChecker Require Import content statement table numbers evaluation tree checker numbers_proof table_proof
  evaluation_proof tree_proof run_proof.
Import ListNotations.
Open Scope Z_scope.

Lemma are_nodes_sound n l : forall last, are_nodes n last l = true ->
  (forall j w, In (j, w) l -> last < j < n /\ is_weight w = true) /\ NoDup (map fst l).
Proof.
  induction l as [| [i x] l IH]; intros last E; [split; [easy | constructor] |]. cbn [are_nodes] in E.
  rewrite !andb_true_iff, !Z.ltb_lt in E. destruct E as [[[L U] W] E]. apply IH in E as [A N]. split.
  - intros j w [D | I]; [injection D as <- <-; auto |]. apply A in I. split; [lia | easy].
  - cbn. constructor; [| easy]. intro I. apply in_map_iff in I as ([j w] & D & I). cbn in D. apply A in I. lia.
Qed.

Lemma is_vertex_weights h v : is_vertex h v = true -> forall j w, In (j, w) (influences v) -> is_weight w = true.
Proof.
  unfold is_vertex. rewrite !andb_true_iff. intros [[_ N] _] j w I. apply are_nodes_sound in N as [A _].
  now apply A in I.
Qed.

Lemma is_vertex_nodes h v : is_vertex h v = true -> forall j w, In (j, w) (influences v) -> 0 <= j < node_count h.
Proof.
  unfold is_vertex. rewrite !andb_true_iff. intros [[_ N] _] j w I. apply are_nodes_sound in N as [A _].
  apply A in I. lia.
Qed.

Lemma sum_of_units l : (forall j w, In (j, w) l -> is_weight w = true) ->
  sum_of l = in_units weight_bits (fold_right (fun jw s => units weight_bits (snd jw) + s) 0 l).
Proof.
  induction l as [| [j w] l IH]; intro W; cbn [sum_of fold_right snd]; [now rewrite in_units_0 |].
  rewrite in_units_add. f_equal.
  - assert (is_weight w = true) as D by (apply (W j w); now left). now apply is_weight_sound in D.
  - apply IH. intros i x I. apply (W i x). now right.
Qed.

Lemma is_vertex_convex h v : is_vertex h v = true -> convex (node_count h) v.
Proof.
  intro V. pose proof (is_vertex_weights h v V) as W. split.
  - apply (is_vertex_nodes h v V).
  - unfold is_vertex in V. rewrite !andb_true_iff in V. destruct V as [[_ N] _]. now apply are_nodes_sound in N.
  - intros j w I. apply W, is_weight_sound in I as (_ & -> & P). unfold in_units.
    apply Rmult_lt_0_compat; [apply IZR_lt; lia | apply bpow_gt_0].
  - intros j w I. apply W, is_weight_sound in I. apply I.
  - rewrite sum_of_units by easy. unfold is_vertex in V. rewrite !andb_true_iff in V. destruct V as [_ S].
    apply Z.eqb_eq in S. rewrite S. unfold in_units, one_weight, weight_bits.
    change 9007199254740992 with (2 ^ 53). rewrite (IZR_Zpower radix2) by lia. rewrite <- bpow_plus. reflexivity.
Qed.

Lemma is_point_doubles p : is_point p = true -> binary64_point p.
Proof.
  unfold is_point. cbn. rewrite !andb_true_iff. intros (X & Y & Z & _). repeat split; now apply is_double_sound.
Qed.

Lemma flat_map_rev {A B : Type} (f : A -> list B) l : Permutation (flat_map f (rev l)) (flat_map f l).
Proof. apply Permutation_flat_map. apply Permutation_sym, Permutation_rev. Qed.

Lemma is_count_positive n : is_count n = true -> 1 <= n.
Proof. unfold is_count. rewrite andb_true_iff, !Z.leb_le. easy. Qed.

Section Checked.
  Context (h : header) (vs : list vertex) (ts : list triangle) (bs : list bv) (C : checked_surface h vs ts bs).

  Lemma header_parts : In (kdop h) [6; 14; 18; 26] /\ 1 <= triangle_count h /\ 1 <= bv_count h /\ 1 <= frame_count h.
  Proof.
    pose proof (header_checked _ _ _ _ C) as H. unfold is_header in H. rewrite !andb_true_iff, !orb_true_iff,
      !Z.eqb_eq in H.
    destruct H as [[[[[K V] T] N] B] F]. apply is_count_positive in T, B, F. cbn. intuition.
  Qed.

  Lemma tree_children : NoDup (flat_map children bs) /\ count (flat_map children bs) = count bs - 1 /\
    forall c, In c (flat_map children bs) -> 1 <= c < count bs.
  Proof.
    pose proof (tree_checked _ _ _ _ C) as T. unfold is_tree in T. apply andb_true_iff in T as [T _].
    apply each_once_sound in T as (N & L & R); [| lia].
    assert (Permutation (gather children (rev bs)) (flat_map children bs)) as P
      by (rewrite gather_flat_map; apply flat_map_rev).
    rewrite (bvs_counted _ _ _ _ C). split; [| split].
    - now apply (Permutation_NoDup P).
    - rewrite <- L. unfold count. now rewrite (Permutation_length P).
    - intros c I. apply (Permutation_in _ (Permutation_sym P)), R in I. lia.
  Qed.

  Lemma tree_triangles : Permutation (flat_map triangles_below bs) (indices (triangle_count h)).
  Proof.
    pose proof (tree_checked _ _ _ _ C) as T. unfold is_tree in T. apply andb_true_iff in T as [_ T].
    apply each_once_indices in T; [| pose proof header_parts; lia].
    rewrite <- T, gather_flat_map. symmetry. apply flat_map_rev.
  Qed.
End Checked.

Theorem checked_surface_whole c : checked c -> whole_surface c.
Proof.
  intros [C _ F _ _ _ _]. destruct (header_parts _ _ _ _ C) as (K & _ & B & _). split; try apply C; try easy.
  - lia.
  - intros v I. apply C in I. unfold is_vertex in I. rewrite !andb_true_iff in I. now apply is_point_doubles.
  - intros v I. apply is_vertex_convex. now apply C.
  - intros t v I V. apply C in I. unfold is_triangle, is_corner in I. rewrite !andb_true_iff, !Z.leb_le,
      !Z.ltb_lt in I.
    destruct V as [-> | [-> | ->]]; lia.
  - now apply (tree_triangles _ _ _ _ C).
  - intros l I. apply In_at_index in I as [i I]. apply C in I. now destruct l.
  - intros i I. rewrite <- (bvs_counted _ _ _ _ C) in I. destruct (tree_children _ _ _ _ C) as (N & L & R).
    apply unique_path; try easy. rewrite (bvs_counted _ _ _ _ C). apply C.
Qed.
