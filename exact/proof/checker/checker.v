(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* The checker: line after line of a certificate, from Start to Done. *)
From Coq Require Import ZArith List Bool.
From CinchChecker Require Import content table numbers evaluation tree duality.
Import ListNotations.
Open Scope Z_scope.

Definition most_index : Z := 4294967295. (* 2^32 - 1 *)
Definition is_count (n : Z) : bool := (1 <=? n) && (n <=? most_index).
Definition is_header (h : header) : bool :=
  ((kdop h =? 6) || (kdop h =? 14) || (kdop h =? 18) || (kdop h =? 26)) &&
  is_count (vertex_count h) && is_count (triangle_count h) && is_count (node_count h) && is_count (bv_count h) &&
  is_count (frame_count h).

Definition is_point (p : point) : bool := forallb is_double (coordinates p).

(* Ascending simulation nodes after `last` *)
Fixpoint are_nodes (node_count last : Z) (l : list (Z * dyadic)) : bool :=
  match l with
  | [] => true
  | (j, w) :: r => (last <? j) && (j <? node_count) && is_weight w && are_nodes node_count j r
  end.

Definition is_vertex (h : header) (v : vertex) : bool :=
  is_point (rest v) && are_nodes (node_count h) (-1) (influences v) &&
  (fold_right (fun jw s => units weight_bits (snd jw) + s) 0 (influences v) =? one_weight).

Definition is_corner (h : header) (v : Z) : bool := (0 <=? v) && (v <? vertex_count h).
Definition is_triangle (h : header) (t : triangle) : bool :=
  is_corner h (corner_a t) && is_corner h (corner_b t) && is_corner h (corner_c t).

(* What of the surface all frames share *)
Record surface := Surface {
  about : header;
  sides : list direction;
  rest_bits : Z;
  unit_vertices : list unit_vertex; (* the last one first *)
  tree : list held;                 (* the last one first *)
  spaces : list (option listed_space) (* for weak duality; otherwise as many None *)
}.

(* Of one frame, what its bounds are held against *)
Record aims := Aims {
  bits : Z; (* of images: map_bits + rest_bits *)
  columns : list (table column);
  supports_left : list (option (list (option Z)));
  spaces_left : list (option listed_space)
}.

Inductive state :=
| Start
| Reading (h : header) (nv nt nb : Z) (vs : list vertex) (ts : list triangle) (bs : list bv) (* the last one first *)
| Framing (s : surface) (begun : Z) (claimed : Z) (a : aims) (proven infinite : Z)
| Done.

Inductive reason :=
| WrongOrder | BadHeader | BadVertex | BadTriangle | BadBv | BadTree | BadFrame | BadClaim | BoundBelowVertex
| BoundBelowDual | BadEnd.

Inductive outcome := Next (s : state) | Rejected (r : reason).

(* vs, ts, bs: the last one first *)
Definition finest_rest (vs : list vertex) : Z := fold_left (fun k v => finest k (coordinates (rest v))) vs 0.

Definition spaces_of (own : table unit_vertex) (bv_count : Z) (l : list held) : list (option listed_space) :=
  reversed (reversed_map (option_map listed)
    (climb join_space (fun v => option_map space_of (get own v)) (bv_count - 1) l empty [])).

Definition surface_of (h : header) (vs : list vertex) (ts : list triangle) (bs : list bv) : surface :=
  let k := finest_rest vs in
  let us := reversed_map (vertex_in_units k) (reversed vs) in
  let corner_table := table_of (reversed ts) in
  let hs := reversed_map (held_by corner_table) (reversed bs) in
  Surface h (directions (kdop h)) k us hs
    (if by_duality h then spaces_of (table_of (reversed us)) (bv_count h) hs else []).

Definition is_map (m : affine) : bool := forallb is_double (entries m).
Definition is_frame (h : header) (time : dyadic) (ms : list affine) : bool :=
  is_double time && (size ms =? node_count h) && forallb is_map ms.

Definition finest_map (ms : list affine) : Z := fold_left (fun k m => finest k (entries m)) ms 0.

Definition aims_of (s : surface) (ms : list affine) : aims :=
  let map_bits := finest_map ms in
  let k := map_bits + rest_bits s in
  let us := reversed (reversed_map (map_in_units map_bits (rest_bits s)) ms) in
  let maps_table := table_of us in
  let supports := table_of (reversed_map (supports_of_vertex (sides s) k maps_table) (unit_vertices s)) in
  Aims k
    (if by_duality (about s) then
       map (fun g => table_of (reversed (reversed_map (column_of g) us))) (axes (kdop (about s)))
     else [])
    (climb greater_supports (get supports) (bv_count (about s) - 1) (tree s) empty [])
    (spaces s).

Fixpoint above_supports (k : Z) (bs : list (option dyadic)) (ss : list (option Z)) : bool :=
  match bs, ss with
  | [], [] => true
  | None :: bs', _ :: ss' => above_supports k bs' ss'
  | Some b :: bs', Some s :: ss' => at_least b k s && above_supports k bs' ss'
  | _, _ => false
  end.

Definition is_bound (b : option dyadic) : bool := match b with Some d => is_double d | None => true end.
Definition finite_count (l : list (option dyadic)) : Z := size (filter finite_bound l).

(* Whether lambdas are there just where they have to be, and bounds are doubles, one per direction *)
Definition is_claim (s : surface) (c : claim) : bool :=
  (size (bounds c) =? kdop (about s)) && forallb is_bound (bounds c) &&
  match lambdas c with
  | Some l => by_duality (about s) && forallb is_multiplier l && (size l =? kdop (about s))
  | None => negb (by_duality (about s))
  end.

Definition holds_vertices (a : aims) (c : claim) : bool :=
  match supports_left a with
  | Some l :: _ => above_supports (bits a + weight_bits) (bounds c) l
  | _ => false
  end.

Definition holds_space (a : aims) (c : claim) : bool :=
  match lambdas c, spaces_left a with
  | None, _ => true
  | Some ls, Some sp :: _ => above_duals (bits a) sp (columns a) (bounds c) ls
  | Some _, _ => false
  end.

Definition without_first (a : aims) : aims :=
  Aims (bits a) (columns a) (tl (supports_left a)) (tl (spaces_left a)).

Definition step (now : state) (l : line) : outcome :=
  match now, l with
  | Start, LHeader h => if is_header h then Next (Reading h 0 0 0 [] [] []) else Rejected BadHeader
  | Reading h nv nt nb vs ts bs, LVertex i v =>
    if (i =? nv) && (nv <? vertex_count h) && (nt =? 0) && (nb =? 0) then
      if is_vertex h v then Next (Reading h (nv + 1) nt nb (v :: vs) ts bs) else Rejected BadVertex
    else Rejected WrongOrder
  | Reading h nv nt nb vs ts bs, LTriangle i t =>
    if (i =? nt) && (nt <? triangle_count h) && (nv =? vertex_count h) && (nb =? 0) then
      if is_triangle h t then Next (Reading h nv (nt + 1) nb vs (t :: ts) bs) else Rejected BadTriangle
    else Rejected WrongOrder
  | Reading h nv nt nb vs ts bs, LBv i b =>
    if (i =? nb) && (nb <? bv_count h) && (nt =? triangle_count h) then
      if is_bv (bv_count h) i b then Next (Reading h nv nt (nb + 1) vs ts (b :: bs)) else Rejected BadBv
    else Rejected WrongOrder
  | Reading h nv nt nb vs ts bs, LFrame i time ms =>
    if (i =? 0) && (nv =? vertex_count h) && (nt =? triangle_count h) && (nb =? bv_count h) then
      if is_tree (bv_count h) (triangle_count h) bs then
        if is_frame h time ms then
          let s := surface_of h vs ts bs in Next (Framing s 1 0 (aims_of s ms) 0 0)
        else Rejected BadFrame
      else Rejected BadTree
    else Rejected WrongOrder
  | Framing s begun claimed a proven infinite, LFrame i time ms =>
    if (i =? begun) && (begun <? frame_count (about s)) && (claimed =? bv_count (about s)) then
      if is_frame (about s) time ms then Next (Framing s (begun + 1) 0 (aims_of s ms) proven infinite)
      else Rejected BadFrame
    else Rejected WrongOrder
  | Framing s begun claimed a proven infinite, LClaim f i c =>
    if (f =? begun - 1) && (i =? claimed) && (claimed <? bv_count (about s)) then
      if is_claim s c then
        if holds_vertices a c then
          if holds_space a c then
            let n := finite_count (bounds c) in
            Next (Framing s begun (claimed + 1) (without_first a) (proven + n) (infinite + (kdop (about s) - n)))
          else Rejected BoundBelowDual
        else Rejected BoundBelowVertex
      else Rejected BadClaim
    else Rejected WrongOrder
  | Framing s begun claimed a proven infinite, LEnd e =>
    if (begun =? frame_count (about s)) && (claimed =? bv_count (about s)) then
      if (frames_said e =? begun) && (proven_said e =? proven) && (infinite_said e =? infinite) &&
         (violated_said e =? 0)
      then Next Done else Rejected BadEnd
    else Rejected WrongOrder
  | _, _ => Rejected WrongOrder
  end.

Fixpoint run (now : state) (ls : list line) : outcome :=
  match ls with
  | [] => Next now
  | l :: r => match step now l with Next s => run s r | Rejected why => Rejected why end
  end.

Definition accepts (ls : list line) : bool := match run Start ls with Next Done => true | _ => false end.
