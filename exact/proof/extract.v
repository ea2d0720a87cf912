(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* The functions that the theorems are about, as OCaml: over any arithmetic, and Flocq's binary64 and binary32. No
   mapping to types of OCaml but those of bool, pairs, lists and natural numbers' own. *)
From Coq Require Import ZArith Extraction ExtrOcamlBasic.
From Flocq Require Import BinarySingleNaN.
From CinchProof Require Import model ieee_instances.

(* By position: names of fields may change on the way. *)
Definition make_ops {num} p e constant infinity add sub mul absolute less less_equal divide : ops num :=
  Ops num p e constant infinity add sub mul absolute less less_equal divide.

Definition succ_of {num} (o : ops num) (x : num) : num := model.succ o x.

Extraction Language OCaml.
Extraction "extracted.ml" make_ops succ_of model.sum_error model.extremum_error model.evaluation_error
  model.smallest_times model.dual_sums model.dual_bound model.second_largest model.extremum_of
  model.extremum_magnitude model.best_corner model.greatest_mean model.greatest_between model.bound_box
  model.evaluate_vertex model.bound_vertex model.filter3 model.filter2 binary64_ops binary32_ops.
