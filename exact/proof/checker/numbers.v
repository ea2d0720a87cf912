(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* Numbers as whole multiples of a power of two ("units" of 2 ^ -k), and the rounding of doubles among them. *)
From Coq Require Import ZArith List Bool.
From CinchChecker Require Import content.
Import ListNotations.
Open Scope Z_scope.

(* Of doubles: bits of the significand, least exponent, least overflow; named so that extraction builds them once *)
Definition weight_bits : Z := 53.
Definition one_weight : Z := 9007199254740992. (* 2 ^ 53 *)
Definition most_low_bits : Z := 52.
Definition subnormal_bits : Z := 1074.
Definition overflow_bits : Z := 1024.

Definition is_double (d : dyadic) : bool :=
  (Z.abs (man d) <? one_weight) && (- subnormal_bits <=? exn d) && (exn d <? overflow_bits) &&
  (Z.log2 (Z.abs (man d)) + exn d <? overflow_bits).

(* d in units of 2 ^ -k, where these are fine enough *)
Definition units (k : Z) (d : dyadic) : Z := Z.shiftl (man d) (exn d + k).

(* The least k, but at least `start`, whose units are fine enough for all *)
Definition finest (start : Z) (l : list dyadic) : Z := fold_left (fun k d => Z.max k (- exn d)) l start.

Definition is_weight (d : dyadic) : bool :=
  is_double d && (- weight_bits <=? exn d) &&
  (let u := units weight_bits d in (1 <=? u) && (u <=? one_weight)).

(* n * 2 ^ -k rounded to the nearest double, ties to even; None where that overflows *)
Definition rounded (k n : Z) : option Z :=
  let s := Z.max (Z.log2 (Z.abs n) - most_low_bits) (k - subnormal_bits) in
  let m :=
    if s <=? 0 then n
    else
      let q := Z.shiftr n s in
      match Z.compare (n - Z.shiftl q s) (Z.shiftl 1 (s - 1)) with
      | Lt => Z.shiftl q s
      | Gt => Z.shiftl (q + 1) s
      | Eq => if Z.even q then Z.shiftl q s else Z.shiftl (q + 1) s
      end in
  if Z.log2 (Z.abs m) <? overflow_bits + k then Some m else None.

(* d >= n * 2 ^ -k *)
Definition at_least (d : dyadic) (k n : Z) : bool :=
  let e := exn d + k in
  if 0 <=? e then n <=? Z.shiftl (man d) e else Z.shiftl n (- e) <=? man d.
