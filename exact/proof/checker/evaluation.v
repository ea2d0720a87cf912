(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* The supports of a vertex in one frame: how far it reaches along each direction, in real arithmetic and in doubles,
   whichever is farther. *)
From Coq Require Import ZArith List Bool.
From CinchChecker Require Import content table numbers.
Import ListNotations.
Open Scope Z_scope.

(* A vertex in units: of 2 ^ -rest_bits for its position, of 2 ^ -53 for weights *)
Record unit_vertex := UnitVertex { ux : Z; uy : Z; uz : Z; unit_weights : list (Z * Z) }.

(* A map in units of 2 ^ -map_bits, its translation in those of 2 ^ -(map_bits + rest_bits) *)
Record unit_row := UnitRow { ua : Z; ub : Z; uc : Z; ut : Z }.
Record unit_map := UnitMap { unit_x : unit_row; unit_y : unit_row; unit_z : unit_row }.
Definition no_unit_row : unit_row := UnitRow 0 0 0 0.
Definition no_unit_map : unit_map := UnitMap no_unit_row no_unit_row no_unit_row.

Definition coordinates (p : point) : list dyadic := [px p; py p; pz p].
Definition entries_of_row (r : row) : list dyadic := [ra r; rb r; rc r; rt r].
Definition entries (m : affine) : list dyadic :=
  entries_of_row (row_x m) ++ entries_of_row (row_y m) ++ entries_of_row (row_z m).

Definition vertex_in_units (rest_bits : Z) (v : vertex) : unit_vertex :=
  UnitVertex (units rest_bits (px (rest v))) (units rest_bits (py (rest v))) (units rest_bits (pz (rest v)))
    (map (fun jw => (fst jw, units weight_bits (snd jw))) (influences v)).

Definition row_in_units (map_bits rest_bits : Z) (r : row) : unit_row :=
  UnitRow (units map_bits (ra r)) (units map_bits (rb r)) (units map_bits (rc r))
    (units (map_bits + rest_bits) (rt r)).
Definition map_in_units (map_bits rest_bits : Z) (m : affine) : unit_map :=
  let f := row_in_units map_bits rest_bits in UnitMap (f (row_x m)) (f (row_y m)) (f (row_z m)).

Definition resolved (t : table unit_map) (l : list (Z * Z)) : list (unit_map * Z) :=
  map (fun ju => (match get t (fst ju) with Some m => m | None => no_unit_map end, snd ju)) l.

(* k = map_bits + rest_bits: images are in units of 2 ^ -k, sums in those of 2 ^ -(k + 53). *)
Fixpoint unit_sum (pick : unit_map -> unit_row) (v : unit_vertex) (l : list (unit_map * Z)) : Z :=
  match l with
  | [] => 0
  | (m, u) :: others =>
    let r := pick m in u * (ua r * ux v + ub r * uy v + uc r * uz v + ut r) + unit_sum pick v others
  end.

Definition rounded_op (op : Z -> Z -> Z) (k : Z) (a b : option Z) : option Z :=
  match a, b with Some x, Some y => rounded k (op x y) | _, _ => None end.
Definition rounded_add := rounded_op Z.add.

Definition rounded_image (k : Z) (r : unit_row) (v : unit_vertex) : option Z :=
  rounded_add k (rounded_add k (rounded_add k (rounded k (ua r * ux v)) (rounded k (ub r * uy v)))
                             (rounded k (uc r * uz v)))
              (Some (ut r)).

Definition rounded_sum (pick : unit_map -> unit_row) (k : Z) (v : unit_vertex) : list (unit_map * Z) -> option Z ->
    option Z :=
  fold_left (fun s mu => rounded_add (k + weight_bits) s
    (rounded_op Z.mul (k + weight_bits) (Some (snd mu)) (rounded_image k (pick (fst mu)) v))).

Definition unit_along (g : direction) (x y z : Z) : Z := let '(a, b, c) := g in a * x + b * y + c * z.

Definition unit_part (a : Z) (x : option Z) : option Z := if a =? 0 then Some 0 else option_map (Z.mul a) x.
Definition rounded_along (g : direction) (x y z : option Z) : option Z :=
  let '(a, b, c) := g in
  match unit_part a x, unit_part b y, unit_part c z with
  | Some p, Some q, Some r => Some (p + q + r)
  | _, _, _ => None
  end.

(* Per direction, in units of 2 ^ -(k + 53); None where no finite bound holds *)
Definition supports_of_vertex (gs : list direction) (k : Z) (t : table unit_map) (v : unit_vertex) :
    list (option Z) :=
  let l := resolved t (unit_weights v) in
  let x := unit_sum unit_x v l in
  let y := unit_sum unit_y v l in
  let z := unit_sum unit_z v l in
  let p := rounded_sum unit_x k v l (Some 0) in
  let q := rounded_sum unit_y k v l (Some 0) in
  let r := rounded_sum unit_z k v l (Some 0) in
  map (fun g => option_map (Z.max (unit_along g x y z)) (rounded_along g p q r)) gs.

Definition greater (a b : option Z) : option Z :=
  match a, b with Some x, Some y => Some (Z.max x y) | _, _ => None end.

Fixpoint greater_supports (a b : list (option Z)) : list (option Z) :=
  match a, b with
  | x :: r, y :: s => greater x y :: greater_supports r s
  | _, _ => []
  end.
