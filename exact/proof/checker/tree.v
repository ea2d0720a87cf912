(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* The tree of BVs: that it is one, and what of the vertices is collected along it, from the leaves to the root. *)
From Coq Require Import ZArith List Bool.
From CinchChecker Require Import content table.
Import ListNotations.
Open Scope Z_scope.

Definition leaf_triangles (b : bv) : list Z := match b with Leaf l => l | Inner _ _ => [] end.
Definition children (b : bv) : list Z := match b with Leaf _ => [] | Inner l r => [l; r] end.

(* BV i of a file: children come after their parents. *)
Definition is_bv (bv_count i : Z) (b : bv) : bool :=
  match b with
  | Leaf [] => false
  | Leaf _ => true
  | Inner l r => (i <? l) && (l <? bv_count) && (i <? r) && (r <? bv_count)
  end.

Definition is_tree (bv_count triangle_count : Z) (bs : list bv) : bool :=
  each_once 1 (bv_count - 1) (gather children bs) && each_once 0 triangle_count (gather leaf_triangles bs).

(* BVs with the vertices of leaves *)
Inductive held := Holds (vs : list Z) | Joins (left right : Z).

Definition corners_of (ts : table triangle) (t : Z) : list Z :=
  match get ts t with Some tri => [corner_a tri; corner_b tri; corner_c tri] | None => [] end.
Definition held_by (ts : table triangle) (b : bv) : held :=
  match b with Leaf l => Holds (gather (corners_of ts) l) | Inner l r => Joins l r end.

Section Climb.
  Context {A : Type} (join : A -> A -> A) (own : Z -> option A).

  Definition join_known (a b : option A) : option A :=
    match a, b with Some x, Some y => Some (join x y) | _, _ => None end.

  Definition joined (vs : list Z) : option A :=
    match vs with
    | [] => None
    | v :: others => fold_left (fun s w => join_known s (own w)) others (own v)
    end.

  Definition collected (done : table A) (h : held) : option A :=
    match h with Holds vs => joined vs | Joins l r => join_known (get done l) (get done r) end.

  (* `left`: BVs i, i - 1, ..., 0; `done` and `out`: of those after i *)
  Fixpoint climb (i : Z) (left : list held) (done : table A) (out : list (option A)) : list (option A) :=
    match left with
    | [] => out
    | h :: others =>
      match collected done h with
      | Some a => climb (i - 1) others (put i a done) (Some a :: out)
      | None => climb (i - 1) others done (None :: out)
      end
    end.
End Climb.
