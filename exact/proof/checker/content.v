(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* What a certificate of frames holds (exact/certificate.hpp), as records in the order of its lines. *)
From Coq Require Import ZArith List.
Import ListNotations.
Open Scope Z_scope.

(* man * 2 ^ exn *)
Record dyadic := Dyadic { man : Z; exn : Z }.

Inductive method := Convex | Sphere | Corners | Eq12 | Limited | Local | Support | Linear | Moments | Best | Vertices.

Record header := Header {
  methods : list method;
  oriented : bool; (* rest boxes are oriented boxes *)
  kdop : Z;
  vertex_count : Z;
  triangle_count : Z;
  node_count : Z; (* simulation nodes *)
  bv_count : Z;
  frame_count : Z
}.

Record point := Point { px : dyadic; py : dyadic; pz : dyadic }.

(* Simulation nodes and weights *)
Record vertex := Vertex { rest : point; influences : list (Z * dyadic) }.

Record triangle := Triangle { corner_a : Z; corner_b : Z; corner_c : Z }.

Inductive bv := Leaf (triangles : list Z) | Inner (left right : Z).

(* x -> a * px + b * py + c * pz + t, one coordinate of an affine map *)
Record row := Row { ra : dyadic; rb : dyadic; rc : dyadic; rt : dyadic }.
Record affine := Affine { row_x : row; row_y : row; row_z : row }.

Inductive multiplier := Double (d : dyadic) | Ratio (p q : Z).

(* Of one BV in one frame, per direction; None is infinity *)
Record claim := Claim { bounds : list (option dyadic); lambdas : option (list multiplier) }.

Record ending := Ending { frames_said : Z; proven_said : Z; infinite_said : Z; violated_said : Z }.

(* One line each; indices as they are written *)
Inductive line :=
| LHeader (h : header)
| LVertex (i : Z) (v : vertex)
| LTriangle (i : Z) (t : triangle)
| LBv (i : Z) (b : bv)
| LFrame (i : Z) (time : dyadic) (maps : list affine)
| LClaim (frame i : Z) (c : claim)
| LEnd (e : ending).

(* ---- The whole file ---- *)

Record frame := Frame { time : dyadic; maps : list affine; claims : list claim }.

Record content := Content {
  head : header;
  vertices : list vertex;
  triangles_of : list triangle;
  bvs : list bv;
  frames : list frame;
  last_line : ending
}.

Fixpoint numbered {A : Type} (f : Z -> A -> line) (i : Z) (l : list A) : list line :=
  match l with
  | [] => []
  | x :: r => f i x :: numbered f (i + 1) r
  end.

Definition lines_of_frame (i : Z) (f : frame) : list line :=
  LFrame i (time f) (maps f) :: numbered (LClaim i) 0 (claims f).

Fixpoint lines_of_frames (i : Z) (l : list frame) : list line :=
  match l with
  | [] => []
  | f :: r => lines_of_frame i f ++ lines_of_frames (i + 1) r
  end.

Definition lines (c : content) : list line :=
  LHeader (head c) :: numbered LVertex 0 (vertices c) ++ numbered LTriangle 0 (triangles_of c) ++
  numbered LBv 0 (bvs c) ++ lines_of_frames 0 (frames c) ++ [LEnd (last_line c)].

(* The element of a list with an index as it stands in the file *)
Definition at_index {A : Type} (l : list A) (i : Z) : option A :=
  if i <? 0 then None else nth_error l (Z.to_nat i).

(* ---- Directions: axes_of (toolkit/bounds), each with its opposite ---- *)

Definition direction := (Z * Z * Z)%type.

Definition faces : list direction := [(1, 0, 0); (0, 1, 0); (0, 0, 1)].
Definition corners : list direction := [(1, 1, 1); (1, 1, -1); (1, -1, 1); (1, -1, -1)].
Definition edges : list direction := [(1, 1, 0); (1, 0, 1); (0, 1, 1); (1, -1, 0); (1, 0, -1); (0, 1, -1)].

Definition axes (k : Z) : list direction :=
  if k =? 6 then faces
  else if k =? 14 then faces ++ corners
  else if k =? 18 then faces ++ edges
  else if k =? 26 then faces ++ corners ++ edges
  else [].

Definition opposite (g : direction) : direction := let '(a, b, c) := g in (- a, - b, - c).
Definition directions (k : Z) : list direction := flat_map (fun g => [g; opposite g]) (axes k).

(* Of bounds: not infinity *)
Definition finite_bound (b : option dyadic) : bool := match b with Some _ => true | None => false end.

(* ---- Which methods are proven by weak duality too (box_methods over axis-aligned rest boxes) ---- *)

Definition box_method (m : method) : bool :=
  match m with Convex | Corners | Eq12 | Limited => true | _ => false end.
Definition by_duality (h : header) : bool := negb (oriented h) && forallb box_method (methods h).
