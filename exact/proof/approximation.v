(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* A calculus of rounding errors: a computed c and the exact x, leaves of which pass at most k roundings, |x| <= X. *)
From Coq Require Import Reals Lra Lia ZArith.
From Flocq Require Import Core.
From CinchProof Require Import rounding.
Open Scope R_scope.

Section Approximation.
Variables prec emin : Z.
Context {format : Format prec emin}.
Notation fl := (fl prec emin).
Notation number := (number prec emin).
Notation u := (u prec).
Notation eta := (eta emin).

(* (1 + u)^k - 1 of k roundings. *)
Definition growth (k : nat) : R := (1 + u) ^ k - 1.

Lemma power_at_least_1 k : 1 <= (1 + u) ^ k.
Proof. apply pow_R1_Rle. pose proof (u_positive prec). lra. Qed.
Lemma growth_nonnegative k : 0 <= growth k.
Proof. unfold growth. pose proof (power_at_least_1 k). lra. Qed.
Lemma growth_le j k : (j <= k)%nat -> growth j <= growth k.
Proof.
  intros L. unfold growth. apply Rplus_le_compat_r. apply Rle_pow; [| exact L]. pose proof (u_positive prec). lra.
Qed.
Lemma growth_small k : INR k * u <= 1 -> growth k <= INR k * u + (INR k * u) * (INR k * u).
Proof.
  pose proof (u_positive prec) as U. unfold growth. induction k as [| k IH]; intros S.
  - simpl. lra.
  - rewrite S_INR in *. pose proof (pos_INR k). assert (INR k * u <= 1) by nra. specialize (IH H0).
    replace ((1 + u) ^ (Datatypes.S k)) with ((1 + u) ^ k * (1 + u)) by (simpl; ring).
    assert ((1 + u) ^ k * (1 + u) <= (1 + INR k * u + INR k * u * (INR k * u)) * (1 + u))
      by (apply Rmult_le_compat_r; lra).
    assert (INR k * u * (INR k * u) * u <= INR k * u * 1 * u) by
      (apply Rmult_le_compat_r; [lra |]; apply Rmult_le_compat_l; nra).
    nra.
Qed.

(* k roundings, X, and underflow of at most a eta. *)
Definition approximates (k : nat) (c x X a : R) : Prop :=
  number c /\ Rabs x <= X /\ Rabs (c - x) <= growth k * X + a * eta.

Lemma approximates_exact x : number x -> approximates 0 x x (Rabs x) 0.
Proof.
  intros F. split; [exact F |]. split; [apply Rle_refl |].
  replace (x - x) with 0 by ring. rewrite Rabs_R0. unfold growth. simpl. lra.
Qed.

Lemma approximates_weaken j k c x X a b :
  (j <= k)%nat -> a <= b -> approximates j c x X a -> approximates k c x X b.
Proof.
  intros L A (F & B & E). split; [exact F |]. split; [exact B |]. apply Rle_trans with (1 := E).
  pose proof (growth_le j k L). pose proof (Rabs_pos x). pose proof (eta_positive emin). nra.
Qed.

Lemma approximates_opp k c x X a : approximates k c x X a -> approximates k (- c) (- x) X a.
Proof.
  intros (F & B & E). split; [now apply (number_opp prec emin) |]. split; [now rewrite Rabs_Ropp |].
  replace (- c - - x) with (- (c - x)) by ring. now rewrite Rabs_Ropp.
Qed.

Lemma approximates_abs k c x X a : approximates k c x X a -> approximates k (Rabs c) (Rabs x) X a.
Proof.
  intros (F & B & E). split; [now apply (number_abs prec emin) |]. split; [now rewrite Rabs_Rabsolu |].
  apply Rle_trans with (2 := E). apply Rabs_triang_inv2.
Qed.

Lemma approximates_add k c x X a d y Y b :
  approximates k c x X a -> approximates k d y Y b ->
  approximates (S k) (fl (c + d)) (x + y) (X + Y) ((1 + u) * (a + b)).
Proof.
  intros (F & B & E) (G & C & D). pose proof (u_positive prec).
  split; [apply (fl_number prec emin) |]. split; [pose proof (Rabs_triang x y); lra |].
  pose proof (fl_plus_error prec emin c d F G) as R.
  replace (fl (c + d) - (x + y)) with ((fl (c + d) - (c + d)) + ((c - x) + (d - y))) by ring.
  pose proof (Rabs_triang (fl (c + d) - (c + d)) ((c - x) + (d - y))).
  pose proof (Rabs_triang (c - x) (d - y)).
  assert (V : Rabs (c + d) <= (1 + growth k) * (X + Y) + (a + b) * eta).
  { replace (c + d) with ((x + y) + ((c - x) + (d - y))) by ring.
    pose proof (Rabs_triang (x + y) ((c - x) + (d - y))). pose proof (Rabs_triang x y). lra. }
  assert (u * Rabs (c + d) <= u * ((1 + growth k) * (X + Y) + (a + b) * eta)) by (apply Rmult_le_compat_l; lra).
  replace (growth (S k)) with ((1 + u) * growth k + u) by (unfold growth; simpl; ring). lra.
Qed.

Lemma approximates_sub k c x X a d y Y b :
  approximates k c x X a -> approximates k d y Y b ->
  approximates (S k) (fl (c - d)) (x - y) (X + Y) ((1 + u) * (a + b)).
Proof. intros E D. apply approximates_add; [exact E | now apply approximates_opp]. Qed.

(* Factors that have lost nothing to underflow. *)
Lemma approximates_mul j k c x X d y Y :
  approximates j c x X 0 -> approximates k d y Y 0 ->
  approximates (S (j + k)) (fl (c * d)) (x * y) (X * Y) (/ 2).
Proof.
  intros (F & B & E) (G & C & D). pose proof (u_positive prec). pose proof (Rabs_pos x). pose proof (Rabs_pos y).
  rewrite Rmult_0_l, Rplus_0_r in E, D.
  pose proof (growth_nonnegative j) as GJ. pose proof (growth_nonnegative k) as GK.
  assert (XY : Rabs (x * y) <= X * Y) by (rewrite Rabs_mult; apply Rmult_le_compat; lra).
  split; [apply (fl_number prec emin) |]. split; [exact XY |].
  assert (W : Rabs (c * d - x * y) <= growth (j + k) * (X * Y)).
  { replace (c * d - x * y) with ((c - x) * (d - y) + (c - x) * y + x * (d - y)) by ring.
    pose proof (Rabs_triang ((c - x) * (d - y) + (c - x) * y) (x * (d - y))).
    pose proof (Rabs_triang ((c - x) * (d - y)) ((c - x) * y)).
    pose proof (Rabs_pos (c - x)). pose proof (Rabs_pos (d - y)).
    assert (Rabs ((c - x) * (d - y)) <= growth j * X * (growth k * Y)) by
      (rewrite Rabs_mult; apply Rmult_le_compat; lra).
    assert (Rabs ((c - x) * y) <= growth j * X * Y) by (rewrite Rabs_mult; apply Rmult_le_compat; lra).
    assert (Rabs (x * (d - y)) <= X * (growth k * Y)) by (rewrite Rabs_mult; apply Rmult_le_compat; lra).
    replace (growth (j + k)) with (growth j * growth k + growth j + growth k)
      by (unfold growth; rewrite pow_add; ring). lra. }
  pose proof (fl_error prec emin (c * d)) as R.
  replace (fl (c * d) - x * y) with ((fl (c * d) - c * d) + (c * d - x * y)) by ring.
  pose proof (Rabs_triang (fl (c * d) - c * d) (c * d - x * y)).
  assert (V : Rabs (c * d) <= (1 + growth (j + k)) * (X * Y)).
  { replace (c * d) with (x * y + (c * d - x * y)) by ring.
    pose proof (Rabs_triang (x * y) (c * d - x * y)). lra. }
  assert (u * Rabs (c * d) <= u * ((1 + growth (j + k)) * (X * Y))) by (apply Rmult_le_compat_l; lra).
  replace (growth (S (j + k))) with ((1 + u) * growth (j + k) + u) by (unfold growth; simpl; ring). lra.
Qed.

(* A factor of at most 1, such as a weight, may meet one that has. *)
Lemma approximates_weighted k w c x X a :
  number w -> 0 <= w <= 1 -> 0 <= a -> approximates k c x X a ->
  approximates (S k) (fl (w * c)) (w * x) (w * X) ((1 + u) * a + / 2).
Proof.
  intros Fw Iw A (F & B & E). pose proof (u_positive prec). pose proof (Rabs_pos x). pose proof (eta_positive emin).
  pose proof (growth_nonnegative k).
  split; [apply (fl_number prec emin) |].
  split; [rewrite Rabs_mult, (Rabs_pos_eq w) by lra; apply Rmult_le_compat_l; lra |].
  assert (W : Rabs (w * c - w * x) <= growth k * (w * X) + a * eta).
  { rewrite <- Rmult_minus_distr_l, Rabs_mult, (Rabs_pos_eq w) by lra.
    assert (w * Rabs (c - x) <= w * (growth k * X + a * eta)) by (apply Rmult_le_compat_l; lra).
    assert (w * (a * eta) <= 1 * (a * eta)) by (apply Rmult_le_compat_r; [apply Rmult_le_pos |]; lra). lra. }
  pose proof (fl_error prec emin (w * c)) as R.
  replace (fl (w * c) - w * x) with ((fl (w * c) - w * c) + (w * c - w * x)) by ring.
  pose proof (Rabs_triang (fl (w * c) - w * c) (w * c - w * x)).
  assert (V : Rabs (w * c) <= (1 + growth k) * (w * X) + a * eta).
  { replace (w * c) with (w * x + (w * c - w * x)) by ring.
    pose proof (Rabs_triang (w * x) (w * c - w * x)).
    assert (Rabs (w * x) <= w * X) by (rewrite Rabs_mult, (Rabs_pos_eq w) by lra; apply Rmult_le_compat_l; lra). lra. }
  assert (u * Rabs (w * c) <= u * ((1 + growth k) * (w * X) + a * eta)) by (apply Rmult_le_compat_l; lra).
  replace (growth (S k)) with ((1 + u) * growth k + u) by (unfold growth; simpl; ring). lra.
Qed.

(* Signs: fl(s c) is exact for s = -1, 0 or 1. *)
Lemma signed_exact s c : (-1 <= s <= 1)%Z -> number c -> fl (IZR s * c) = IZR s * c.
Proof.
  intros S F. apply (fl_id prec emin).
  assert (H : s = (-1)%Z \/ s = 0%Z \/ s = 1%Z) by lia. destruct H as [-> | [-> | ->]].
  - replace (-1 * c) with (- c) by ring. now apply (number_opp prec emin).
  - rewrite Rmult_0_l. apply (number_0 prec emin).
  - now rewrite Rmult_1_l.
Qed.

Lemma approximates_0 : approximates 0 0 0 0 0.
Proof. pose proof (approximates_exact 0 (number_0 prec emin)) as A. now rewrite Rabs_R0 in A. Qed.
End Approximation.
