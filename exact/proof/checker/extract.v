(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* Extraction to OCaml. Whole numbers become zarith's by whole.ml; nothing else is mapped but booleans, options, lists
   and pairs. *)
From Coq Require Import ZArith List Extraction ExtrOcamlBasic.
From CinchChecker Require Import content checker.

Extract Inductive positive => "Whole.t" ["Whole.x_i" "Whole.x_o" "Whole.one"] "Whole.match_positive".
Extract Inductive Z => "Whole.t" ["Whole.zero" "" "Whole.opp"] "Whole.match_z".
Extract Constant Z.opp => "Whole.opp".
Extract Constant Z.add => "Whole.add".
Extract Constant Z.sub => "Whole.sub".
Extract Constant Z.mul => "Whole.mul".
Extract Constant Z.abs => "Whole.abs".
Extract Constant Z.min => "Whole.min".
Extract Constant Z.max => "Whole.max".
Extract Constant Z.eqb => "Whole.eqb".
Extract Constant Z.ltb => "Whole.ltb".
Extract Constant Z.leb => "Whole.leb".
Extract Constant Z.even => "Whole.even".
Extract Constant Z.log2 => "Whole.log2".
Extract Constant Z.shiftl => "Whole.shiftl".
Extract Constant Z.shiftr => "Whole.shiftr".
Extract Constant Z.to_pos => "Whole.to_pos".
Extract Constant Z.compare =>
  "(fun x y -> let c = Whole.compare x y in if c = 0 then Eq else if c < 0 then Lt else Gt)".

Extraction Blacklist Z List Whole String.
Extraction "checker.ml" checker.step.
