(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* Weak duality over the limited convex weight space W' (Eq. 9) and Eq. 12 as one of its values, in real numbers. *)
From Coq Require Import Reals Lra List Permutation.
Import ListNotations.
Open Scope R_scope.

(* What one BV knows of a simulation node along one direction: its weight interval and its extremum b. *)
Record node := Node { low : R; high : R; extremum : R }.

Definition sum {A} (f : A -> R) (s : list A) : R := fold_right (fun a r => f a + r) 0 s.

Lemma sum_cons {A} (f : A -> R) a s : sum f (a :: s) = f a + sum f s.
Proof. reflexivity. Qed.

Lemma sum_app {A} (f : A -> R) s t : sum f (s ++ t) = sum f s + sum f t.
Proof. induction s as [| a s IH]; simpl; [lra |]. unfold sum in *; simpl; rewrite IH; lra. Qed.

Lemma sum_permutation {A} (f : A -> R) s t : Permutation s t -> sum f s = sum f t.
Proof. induction 1; unfold sum in *; simpl in *; lra. Qed.

Lemma sum_map {A B} (g : A -> B) (f : B -> R) s : sum f (map g s) = sum (fun a => f (g a)) s.
Proof. induction s as [| a s IH]; unfold sum in *; simpl; [reflexivity | now rewrite IH]. Qed.

Lemma sum_le {A} (f g : A -> R) s : Forall (fun a => f a <= g a) s -> sum f s <= sum g s.
Proof. induction 1; unfold sum in *; simpl; lra. Qed.

Lemma sum_plus {A} (f g : A -> R) s : sum (fun a => f a + g a) s = sum f s + sum g s.
Proof. induction s as [| a s IH]; unfold sum in *; simpl; [lra | rewrite IH; lra]. Qed.

Lemma sum_scale {A} c (f : A -> R) s : sum (fun a => c * f a) s = c * sum f s.
Proof. induction s as [| a s IH]; unfold sum in *; simpl; [lra | rewrite IH; lra]. Qed.

Lemma sum_ext {A} (f g : A -> R) s : Forall (fun a => f a = g a) s -> sum f s = sum g s.
Proof. induction 1 as [| a s E _ IH]; unfold sum in *; simpl; [reflexivity | now rewrite E, IH]. Qed.

Lemma sum_nonnegative {A} (f : A -> R) s : Forall (fun a => 0 <= f a) s -> 0 <= sum f s.
Proof. induction 1; unfold sum in *; simpl; lra. Qed.

Global Arguments sum : simpl never.

(* A weight vector of W', node by node. *)
Definition within (p : node * R) : Prop := low (fst p) <= snd p <= high (fst p).
Definition in_space (s : list (node * R)) : Prop := Forall within s /\ sum snd s = 1.
Definition mean (s : list (node * R)) : R := sum (fun p => snd p * extremum (fst p)) s.

(* D(lambda) of toolkit/bounds/weight_space.hpp. *)
Definition dual_term (lambda : R) (n : node) : R :=
  low n * (extremum n - lambda) + (high n - low n) * Rmax (extremum n - lambda) 0.
Definition dual (lambda : R) (s : list node) : R := lambda + sum (dual_term lambda) s.

Lemma dual_term_bounds lambda p : within p -> snd p * (extremum (fst p) - lambda) <= dual_term lambda (fst p).
Proof.
  destruct p as [n w]; unfold within, dual_term; simpl; intros [L H].
  destruct (Rle_or_lt 0 (extremum n - lambda)) as [P | P].
  - rewrite Rmax_left by lra.
    replace (low n * (extremum n - lambda) + (high n - low n) * (extremum n - lambda))
      with (high n * (extremum n - lambda)) by ring.
    now apply Rmult_le_compat_r.
  - rewrite Rmax_right by lra. rewrite Rmult_0_r, Rplus_0_r. nra.
Qed.

(* For every lambda, whatever the intervals; also of weights that sum to no 1. *)
Lemma weak_duality_any_sum lambda s :
  Forall within s -> mean s <= lambda * sum snd s + sum (fun p => dual_term lambda (fst p)) s.
Proof.
  intros W. unfold mean. induction W as [| p s P _ IH]; [unfold sum; simpl; lra |].
  rewrite !sum_cons. pose proof (dual_term_bounds lambda p P). lra.
Qed.

Theorem weak_duality lambda s : in_space s -> mean s <= dual lambda (map fst s).
Proof.
  intros [W S]. unfold dual. rewrite sum_map.
  pose proof (weak_duality_any_sum lambda s W) as H. rewrite S in H. lra.
Qed.

(* The other form of D: h where the extremum is at least lambda, l elsewhere. *)
Lemma dual_term_selects lambda n :
  dual_term lambda n = (if Rle_dec lambda (extremum n) then high n else low n) * (extremum n - lambda).
Proof.
  unfold dual_term. destruct (Rle_dec lambda (extremum n)).
  - rewrite Rmax_left by lra. ring.
  - rewrite Rmax_right by lra. ring.
Qed.

Lemma dual_permutation lambda s t : Permutation s t -> dual lambda s = dual lambda t.
Proof. intros P. unfold dual. now rewrite (sum_permutation _ _ _ P). Qed.

(* The greatest extremum is a bound too: `convex`, section 5.1.2. *)
Theorem convex_bound s most :
  in_space s -> Forall (fun p => 0 <= snd p /\ extremum (fst p) <= most) s -> mean s <= most.
Proof.
  intros [_ S] F. replace most with (most * sum snd s) by (rewrite S; ring). unfold mean.
  rewrite <- sum_scale. apply sum_le. apply Forall_impl with (2 := F).
  intros p [P B]. rewrite Rmult_comm. now apply Rmult_le_compat_r.
Qed.

(* Eq. 12, the first node that of the greatest extremum, the second that of the second greatest. *)
Definition eq12 (n1 n2 : node) (others : list node) : R :=
  high n1 * extremum n1 + (1 - high n1 - sum low others) * extremum n2 +
  sum (fun n => low n * extremum n) others.

Definition two_greatest (n1 n2 : node) (others : list node) : Prop :=
  extremum n2 <= extremum n1 /\ Forall (fun n => extremum n <= extremum n2) others.

Theorem eq12_is_dual n1 n2 others :
  two_greatest n1 n2 others -> dual (extremum n2) (n1 :: n2 :: others) = eq12 n1 n2 others.
Proof.
  intros [G F]. unfold dual, eq12. rewrite !sum_cons.
  assert (O : sum (dual_term (extremum n2)) others =
              sum (fun n => low n * extremum n) others - extremum n2 * sum low others).
  { clear G. induction F as [| n s L _ IH]; [unfold sum; simpl; ring |].
    rewrite !sum_cons, IH. unfold dual_term. rewrite Rmax_right by lra. ring. }
  rewrite O. unfold dual_term. rewrite Rmax_left, Rmax_left by lra. ring.
Qed.

Theorem eq12_bounds n1 n2 others s :
  two_greatest n1 n2 others -> Permutation (map fst s) (n1 :: n2 :: others) -> in_space s ->
  mean s <= eq12 n1 n2 others.
Proof.
  intros G P S. rewrite <- (eq12_is_dual n1 n2 others G), <- (dual_permutation _ _ _ P).
  now apply weak_duality.
Qed.

(* The n(n - 1) corners of section 5.2.2 in Kavan and Zara's coherent form: h at i, what is missing to 1 at j, l
   elsewhere. The corner of the two greatest is Eq. 12, so that the greatest of all corners is a bound. *)
Definition corner (all : list node) (i j : node) : R :=
  sum (fun n => low n * extremum n) all + (high i - low i) * extremum i +
  (1 - sum low all - (high i - low i)) * extremum j.

Theorem corner_is_eq12 n1 n2 others : corner (n1 :: n2 :: others) n1 n2 = eq12 n1 n2 others.
Proof. unfold corner, eq12. rewrite !sum_cons. ring. Qed.

Lemma corner_permutation s t i j : Permutation s t -> corner s i j = corner t i j.
Proof. intros P. unfold corner. now rewrite (sum_permutation _ _ _ P), (sum_permutation low _ _ P). Qed.

Theorem corners_bound n1 n2 others s most :
  two_greatest n1 n2 others -> Permutation (map fst s) (n1 :: n2 :: others) -> in_space s ->
  corner (map fst s) n1 n2 <= most -> mean s <= most.
Proof.
  intros G P S C. rewrite (corner_permutation _ _ _ _ P), corner_is_eq12 in C.
  pose proof (eq12_bounds n1 n2 others s G P S). lra.
Qed.
