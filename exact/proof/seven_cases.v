(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* Appendix A of the paper: its seven weighting schemes (Table A1) and differences (A.2) to (A.7). *)
From Coq Require Import Reals Lra List.
From CinchProof Require Import duality.
Import ListNotations.
Open Scope R_scope.

Section Seven_cases.
Variables n1 n2 n3 n4 : node.
Variable others : list node.

Definition lowest : list (node * R) := map (fun n => (n, low n)) others.
(* What is missing to 1 with h at i and l at the two simulation nodes a and b and the others. *)
Definition missing (i a b : node) : R := 1 - high i - (low a + low b + sum low others).
Definition scheme (w1 w2 w3 w4 : R) : list (node * R) :=
  (n1, w1) :: (n2, w2) :: (n3, w3) :: (n4, w4) :: lowest.

Definition scheme1 := scheme (high n1) (missing n1 n3 n4) (low n3) (low n4).
Definition scheme2 := scheme (high n1) (low n2) (missing n1 n2 n4) (low n4).
Definition scheme3 := scheme (missing n2 n3 n4) (high n2) (low n3) (low n4).
Definition scheme4 := scheme (missing n3 n2 n4) (low n2) (high n3) (low n4).
Definition scheme5 := scheme (low n1) (high n2) (missing n2 n1 n4) (low n4).
Definition scheme6 := scheme (low n1) (missing n3 n1 n4) (high n3) (low n4).
Definition scheme7 := scheme (low n1) (low n2) (high n3) (missing n3 n1 n2).

Let b1 := extremum n1.
Let b2 := extremum n2.
Let b3 := extremum n3.
Let b4 := extremum n4.

Lemma mean_of_scheme w1 w2 w3 w4 :
  mean (scheme w1 w2 w3 w4) = w1 * b1 + w2 * b2 + w3 * b3 + w4 * b4 + sum (fun n => low n * extremum n) others.
Proof.
  unfold mean, scheme. rewrite !sum_cons. unfold lowest. rewrite sum_map. cbv beta. unfold b1, b2, b3, b4, fst, snd.
  ring.
Qed.

Lemma sum_of_scheme w1 w2 w3 w4 : sum snd (scheme w1 w2 w3 w4) = w1 + w2 + w3 + w4 + sum low others.
Proof.
  unfold scheme. rewrite !sum_cons. unfold lowest. rewrite sum_map. change (fun a => snd (a, low a)) with low. simpl.
  ring.
Qed.

(* Every scheme sums to 1. *)
Theorem schemes_sum_to_one :
  Forall (fun s => sum snd s = 1) [scheme1; scheme2; scheme3; scheme4; scheme5; scheme6; scheme7].
Proof.
  unfold scheme1, scheme2, scheme3, scheme4, scheme5, scheme6, scheme7.
  repeat (apply Forall_cons; [rewrite sum_of_scheme; unfold missing; ring |]). apply Forall_nil.
Qed.

Theorem scheme1_is_eq12 : mean scheme1 = eq12 n1 n2 (n3 :: n4 :: others).
Proof. unfold scheme1. rewrite mean_of_scheme. unfold eq12, missing, b1, b2, b3, b4. rewrite !sum_cons. ring. Qed.

Let S := sum low others.
Theorem A2 : mean scheme1 - mean scheme2 = (1 - high n1 - (low n2 + low n3 + low n4 + S)) * (b2 - b3).
Proof. unfold scheme1, scheme2. rewrite !mean_of_scheme. unfold missing, S. ring. Qed.
Theorem A3 : mean scheme1 - mean scheme3 = (high n1 - missing n2 n3 n4) * (b1 - b2).
Proof. unfold scheme1, scheme3. rewrite !mean_of_scheme. unfold missing. ring. Qed.
Theorem A4 :
  mean scheme1 - mean scheme4 = (high n1 - missing n3 n2 n4) * (b1 - b2) + (high n3 - low n3) * (b2 - b3).
Proof. unfold scheme1, scheme4. rewrite !mean_of_scheme. unfold missing. ring. Qed.
Theorem A5 :
  mean scheme1 - mean scheme5 = (missing n2 n1 n4 - low n3) * (b2 - b3) + (high n1 - low n1) * (b1 - b2).
Proof. unfold scheme1, scheme5. rewrite !mean_of_scheme. unfold missing. ring. Qed.
Theorem A6 :
  mean scheme1 - mean scheme6 = (high n1 - low n1) * (b1 - b2) + (high n3 - low n3) * (b2 - b3).
Proof. unfold scheme1, scheme6. rewrite !mean_of_scheme. unfold missing. ring. Qed.
Theorem A7 :
  mean scheme1 - mean scheme7 =
  (high n1 - low n1) * (b1 - b2) + (high n3 - low n3) * (b2 - b3) + (missing n3 n1 n2 - low n4) * (b2 - b4).
Proof. unfold scheme1, scheme7. rewrite !mean_of_scheme. unfold missing. ring. Qed.

(* All seven cases at once: a scheme that lies in W' is below Eq. 12, by weak duality. *)
Theorem seven_cases w1 w2 w3 w4 :
  two_greatest n1 n2 (n3 :: n4 :: others) -> in_space (scheme w1 w2 w3 w4) ->
  mean (scheme w1 w2 w3 w4) <= mean scheme1.
Proof.
  intros G W. rewrite scheme1_is_eq12. apply eq12_bounds with (s := scheme w1 w2 w3 w4); trivial.
  unfold scheme, lowest. simpl. rewrite map_map. simpl. rewrite map_id. apply Permutation.Permutation_refl.
Qed.

(* The corollaries, scheme by scheme. *)
Corollary schemes_below_eq12 :
  two_greatest n1 n2 (n3 :: n4 :: others) ->
  Forall (fun s => in_space s -> mean s <= mean scheme1)
         [scheme1; scheme2; scheme3; scheme4; scheme5; scheme6; scheme7].
Proof.
  intros G. unfold scheme2, scheme3, scheme4, scheme5, scheme6, scheme7.
  repeat (apply Forall_cons; [intros W; try apply Rle_refl; now apply seven_cases |]). apply Forall_nil.
Qed.
End Seven_cases.
