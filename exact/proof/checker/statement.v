(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* What it means, over the real numbers, that a certificate proves its bounds. Nothing here is run. *)
From Coq Require Import ZArith List Reals Permutation.
From Flocq Require Import Core.
From CinchChecker Require Import content.
Import ListNotations.
Open Scope R_scope.

Definition value (d : dyadic) : R := IZR (man d) * bpow radix2 (exn d).

(* A finite double *)
Definition binary64 (d : dyadic) : Prop :=
  generic_format radix2 (FLT_exp (-1074) 53) (value d) /\ Rabs (value d) < bpow radix2 1024.

(* ---- A vertex in real arithmetic ---- *)

Definition no_row : row := Row (Dyadic 0 0) (Dyadic 0 0) (Dyadic 0 0) (Dyadic 0 0).
Definition row_of (pick : affine -> row) (ms : list affine) (j : Z) : row :=
  match at_index ms j with Some m => pick m | None => no_row end.

Definition image (r : row) (x y z : R) : R := value (ra r) * x + value (rb r) * y + value (rc r) * z + value (rt r).

Fixpoint exact_sum (pick : affine -> row) (ms : list affine) (x y z : R) (l : list (Z * dyadic)) : R :=
  match l with
  | [] => 0
  | (j, w) :: rest => value w * image (row_of pick ms j) x y z + exact_sum pick ms x y z rest
  end.

Definition exact_coordinate (pick : affine -> row) (ms : list affine) (v : vertex) : R :=
  exact_sum pick ms (value (px (rest v))) (value (py (rest v))) (value (pz (rest v))) (influences v).

Definition along (g : direction) (x y z : R) : R := let '(a, b, c) := g in IZR a * x + IZR b * y + IZR c * z.

(* ---- A vertex in doubles, as evaluate_vertex (toolkit/deform/evaluate.cpp) has it; None where it overflows ---- *)

Definition fl (x : R) : option R :=
  let y := round radix2 (FLT_exp (-1074) 53) ZnearestE x in
  if Rlt_bool (Rabs y) (bpow radix2 1024) then Some y else None.

Definition lift (op : R -> R -> R) (a b : option R) : option R :=
  match a, b with Some x, Some y => fl (op x y) | _, _ => None end.
Definition fadd := lift Rplus.
Definition fmul := lift Rmult.

Definition computed_image (r : row) (x y z : R) : option R :=
  fadd (fadd (fadd (fmul (Some (value (ra r))) (Some x)) (fmul (Some (value (rb r))) (Some y)))
             (fmul (Some (value (rc r))) (Some z)))
       (Some (value (rt r))).

Definition computed_sum (pick : affine -> row) (ms : list affine) (x y z : R) : list (Z * dyadic) -> option R ->
    option R :=
  fold_left (fun s jw => fadd s (fmul (Some (value (snd jw))) (computed_image (row_of pick ms (fst jw)) x y z))).

Definition computed_coordinate (pick : affine -> row) (ms : list affine) (v : vertex) : option R :=
  computed_sum pick ms (value (px (rest v))) (value (py (rest v))) (value (pz (rest v))) (influences v) (Some 0).

(* A coordinate counts only where the direction has it. *)
Definition part (a : Z) (x : option R) : option R := if Z.eqb a 0 then Some 0 else option_map (Rmult (IZR a)) x.
Definition along_computed (g : direction) (x y z : option R) : option R :=
  let '(a, b, c) := g in
  match part a x, part b y, part c z with
  | Some p, Some q, Some r => Some (p + q + r)
  | _, _, _ => None
  end.

(* ---- The surface and its tree ---- *)

Definition corner_of (t : triangle) (v : Z) : Prop := v = corner_a t \/ v = corner_b t \/ v = corner_c t.

(* Vertex v belongs to a triangle of a leaf below BV i, or of BV i itself. *)
Inductive below (bs : list bv) (ts : list triangle) : Z -> Z -> Prop :=
| below_leaf i l t tri v :
    at_index bs i = Some (Leaf l) -> In t l -> at_index ts t = Some tri -> corner_of tri v -> below bs ts i v
| below_left i a b v : at_index bs i = Some (Inner a b) -> below bs ts a v -> below bs ts i v
| below_right i a b v : at_index bs i = Some (Inner a b) -> below bs ts b v -> below bs ts i v.

(* From the root by first (false) and second (true) children to BV i *)
Inductive path (bs : list bv) : list bool -> Z -> Prop :=
| path_root : path bs [] 0
| path_left p i a b : path bs p i -> at_index bs i = Some (Inner a b) -> path bs (p ++ [false]) a
| path_right p i a b : path bs p i -> at_index bs i = Some (Inner a b) -> path bs (p ++ [true]) b.

Definition triangles_below (b : bv) : list Z := match b with Leaf l => l | Inner _ _ => [] end.

Definition count {A : Type} (l : list A) : Z := Z.of_nat (length l).

(* 0, 1, ..., n - 1 *)
Definition indices (n : Z) : list Z := map Z.of_nat (seq 0 (Z.to_nat n)).

Definition sum_of (l : list (Z * dyadic)) : R := fold_right (fun jw s => value (snd jw) + s) 0 l.

Record convex (nodes : Z) (v : vertex) : Prop := {
  nodes_exist : forall j w, In (j, w) (influences v) -> (0 <= j < nodes)%Z;
  nodes_differ : NoDup (map fst (influences v));
  weights_positive : forall j w, In (j, w) (influences v) -> 0 < value w;
  weights_doubles : forall j w, In (j, w) (influences v) -> binary64 w;
  weights_sum : sum_of (influences v) = 1
}.

Definition binary64_point (p : point) : Prop := binary64 (px p) /\ binary64 (py p) /\ binary64 (pz p).
Definition binary64_row (r : row) : Prop := binary64 (ra r) /\ binary64 (rb r) /\ binary64 (rc r) /\ binary64 (rt r).
Definition binary64_map (m : affine) : Prop := binary64_row (row_x m) /\ binary64_row (row_y m) /\
  binary64_row (row_z m).

Record whole_surface (c : content) : Prop := {
  all_vertices : count (vertices c) = vertex_count (head c);
  all_triangles : count (triangles_of c) = triangle_count (head c);
  all_bvs : count (bvs c) = bv_count (head c);
  all_frames : count (frames c) = frame_count (head c);
  some_bv : (0 < bv_count (head c))%Z;
  known_kdop : In (kdop (head c)) [6; 14; 18; 26]%Z;
  positions_doubles : forall v, In v (vertices c) -> binary64_point (rest v);
  weights_convex : forall v, In v (vertices c) -> convex (node_count (head c)) v;
  corners_exist : forall t v, In t (triangles_of c) -> corner_of t v -> (0 <= v < vertex_count (head c))%Z;
  triangles_once : Permutation (flat_map triangles_below (bvs c)) (indices (triangle_count (head c)));
  leaves_hold : forall l, In (Leaf l) (bvs c) -> l <> [];
  bvs_once : forall i, (0 <= i < bv_count (head c))%Z -> exists! p, path (bvs c) p i
}.

(* ---- The bounds ---- *)

Definition exact_along (g : direction) (ms : list affine) (v : vertex) : R :=
  along g (exact_coordinate row_x ms v) (exact_coordinate row_y ms v) (exact_coordinate row_z ms v).
Definition computed_along (g : direction) (ms : list affine) (v : vertex) : option R :=
  along_computed g (computed_coordinate row_x ms v) (computed_coordinate row_y ms v) (computed_coordinate row_z ms v).

Definition encloses (g : direction) (ms : list affine) (v : vertex) (bound : R) : Prop :=
  exact_along g ms v <= bound /\ exists s, computed_along g ms v = Some s /\ s <= bound.

(* Bound d of BV i *)
Definition states (f : frame) (i : Z) (d : nat) (bound : dyadic) : Prop :=
  exists cl, at_index (claims f) i = Some cl /\ nth_error (bounds cl) d = Some (Some bound).

Definition vertices_enclosed (c : content) : Prop :=
  forall f i d g bound k v, In f (frames c) -> states f i d bound -> nth_error (directions (kdop (head c))) d = Some
    g ->
    below (bvs c) (triangles_of c) i k -> at_index (vertices c) k = Some v -> encloses g (maps f) v (value bound).

(* Of a BV: a rest box, and per simulation node the least and the greatest weight *)
Record box := Box { low : point; high : point }.
Definition interval := (Z * (dyadic * dyadic))%type.

Definition within (a b : dyadic) (x : R) : Prop := value a <= x <= value b.
Definition in_box (b : box) (x y z : R) : Prop :=
  within (px (low b)) (px (high b)) x /\ within (py (low b)) (py (high b)) y /\ within (pz (low b)) (pz (high b)) z.

Definition weight_of (v : vertex) (j : Z) : R :=
  match find (fun jw => Z.eqb (fst jw) j) (influences v) with Some (_, w) => value w | None => 0 end.

Definition weights_within (l : list interval) (v : vertex) : Prop :=
  (forall j a b, In (j, (a, b)) l -> within a b (weight_of v j)) /\
  (forall j, ~ In j (map fst l) -> weight_of v j = 0).

(* Any convex weights of the intervals, and per simulation node any point of the box *)
Definition blend (g : direction) (ms : list affine) (w : Z -> R) (x : Z -> R * R * R) (l : list interval) : R :=
  fold_right (fun e s => let j := fst e in let '(a, b, c) := x j in
    w j * along g (image (row_of row_x ms j) a b c) (image (row_of row_y ms j) a b c) (image (row_of row_z ms j) a b
      c)
    + s) 0 l.

Definition blends_enclosed (g : direction) (ms : list affine) (b : box) (l : list interval) (bound : R) : Prop :=
  forall w x, (forall j lo hi, In (j, (lo, hi)) l -> 0 <= w j /\ within lo hi (w j)) ->
    fold_right (fun e s => w (fst e) + s) 0 l = 1 ->
    (forall j, let '(p, q, r) := x j in in_box b p q r) ->
    blend g ms w x l <= bound.

(* Weak duality: the bounds hold for whatever the box and the weight intervals allow. *)
Definition spaces_enclosed (c : content) : Prop :=
  by_duality (head c) = true ->
  forall i, (0 <= i < bv_count (head c))%Z -> exists b l,
    NoDup (map fst l) /\
    (forall k v, below (bvs c) (triangles_of c) i k -> at_index (vertices c) k = Some v ->
       in_box b (value (px (rest v))) (value (py (rest v))) (value (pz (rest v))) /\ weights_within l v) /\
    (forall f d g bound, In f (frames c) -> states f i d bound ->
       nth_error (directions (kdop (head c))) d = Some g -> blends_enclosed g (maps f) b l (value bound)).

(* ---- Frames and the end ---- *)

Definition all_bounds (c : content) : list (option dyadic) := flat_map (fun f => flat_map bounds (claims f)) (frames
  c).

Record whole_frame (c : content) (f : frame) : Prop := {
  all_maps : count (maps f) = node_count (head c);
  all_claims : count (claims f) = bv_count (head c);
  all_directions : forall cl, In cl (claims f) -> length (bounds cl) = length (directions (kdop (head c)));
  maps_doubles : forall m, In m (maps f) -> binary64_map m;
  bounds_doubles : forall cl b, In cl (claims f) -> In (Some b) (bounds cl) -> binary64 b
}.

Record counts_right (c : content) : Prop := {
  frames_right : frames_said (last_line c) = count (frames c);
  proven_right : proven_said (last_line c) = count (filter finite_bound (all_bounds c));
  infinite_right : infinite_said (last_line c) = count (filter (fun b => negb (finite_bound b)) (all_bounds c));
  none_violated : violated_said (last_line c) = 0%Z
}.

Record proves (c : content) : Prop := {
  surface_is_whole : whole_surface c;
  frames_are_whole : forall f, In f (frames c) -> whole_frame c f;
  vertices_are_enclosed : vertices_enclosed c;
  spaces_are_enclosed : spaces_enclosed c;
  counts_are_right : counts_right c
}.
