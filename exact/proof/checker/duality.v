(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* Weak duality over a BV's rest box and weight intervals: bound >= D(lambda). *)
From Coq Require Import ZArith List Bool FMapPositive.
From CinchChecker Require Import content table numbers evaluation.
Import ListNotations.
Open Scope Z_scope.

(* The least box, in units of rest positions, and weight intervals, in units of 2 ^ -53, that hold some vertices *)
Record space := Space {
  x0 : Z; x1 : Z; y0 : Z; y1 : Z; z0 : Z; z1 : Z;
  weights : table (Z * Z) (* a simulation node that misses has weight 0 *)
}.

Definition space_of (v : unit_vertex) : space :=
  Space (ux v) (ux v) (uy v) (uy v) (uz v) (uz v)
    (fold_right (fun ju t => put (fst ju) (snd ju, snd ju) t) empty (unit_weights v)).

Definition join_interval (a b : option (Z * Z)) : option (Z * Z) :=
  match a, b with
  | Some (l, h), Some (m, g) => Some (Z.min l m, Z.max h g)
  | Some (l, h), None => Some (Z.min l 0, Z.max h 0)
  | None, Some (l, h) => Some (Z.min l 0, Z.max h 0)
  | None, None => None
  end.

Definition join_space (a b : space) : space :=
  Space (Z.min (x0 a) (x0 b)) (Z.max (x1 a) (x1 b)) (Z.min (y0 a) (y0 b)) (Z.max (y1 a) (y1 b))
    (Z.min (z0 a) (z0 b)) (Z.max (z1 a) (z1 b)) (PositiveMap.map2 join_interval (weights a) (weights b)).

(* With the intervals as a list *)
Record listed_space := ListedSpace {
  sum_x : Z; extent_x : Z; sum_y : Z; extent_y : Z; sum_z : Z; extent_z : Z;
  intervals : list (Z * (Z * Z))
}.

Definition interval_list (t : table (Z * Z)) : list (Z * (Z * Z)) :=
  map (fun e => (Zpos (fst e) - 1, snd e)) (PositiveMap.elements t).

Definition listed (s : space) : listed_space :=
  ListedSpace (x0 s + x1 s) (x1 s - x0 s) (y0 s + y1 s) (y1 s - y0 s) (z0 s + z1 s) (z1 s - z0 s)
    (interval_list (weights s)).

(* A direction moved back by a map, in units of 2 ^ -map_bits, and twice its translation *)
Record column := Column { ga : Z; gb : Z; gc : Z; twice_t : Z }.

Definition column_of (g : direction) (m : unit_map) : column :=
  Column (unit_along g (ua (unit_x m)) (ua (unit_y m)) (ua (unit_z m)))
    (unit_along g (ub (unit_x m)) (ub (unit_y m)) (ub (unit_z m)))
    (unit_along g (uc (unit_x m)) (uc (unit_y m)) (uc (unit_z m)))
    (2 * unit_along g (ut (unit_x m)) (ut (unit_y m)) (ut (unit_z m))).

(* The box moved by a map, in units of 2 ^ -(map_bits + rest_bits + 1): middle and radius along the direction *)
Definition middle (s : listed_space) (c : column) : Z :=
  ga c * sum_x s + gb c * sum_y s + gc c * sum_z s + twice_t c.
Definition radius (s : listed_space) (c : column) : Z :=
  Z.abs (ga c) * extent_x s + Z.abs (gb c) * extent_y s + Z.abs (gc c) * extent_z s.

(* Of one simulation node: extrema along the direction and against it, and its weight interval *)
Record term := Term { along_it : Z; against_it : Z; least : Z; most : Z }.

(* None where a map misses *)
Fixpoint terms (s : listed_space) (t : table column) (l : list (Z * (Z * Z))) : option (list term) :=
  match l with
  | [] => Some []
  | (j, (lo, hi)) :: r =>
    match get t j, terms s t r with
    | Some c, Some es => let p := middle s c in let e := radius s c in Some (Term (e + p) (e - p) lo hi :: es)
    | _, _ => None
    end
  end.

(* lambda = fst / (snd * 2 ^ -k) *)
Definition multiplier_in_units (k : Z) (m : multiplier) : Z * Z :=
  match m with
  | Double d =>
    if 0 <=? exn d + k then (Z.shiftl (man d) (exn d + k), 1) else (Z.shiftl (man d) k, Z.shiftl 1 (- exn d))
  | Ratio p q => (Z.shiftl p k, q)
  end.

Definition is_multiplier (m : multiplier) : bool :=
  match m with Double d => is_double d | Ratio _ q => 0 <? q end.

Definition times (q n : Z) : Z := if q =? 1 then n else q * n.

(* sum_j c_j (q b_j - p), c_j the interval's end that makes it greatest *)
Definition dual_sum (b : term -> Z) (p q : Z) : list term -> Z -> Z :=
  fold_left (fun sum e => let x := times q (b e) - p in sum + (if 0 <? x then most e else least e) * x).

(* k = map_bits + rest_bits *)
Definition above_dual (k : Z) (b : term -> Z) (es : list term) (bound : option dyadic) (lambda : multiplier) : bool :=
  is_multiplier lambda &&
  match bound with
  | None => true
  | Some d =>
    let '(p, q) := multiplier_in_units (k + 1) lambda in
    at_least (Dyadic (man d * q) (exn d)) (k + 1 + weight_bits) (dual_sum b p q es (Z.shiftl p weight_bits))
  end.

(* A table per axis; bounds and lambdas along it and against it *)
Fixpoint above_duals (k : Z) (s : listed_space) (ts : list (table column)) (bs : list (option dyadic))
    (ls : list multiplier) : bool :=
  match ts, bs, ls with
  | [], [], [] => true
  | t :: ts', b :: c :: bs', l :: m :: ls' =>
    match terms s t (intervals s) with
    | Some es => above_dual k along_it es b l && above_dual k against_it es c m && above_duals k s ts' bs' ls'
    | None => false
    end
  | _, _, _ => false
  end.
