(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* The theorems: a certificate that is accepted is true. *)
From Coq Require Import ZArith List Reals.
From Flocq Require Import BinarySingleNaN.
From CinchChecker Require Import content statement checker run_proof frame_proof ieee_proof.
Open Scope R_scope.

Theorem accepted_certificates_are_true : forall ls, accepts ls = true -> exists c, ls = lines c /\ proves c.
Proof.
  intros ls A. apply accepted_is_checked in A as (c & -> & K). exists c. split; [reflexivity |].
  now apply checked_proves.
Qed.

(* The computed statement again, of the operations of IEEE 754 on doubles that stand for the file's numbers *)
Theorem accepted_certificates_hold_in_ieee_arithmetic : forall ls, accepts ls = true -> exists c, ls = lines c /\
  forall f i d a b g bound k v, In f (frames c) -> states f i d bound ->
    nth_error (directions (kdop (head c))) d = Some (a, b, g) -> below (bvs c) (triangles_of c) i k ->
    at_index (vertices c) k = Some v ->
  forall x y z lx ly lz, spells (px (rest v)) x -> spells (py (rest v)) y -> spells (pz (rest v)) z ->
    spells_influences row_x (maps f) v lx -> spells_influences row_y (maps f) v ly ->
    spells_influences row_z (maps f) v lz ->
    let p := ieee_sum x y z lx zero in let q := ieee_sum x y z ly zero in let r := ieee_sum x y z lz zero in
    (a <> 0%Z -> is_finite p = true) /\ (b <> 0%Z -> is_finite q = true) /\ (g <> 0%Z -> is_finite r = true) /\
    along (a, b, g) (B2R p) (B2R q) (B2R r) <= value bound.
Proof.
  intros ls A. apply accepted_certificates_are_true in A as (c & E & P). exists c. split; [exact E |].
  intros f i d a b g bound k v F S D W V x y z lx ly lz. apply enclosed_in_ieee.
  exact (vertices_are_enclosed c P f i d (a, b, g) bound k v F S D W V).
Qed.
