(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* What Coq's whole numbers are in the extracted checker: zarith's. Trusted; as short as it can be. *)
type t = Z.t

let zero = Z.zero
let one = Z.one
let opp = Z.neg
let add = Z.add
let sub = Z.sub
let mul = Z.mul
let abs = Z.abs
let min = Z.min
let max = Z.max
let eqb (x : t) y = Z.equal x y
let ltb (x : t) y = Z.lt x y
let leb (x : t) y = Z.leq x y
let even = Z.is_even
let compare = Z.compare

(* floor (log2 x), and 0 for what is not positive, as Coq has it *)
let log2 x = if Z.sign x <= 0 then Z.zero else Z.of_int (Z.numbits x - 1)

(* A shift to the other side where the count is negative; to the right it rounds down *)
let shiftl x n =
  let n = Z.to_int n in
  if n >= 0 then Z.shift_left x n else Z.shift_right x (-n)

let shiftr x n =
  let n = Z.to_int n in
  if n >= 0 then Z.shift_right x n else Z.shift_left x (-n)

let to_pos x = if Z.sign x > 0 then x else Z.one

(* Constructors of positive (2 p + 1, 2 p, 1), and matches *)
let x_i p = Z.succ (Z.shift_left p 1)
let x_o p = Z.shift_left p 1

let match_positive odd even one p =
  if Z.equal p Z.one then one ()
  else
    let half = Z.shift_right p 1 in
    if Z.is_odd p then odd half else even half

let match_z zero positive negative x =
  let s = Z.sign x in
  if s = 0 then zero () else if s > 0 then positive x else negative (Z.neg x)
