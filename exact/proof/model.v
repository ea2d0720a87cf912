(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* Functions of toolkit/ as they compute, operation by operation, over any arithmetic. The theorems are about
   these very definitions; extracted, they are compared with the compiled functions bit by bit (tie/). *)
From Coq Require Import ZArith List Bool.
Import ListNotations.
Open Scope Z_scope.

(* What a function needs of an arithmetic. *)
Record ops (num : Type) := Ops {
  precision : Z;
  least : Z;                     (* the exponent of the least positive number *)
  constant : Z -> Z -> num;      (* m 2^e *)
  infinity : num;
  add : num -> num -> num;
  sub : num -> num -> num;
  mul : num -> num -> num;
  absolute : num -> num;
  less : num -> num -> bool;
  less_equal : num -> num -> bool;
  divide : num -> num -> num
}.
Arguments precision {num}. Arguments least {num}. Arguments constant {num}. Arguments infinity {num}.
Arguments add {num}. Arguments sub {num}. Arguments mul {num}. Arguments absolute {num}.
Arguments less {num}. Arguments less_equal {num}. Arguments divide {num}.

Section Model.
Context {num : Type}.
Variable o : ops num.

Definition zero : num := constant o 0 0.
(* std::max and std::min: the first where they are equal or not comparable. *)
Definition max (a b : num) : num := if less o a b then b else a.
Definition min (a b : num) : num := if less o b a then b else a.

(* rounding.hpp. *)
Definition smallest_times (n : Z) : num := constant o n (least o).
Definition phi : num := constant o (2 ^ (precision o - 1) + 1) (1 - 2 * precision o).
Definition succ (x : num) : num := add o x (add o (mul o phi (absolute o x)) (smallest_times 1)).

Definition unit_roundoff : num := constant o 1 (- precision o).
Definition extremum_error (largest : num) : num :=
  succ (add o (mul o (mul o (constant o 10 0) unit_roundoff) largest)
              (mul o (constant o 16 0) (smallest_times 1))).
Definition evaluation_error (influences : Z) (largest : num) : num :=
  succ (add o (mul o (mul o (add o (constant o influences 0) (constant o 8 0)) unit_roundoff) largest)
              (smallest_times (8 * influences))).
Definition sum_error (nodes : Z) (absolute_sum : num) : num :=
  succ (add o (mul o (mul o (add o (constant o nodes 0) (constant o 4 0)) unit_roundoff) absolute_sum)
              (smallest_times nodes)).

(* weight_space.cpp. A simulation node is its l, h and b. *)
Record entry := Entry { entry_l : num; entry_h : num; entry_b : num }.
Definition dual_product (lambda : num) (n : entry) : num :=
  let above := sub o (entry_b n) lambda in
  mul o (if less_equal o zero above then entry_h n else entry_l n) above.
Definition dual_step (lambda : num) (state : num * num) (n : entry) : num * num :=
  let product := dual_product lambda n in
  (add o (fst state) product, add o (snd state) (absolute o product)).
Definition dual_sums (lambda : num) (nodes : list entry) : num * num :=
  fold_left (dual_step lambda) nodes (zero, zero).
Definition length_of {A} (s : list A) : Z := Z.of_nat (length s).
Definition dual_value (lambda : num) (nodes : list entry) : num :=
  let (sum, absolutes) := dual_sums lambda nodes in
  succ (add o lambda (succ (add o sum (sum_error (length_of nodes) absolutes)))).
Definition dual_bound (lambda : num) (nodes : list entry) : num :=
  if negb (less o (snd (dual_sums lambda nodes)) (infinity o)) || negb (less o (absolute o lambda) (infinity o))
  then infinity o
  else let bound := dual_value lambda nodes in if less o bound (infinity o) then bound else infinity o.

Definition second_step (state : num * num) (b : num) : num * num :=
  let (first, second) := state in
  if less o first b then (b, first) else if less o second b then (first, b) else (first, second).
Definition lowest : num := sub o zero (infinity o).
(* Of b and further extrema. *)
Definition second_largest (b : num) (others : list num) : num :=
  snd (fold_left second_step others (b, match others with [] => b | _ => lowest end)).
(* std::max_element. *)
Definition greatest (b : num) (others : list num) : num := fold_left max others b.

(* bound_box.cpp, best_corner(): of each entry with the others, in order. *)
Fixpoint picks {A} (before after : list A) : list (A * list A) :=
  match after with [] => [] | a :: r => (a, before ++ r) :: picks (before ++ [a]) r end.
Definition corner_value (base slack : num) (i j : entry) : num :=
  let range := sub o (entry_h i) (entry_l i) in
  add o (add o base (mul o range (entry_b i))) (mul o (sub o slack range) (entry_b j)).
Definition corner_base (nodes : list entry) : num :=
  fold_left (fun s n => add o s (mul o (entry_l n) (entry_b n))) nodes zero.
Definition corner_slack (nodes : list entry) : num := fold_left (fun s n => sub o s (entry_l n)) nodes (constant o 1 0).
Definition corner_magnitude (nodes : list entry) : num :=
  fold_left (fun s n => max s (absolute o (entry_b n))) nodes zero.
Definition best_of_corners (nodes : list entry) : num :=
  let base := corner_base nodes in let slack := corner_slack nodes in
  fold_left (fun best p => fold_left (fun best j => max best (corner_value base slack (fst p) j)) (snd p) best)
            (picks [] nodes) lowest.
Definition corner_error (nodes : list entry) : num :=
  let n := constant o (length_of nodes) 0 in
  succ (add o (mul o (mul o (mul o (constant o 4 0) (add o n (constant o 8 0))) unit_roundoff) (corner_magnitude nodes))
              (mul o (mul o (constant o 2 0) n) (smallest_times 1))).
(* 2^1020 in double: a sixteenth of the power of two above every finite number. *)
Definition most_safe : num := constant o 1 (- least o - precision o - 1).
Definition corner_bound (nodes : list entry) : num := succ (add o (best_of_corners nodes) (corner_error nodes)).
Definition best_corner (nodes : list entry) : num :=
  match nodes with
  | [n] => entry_b n
  | _ => if less o (corner_magnitude nodes) most_safe then corner_bound nodes else infinity o
  end.

(* greatest_mean.hpp: b of an entry is its c, at least 0. *)
Definition mean_step (state : num * num) (n : entry) : num * num :=
  let (most, second) := state in (max most (entry_b n), max second (min (entry_b n) most)).
Definition mean_term (second : num) (n : entry) : num :=
  let above := sub o (entry_b n) second in
  add o (mul o (entry_l n) above) (mul o (sub o (entry_h n) (entry_l n)) (max above zero)).
Definition mean_sum (second : num) (nodes : list entry) : num :=
  fold_left (fun s n => add o s (mean_term second n)) nodes second.
Definition mean_error (nodes : Z) (most : num) : num :=
  add o (mul o (mul o (add o (constant o nodes 0) (constant o 8 0)) (constant o 1 (2 - precision o))) most)
        (smallest_times (2 * nodes)).
Definition greatest_mean (nodes : list entry) : num :=
  let (most, second) := fold_left mean_step nodes (zero, zero) in
  if negb (less o most (infinity o)) || (less_equal o most second && less_equal o second most) then most
  else min most (add o (mean_sum second nodes) (mean_error (length_of nodes) most)).

(* time/interval_refit.cpp, greatest_between(). To halve and to divide by 16 is to multiply. *)
Definition infinite_unless (x : num) : num := if less o x (infinity o) then x else infinity o.
Definition is_number (x : num) : bool := less_equal o x x.
Definition number_or_infinity (x : num) : num := if is_number x then x else infinity o.
Definition half_of (x : num) : num := mul o x (constant o 1 (-1)).
Definition between_error (first last rise : num) (underflows : Z) : num :=
  add o (mul o (constant o 1 (4 - precision o)) (add o (add o (absolute o first) (absolute o last)) rise))
        (smallest_times underflows).
Definition parabola_value (first last bump : num) : num :=
  let d := sub o (max first last) (min first last) in
  add o (add o (half_of (add o first last)) bump) (mul o d (mul o (divide o d bump) (constant o 1 (-4)))).
Definition parabola_top (first last bump : num) : num :=
  let top := max (max first last) (add o (parabola_value first last bump) (between_error first last bump 4)) in
  if less o bump most_safe then infinite_unless top else infinity o.
Definition lipschitz_top (first last path : num) : num :=
  let way := min (half_of (add o (add o first last) path)) (add o (min first last) path) in
  infinite_unless (add o way (between_error first last path 1)).
Definition greatest_between (first last bump path : num) : num :=
  let bump := number_or_infinity bump in let path := number_or_infinity path in
  let most := max first last in let least := min first last in
  if less o most most_safe && less o (sub o zero most_safe) least && is_number first && is_number last then
    if less_equal o bump zero || less_equal o (mul o (constant o 4 0) bump) (sub o most least) then succ most
    else succ (min (parabola_top first last bump) (max most (lipschitz_top first last path)))
  else infinity o.

(* deform: an affine map by rows, a box by centre and half extents, an axis of components -1, 0 and 1. *)
Record triple (A : Type) := Triple { at0 : A; at1 : A; at2 : A }.
Record row := Row { column : triple num; offset : num }.
Record box := Box { centre : triple num; half : triple num }.
Definition map_rows := triple row.

Definition is_finite_map (m : map_rows) : bool :=
  let finite x := less o (absolute o x) (infinity o) in
  let finite_row r := finite (at0 _ (column r)) && finite (at1 _ (column r)) && finite (at2 _ (column r)) &&
                      finite (offset r) in
  finite_row (at0 _ m) && finite_row (at1 _ m) && finite_row (at2 _ m).

(* bound_box.cpp, extrema(). *)
Definition project_step (axis : Z) (x sum : num) : num :=
  if axis =? 0 then sum else add o sum (mul o (constant o axis 0) x).
Definition project (axis : triple Z) (x : triple num) : num :=
  project_step (at2 _ axis) (at2 _ x) (project_step (at1 _ axis) (at1 _ x) (project_step (at0 _ axis) (at0 _ x) zero)).
Definition magnitude_step (axis : Z) (x sum : num) : num := if axis =? 0 then sum else add o sum (absolute o x).
Definition project_magnitude (axis : triple Z) (x : triple num) : num :=
  magnitude_step (at2 _ axis) (at2 _ x)
    (magnitude_step (at1 _ axis) (at1 _ x) (magnitude_step (at0 _ axis) (at0 _ x) zero)).

Definition per_row (f : row -> num) (m : map_rows) : triple num := Triple _ (f (at0 _ m)) (f (at1 _ m)) (f (at2 _ m)).
Definition column0 (m : map_rows) := per_row (fun r => at0 _ (column r)) m.
Definition column1 (m : map_rows) := per_row (fun r => at1 _ (column r)) m.
Definition column2 (m : map_rows) := per_row (fun r => at2 _ (column r)) m.
Definition column3 (m : map_rows) := per_row offset m.
Definition columns (f : triple num -> num) (m : map_rows) : triple num :=
  Triple _ (f (column0 m)) (f (column1 m)) (f (column2 m)).

Definition dot3 (g x : triple num) : num :=
  add o (add o (mul o (at0 _ g) (at0 _ x)) (mul o (at1 _ g) (at1 _ x))) (mul o (at2 _ g) (at2 _ x)).
Definition each (f : num -> num) (x : triple num) : triple num := Triple _ (f (at0 _ x)) (f (at1 _ x)) (f (at2 _ x)).
Definition outermost (b : box) : triple num :=
  let at_most c e := add o (absolute o c) e in
  Triple _ (at_most (at0 _ (centre b)) (at0 _ (half b))) (at_most (at1 _ (centre b)) (at1 _ (half b)))
           (at_most (at2 _ (centre b)) (at2 _ (half b))).
Definition extremum_middle (axis : triple Z) (b : box) (m : map_rows) : num :=
  add o (dot3 (columns (project axis) m) (centre b)) (project axis (column3 m)).
Definition extremum_radius (axis : triple Z) (b : box) (m : map_rows) : num :=
  dot3 (each (absolute o) (columns (project axis) m)) (half b).
Definition extremum_magnitude (axis : triple Z) (b : box) (m : map_rows) : num :=
  add o (dot3 (columns (project_magnitude axis) m) (outermost b)) (project_magnitude axis (column3 m)).
(* The greatest along the axis, or against it. *)
Definition extremum_of (along : bool) (axis : triple Z) (b : box) (m : map_rows) : num :=
  (if along then add o else sub o) (extremum_radius axis b m) (extremum_middle axis b m).
Definition largest_magnitude (axis : triple Z) (b : box) (maps : list map_rows) : num :=
  let all := map (extremum_magnitude axis b) maps in
  if forallb (fun x => less o x (infinity o)) all then fold_left max all zero else infinity o.

(* bound_box.cpp: one axis and side. `lambda` is what best_lambda chooses, if anything. *)
Record influence := Influence { influence_l : num; influence_h : num; influence_map : map_rows }.
Inductive method := convex | eq12 | limited (lambda : num) | corners.
Definition entries (nodes : list influence) (b : list num) : list entry :=
  map (fun p => Entry (influence_l (fst p)) (influence_h (fst p)) (snd p)) (combine nodes b).
Definition box_free_bound (how : method) (nodes : list influence) (b : list num) : num :=
  match b with
  | [] => zero
  | b0 :: others =>
    let most := greatest b0 others in
    let second := min most (dual_bound (second_largest b0 others) (entries nodes b)) in
    match how with
    | convex => most
    | corners => best_corner (entries nodes b)
    | eq12 => second
    | limited lambda => min second (dual_bound lambda (entries nodes b))
    end
  end.
Definition bound_box (how : method) (along : bool) (axis : triple Z) (b : box) (influences : Z)
                     (nodes : list influence) : num :=
  if forallb (fun n => is_finite_map (influence_map n)) nodes then
    let magnitude := largest_magnitude axis b (map influence_map nodes) in
    let error := succ (add o (extremum_error magnitude) (evaluation_error influences magnitude)) in
    if less o magnitude (infinity o) then
      let bound := box_free_bound how nodes (map (fun n => extremum_of along axis b (influence_map n)) nodes) in
      let widened := succ (add o bound error) in
      if less o widened (infinity o) then widened else infinity o
    else infinity o
  else infinity o.

(* evaluate_vertex (deform/evaluate.cpp), one coordinate: weights and rows of its simulation nodes. *)
Definition evaluate_row (x : triple num) (r : row) : num :=
  add o (dot3 (column r) x) (offset r).
Definition evaluate_coordinate (x : triple num) (nodes : list (num * row)) : num :=
  fold_left (fun sum n => add o sum (mul o (fst n) (evaluate_row x (snd n)))) nodes zero.
Definition evaluate_vertex (x : triple num) (nodes : list (num * map_rows)) : triple num :=
  let coordinate (f : map_rows -> row) := evaluate_coordinate x (map (fun n => (fst n, f (snd n))) nodes) in
  Triple _ (coordinate (at0 _)) (coordinate (at1 _)) (coordinate (at2 _)).

(* bound_vertex (bounds/bound_vertex.cpp), one axis and side. *)
Definition magnitude_row (x : triple num) (r : row) : num :=
  let c := column r in
  add o (add o (add o (absolute o (mul o (at0 _ c) (at0 _ x))) (absolute o (mul o (at1 _ c) (at1 _ x))))
               (absolute o (mul o (at2 _ c) (at2 _ x)))) (absolute o (offset r)).
Definition coordinate_magnitude (x : triple num) (nodes : list (num * row)) : num :=
  fold_left (fun sum n => add o sum (mul o (fst n) (magnitude_row x (snd n)))) nodes zero.
Definition upper_step (sign : Z) (coordinate error sum : num) : num :=
  if sign =? 0 then sum
  else let upper := succ (add o (mul o (constant o sign 0) coordinate) error) in
       if less_equal o sum zero && less_equal o zero sum then upper else succ (add o sum upper).
Definition bound_vertex (along : bool) (axis : triple Z) (x : triple num) (nodes : list (num * map_rows)) : num :=
  let rows (f : map_rows -> row) := map (fun n => (fst n, f (snd n))) nodes in
  let error f := evaluation_error (length_of nodes) (coordinate_magnitude x (rows f)) in
  let finite f := less o (coordinate_magnitude x (rows f)) (infinity o) && less o (error f) (infinity o) in
  let sign a := if along then a else - a in
  let step a f := upper_step (sign a) (evaluate_coordinate x (rows f)) (error f) in
  let sum := step (at2 _ axis) (at2 _) (step (at1 _ axis) (at1 _) (step (at0 _ axis) (at0 _) zero)) in
  if finite (at0 _) && finite (at1 _) && finite (at2 _) && less o sum (infinity o) then sum else infinity o.

(* collide/orientation.cpp: determinants of computed differences, and their filters. *)
Definition difference (a b : triple num) : triple num :=
  Triple _ (sub o (at0 _ b) (at0 _ a)) (sub o (at1 _ b) (at1 _ a)) (sub o (at2 _ b) (at2 _ a)).
Definition minor (a b c d : num) : num := sub o (mul o a b) (mul o c d).
Definition determinant3 (p q r : triple num) : num :=
  add o (sub o (mul o (at0 _ p) (minor (at1 _ q) (at2 _ r) (at2 _ q) (at1 _ r)))
               (mul o (at0 _ q) (minor (at1 _ p) (at2 _ r) (at2 _ p) (at1 _ r))))
        (mul o (at0 _ r) (minor (at1 _ p) (at2 _ q) (at2 _ p) (at1 _ q))).
Definition determinant2 (p0 p1 q0 q1 : num) : num := minor p0 q1 p1 q0.
Inductive verdict := Negative | Zero | Positive | Undecided.
(* The greatest computed difference of each coordinate; in double the range is 2^-320 to 2^320. *)
Definition filtered_sign (units range : Z) (computed : num) (greatest : list num) : verdict :=
  let error := fold_left (mul o) greatest (constant o units (- precision o)) in
  if existsb (fun x => less_equal o x zero) greatest then Zero
  else if forallb (fun x => less_equal o (constant o 1 (- range)) x && less_equal o x (constant o 1 range)) greatest
  then if less o error computed then Positive
       else if less o computed (sub o zero error) then Negative else Undecided
  else Undecided.
Definition greatest3 (a b c : num) : num := max (max (absolute o a) (absolute o b)) (absolute o c).
Definition filter3 (range : Z) (a b c d : triple num) : verdict :=
  let p := difference a b in let q := difference a c in let r := difference a d in
  filtered_sign 49 range (determinant3 p q r)
    [greatest3 (at0 _ p) (at0 _ q) (at0 _ r); greatest3 (at1 _ p) (at1 _ q) (at1 _ r);
     greatest3 (at2 _ p) (at2 _ q) (at2 _ r)].
Definition filter2 (range : Z) (a0 a1 b0 b1 c0 c1 : num) : verdict :=
  let p0 := sub o b0 a0 in let p1 := sub o b1 a1 in let q0 := sub o c0 a0 in let q1 := sub o c1 a1 in
  filtered_sign 9 range (determinant2 p0 p1 q0 q1)
    [max (absolute o p0) (absolute o q0); max (absolute o p1) (absolute o q1)].
End Model.

Arguments Entry {num}. Arguments entry_l {num}. Arguments entry_h {num}. Arguments entry_b {num}.
Arguments Triple {A}. Arguments at0 {A}. Arguments at1 {A}. Arguments at2 {A}.
Arguments Row {num}. Arguments column {num}. Arguments offset {num}.
Arguments Box {num}. Arguments centre {num}. Arguments half {num}.
Arguments Influence {num}. Arguments influence_l {num}. Arguments influence_h {num}. Arguments influence_map {num}.
Arguments convex {num}. Arguments eq12 {num}. Arguments limited {num}. Arguments corners {num}.
