(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* From a vertex to D(lambda): rest boxes, local boxes per simulation node, morph boxes, affine maps, convex
   combinations; section 2 of the mathematics of this toolkit, in real numbers. *)
From Coq Require Import Reals Lra List.
From CinchProof Require Import duality.
Import ListNotations.
Open Scope R_scope.

Record point := Point { px : R; py : R; pz : R }.
Definition dot (a b : point) : R := px a * px b + py a * py b + pz a * pz b.
Definition shift (a b : point) : point := Point (px a + px b) (py a + py b) (pz a + pz b).
Definition scale (s : R) (a : point) : point := Point (s * px a) (s * py a) (s * pz a).

(* x -> A x + t, by rows. *)
Record affine := Affine { row_x : point; row_y : point; row_z : point; translation : point }.
Definition apply (m : affine) (x : point) : point :=
  Point (dot (row_x m) x + px (translation m)) (dot (row_y m) x + py (translation m))
        (dot (row_z m) x + pz (translation m)).
(* The same without the translation. *)
Definition turn (m : affine) (x : point) : point := Point (dot (row_x m) x) (dot (row_y m) x) (dot (row_z m) x).
(* q = A^T gamma. *)
Definition pull (m : affine) (g : point) : point :=
  Point (px g * px (row_x m) + px (row_y m) * py g + px (row_z m) * pz g)
        (px g * py (row_x m) + py (row_y m) * py g + py (row_z m) * pz g)
        (px g * pz (row_x m) + pz (row_y m) * py g + pz (row_z m) * pz g).

Lemma pull_apply m g x : dot g (apply m x) = dot (pull m g) x + dot g (translation m).
Proof. unfold dot, apply, pull, dot; simpl; ring. Qed.
Lemma pull_turn m g x : dot g (turn m x) = dot (pull m g) x.
Proof. unfold dot, turn, pull, dot; simpl; ring. Qed.

(* The box centre +- half. *)
Record box := Box { centre : point; half : point }.
Definition in_box (b : box) (x : point) : Prop :=
  Rabs (px x - px (centre b)) <= px (half b) /\ Rabs (py x - py (centre b)) <= py (half b) /\
  Rabs (pz x - pz (centre b)) <= pz (half b).
Definition reach (q e : point) : R := Rabs (px q) * px e + Rabs (py q) * py e + Rabs (pz q) * pz e.
Definition box_support (b : box) (q : point) : R := dot q (centre b) + reach q (half b).

Lemma product_below a d e : Rabs d <= e -> a * d <= Rabs a * e.
Proof.
  intros D. apply Rle_trans with (Rabs (a * d)); [apply RRle_abs |].
  rewrite Rabs_mult. apply Rmult_le_compat_l; [apply Rabs_pos | exact D].
Qed.

Theorem box_support_bounds b q x : in_box b x -> dot q x <= box_support b q.
Proof.
  intros (X & Y & Z'). unfold box_support, reach, dot.
  pose proof (product_below (px q) _ _ X). pose proof (product_below (py q) _ _ Y).
  pose proof (product_below (pz q) _ _ Z'). lra.
Qed.

(* b_j: the extremum of an affine map over a box along gamma. *)
Definition node_extremum (b : box) (m : affine) (g : point) : R :=
  box_support b (pull m g) + dot g (translation m).

Theorem node_extremum_bounds b m g x : in_box b x -> dot g (apply m x) <= node_extremum b m g.
Proof.
  intros I. rewrite pull_apply. unfold node_extremum. pose proof (box_support_bounds b (pull m g) x I). lra.
Qed.

(* Lemma 1 of the paper for any set that is given by corners: affine maps keep convex combinations. *)
Fixpoint combine (s : list (R * point)) : point :=
  match s with [] => Point 0 0 0 | (u, p) :: r => shift (scale u p) (combine r) end.

Lemma dot_combine g s : dot g (combine s) = sum (fun p => fst p * dot g (snd p)) s.
Proof.
  induction s as [| [u p] r IH]; [unfold dot, sum; simpl; ring |].
  rewrite sum_cons, <- IH. unfold dot; simpl; ring.
Qed.

Theorem apply_combine m s :
  sum fst s = 1 -> apply m (combine s) = combine (map (fun p => (fst p, apply m (snd p))) s).
Proof.
  intros S.
  assert (H : forall r,
    combine (map (fun p => (fst p, apply m (snd p))) r) = shift (turn m (combine r)) (scale (sum fst r) (translation
      m))).
  { induction r as [| [u p] r IH]; simpl.
    - unfold shift, turn, scale, sum, dot; simpl; f_equal; ring.
    - rewrite IH, sum_cons. unfold shift, turn, scale, apply, dot; simpl; f_equal; ring. }
  rewrite H, S. unfold shift, turn, scale, apply; simpl; f_equal; ring.
Qed.

(* The hull of what a bound holds for is below it too. *)
Theorem hull_below g bound s :
  sum fst s = 1 -> Forall (fun p => 0 <= fst p /\ dot g (snd p) <= bound) s -> dot g (combine s) <= bound.
Proof.
  intros S F. rewrite dot_combine. replace bound with (bound * sum fst s) by (rewrite S; ring).
  rewrite <- sum_scale. apply sum_le. apply Forall_impl with (2 := F).
  intros p [P D]. rewrite (Rmult_comm bound). now apply Rmult_le_compat_l.
Qed.

(* One simulation node's share of a vertex: its interval, its map, its box and the vertex's weight. *)
Record share := Share { interval : R * R; map_of : affine; box_of : box; weight : R }.
Definition vertex (s : list share) (x : point) : point := combine (map (fun n => (weight n, apply (map_of n) x)) s).
Definition node_of (g : point) (n : share) : node :=
  Node (fst (interval n)) (snd (interval n)) (node_extremum (box_of n) (map_of n) g).
Definition nodes_of (g : point) (s : list share) : list node := map (node_of g) s.
(* Only nodes that influence the vertex need to hold it in their boxes: local boxes. One box for all is an instance. *)
Definition share_ok (x : point) (n : share) : Prop :=
  fst (interval n) <= weight n <= snd (interval n) /\ 0 <= weight n /\ (weight n <> 0 -> in_box (box_of n) x).

Lemma vertex_below_mean g x s :
  Forall (share_ok x) s -> dot g (vertex s x) <= mean (map (fun n => (node_of g n, weight n)) s).
Proof.
  intros F. unfold vertex. rewrite dot_combine. unfold mean. rewrite !sum_map. simpl. apply sum_le.
  apply Forall_impl with (2 := F). intros n (_ & P & B).
  destruct (Req_dec (weight n) 0) as [Z | N]; [rewrite Z; lra |].
  apply Rmult_le_compat_l; [exact P |]. now apply node_extremum_bounds, B.
Qed.

Lemma shares_in_space g x s :
  Forall (share_ok x) s -> sum weight s = 1 -> in_space (map (fun n => (node_of g n, weight n)) s).
Proof.
  intros F S. split; [| rewrite sum_map; exact S].
  apply Forall_map. apply Forall_impl with (2 := F). intros n (I & _). exact I.
Qed.

(* The whole chain: a vertex whose rest position lies in the boxes and whose weights lie in the intervals is below
   D(lambda) of the nodes' extrema, for every direction and every lambda. *)
Theorem vertex_below_dual lambda g x s :
  Forall (share_ok x) s -> sum weight s = 1 -> dot g (vertex s x) <= dual lambda (nodes_of g s).
Proof.
  intros F S. apply Rle_trans with (1 := vertex_below_mean g x s F).
  pose proof (weak_duality lambda _ (shares_in_space g x s F S)) as W.
  rewrite map_map in W. exact W.
Qed.

(* Morph targets: a box of displacements d, weighted by a, moves a rest position; boxes add. *)
Definition box_sum (a b : box) : box := Box (shift (centre a) (centre b)) (shift (half a) (half b)).
Definition box_scale (s : R) (b : box) : box := Box (scale s (centre b)) (scale (Rabs s) (half b)).

Theorem in_box_sum a b x d : in_box a x -> in_box b d -> in_box (box_sum a b) (shift x d).
Proof.
  assert (H : forall x c d f e h, Rabs (x - c) <= e -> Rabs (d - f) <= h -> Rabs (x + d - (c + f)) <= e + h).
  { intros x' c d' f e h X D. replace (x' + d' - (c + f)) with ((x' - c) + (d' - f)) by ring.
    pose proof (Rabs_triang (x' - c) (d' - f)). lra. }
  intros (A & B & C) (D & E & F). repeat split; simpl; now apply H.
Qed.

Theorem in_box_scale s b d : in_box b d -> in_box (box_scale s b) (scale s d).
Proof.
  assert (H : forall d c e, Rabs (d - c) <= e -> Rabs (s * d - s * c) <= Rabs s * e).
  { intros d' c e D. rewrite <- Rmult_minus_distr_l, Rabs_mult. apply Rmult_le_compat_l; [apply Rabs_pos | exact D]. }
  intros (A & B & C). repeat split; simpl; now apply H.
Qed.

Fixpoint displaced (x : point) (morphs : list (R * point)) : point :=
  match morphs with [] => x | (a, d) :: r => shift (displaced x r) (scale a d) end.
Fixpoint morph_box (b : box) (morphs : list (R * box)) : box :=
  match morphs with [] => b | (a, m) :: r => box_sum (morph_box b r) (box_scale a m) end.

(* A rest position in its box, displaced by morph targets whose displacements lie in theirs, lies in the box of the
   sum; with vertex_below_dual this bounds characters with morph targets. *)
Theorem displaced_in_morph_box b x (morphs : list (R * (box * point))) :
  in_box b x -> Forall (fun m => in_box (fst (snd m)) (snd (snd m))) morphs ->
  in_box (morph_box b (map (fun m => (fst m, fst (snd m))) morphs))
         (displaced x (map (fun m => (fst m, snd (snd m))) morphs)).
Proof.
  intros I F. induction F as [| [a [m d]] r M _ IH]; simpl in *; [exact I |].
  apply in_box_sum; [exact IH | now apply in_box_scale].
Qed.

(* A support of the parts is a support of the sum. *)
Theorem morph_support a b q : box_support (box_sum a b) q = box_support a q + box_support b q.
Proof. unfold box_support, reach, dot; simpl; ring. Qed.
