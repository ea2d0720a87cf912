(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* The theorem: a certificate that is accepted is true. *)
From Coq Require Import List.
From CinchChecker Require Import Content Statement Checker RunProof FrameProof.

Theorem accepted_certificates_are_true : forall ls, accepts ls = true -> exists c, ls = lines c /\ proves c.
Proof.
  intros ls A. apply accepted_is_checked in A as (c & -> & K). exists c. split; [reflexivity |].
  now apply checked_proves.
Qed.

Print Assumptions accepted_certificates_are_true.
