(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* Bounds for every instant of an interval from those at its ends, in real numbers: chord plus bump, and the closed form
   of its maximum, as toolkit/time/interval_refit.cpp takes it; by speed; and over W' by weak duality. Time runs from 0
   to 1, derivatives are by that time. *)
From Coq Require Import Reals Lra List.
From CinchProof Require Import duality.
Import ListNotations.
Open Scope R_scope.

Lemma Rabs_le_inv' x l : Rabs x <= l -> - l <= x <= l.
Proof. unfold Rabs. destruct Rcase_abs; lra. Qed.

(* 8 s is how concave f is at most: f'' >= -8 s. *)
Section Path.
Variables f f1 f2 : R -> R.
Hypothesis first_derivative : forall t, 0 <= t <= 1 -> derivable_pt_lim f t (f1 t).
Hypothesis second_derivative : forall t, 0 <= t <= 1 -> derivable_pt_lim f1 t (f2 t).

Theorem chord_and_bump s t :
  (forall r, 0 <= r <= 1 -> - 8 * s <= f2 r) -> 0 <= t <= 1 ->
  f t <= (1 - t) * f 0 + t * f 1 + 4 * t * (1 - t) * s.
Proof.
  intros C T. apply Rnot_lt_le. intros Above.
  set (h := fun r => f r - ((1 - r) * f 0 + r * f 1 + 4 * r * (1 - r) * s)).
  set (h1 := fun r => f1 r - (f 1 - f 0 + 4 * (1 - 2 * r) * s)).
  set (h2 := fun r => f2 r + 8 * s).
  assert (Poly : forall a b c r, derivable_pt_lim (fun r => a + b * r + c * r ^ 2) r (b + c * (2 * r))).
  { intros a b c r. replace (b + c * (2 * r)) with (0 + b * 1 + c * (INR 2 * r ^ pred 2)) by (simpl; ring).
    apply (derivable_pt_lim_plus (fun r => a + b * r) (fun r => c * r ^ 2)).
    - apply (derivable_pt_lim_plus (fun _ => a) (fun r => b * r)); [apply derivable_pt_lim_const |].
      apply (derivable_pt_lim_scal id b r 1), derivable_pt_lim_id.
    - apply (derivable_pt_lim_scal (fun r => r ^ 2) c r), derivable_pt_lim_pow. }
  assert (D1 : forall r, 0 <= r <= 1 -> derivable_pt_lim h r (h1 r)).
  { intros r Ir. pose proof (derivable_pt_lim_minus f (fun r => f 0 + (f 1 - f 0 + 4 * s) * r + (- 4 * s) * r ^ 2) r _ _
      (first_derivative r Ir) (Poly (f 0) (f 1 - f 0 + 4 * s) (- 4 * s) r)) as D.
    unfold h1. replace (f1 r - (f 1 - f 0 + 4 * (1 - 2 * r) * s))
      with (f1 r - (f 1 - f 0 + 4 * s + -4 * s * (2 * r))) by ring.
    apply (derivable_pt_lim_ext _ h r _) with (2 := D). intros q. unfold minus_fct, h. ring. }
  assert (D2 : forall r, 0 <= r <= 1 -> derivable_pt_lim h1 r (h2 r)).
  { intros r Ir. pose proof (derivable_pt_lim_minus f1 (fun r => f 1 - f 0 + 4 * s + (- 8 * s) * r + 0 * r ^ 2) r _ _
      (second_derivative r Ir) (Poly (f 1 - f 0 + 4 * s) (- 8 * s) 0 r)) as D.
    unfold h2. replace (f2 r + 8 * s) with (f2 r - (-8 * s + 0 * (2 * r))) by ring.
    apply (derivable_pt_lim_ext _ h1 r _) with (2 := D). intros q. unfold minus_fct, h1. ring. }
  assert (H0 : h 0 = 0) by (unfold h; ring). assert (H1 : h 1 = 0) by (unfold h; ring).
  assert (HT : 0 < h t) by (unfold h; lra).
  assert (T0 : 0 < t) by (destruct (Req_dec t 0) as [E | E]; [subst t; lra | lra]).
  assert (T1 : t < 1) by (destruct (Req_dec t 1) as [E | E]; [subst t; lra | lra]).
  destruct (MVT_cor2 h h1 0 t T0) as (c & Ec & Ic); [intros r Ir; apply D1; lra |].
  destruct (MVT_cor2 h h1 t 1 T1) as (d & Ed & Id); [intros r Ir; apply D1; lra |].
  destruct (MVT_cor2 h1 h2 c d) as (e & Ee & Ie); [lra | intros r Ir; apply D2; lra |].
  assert (0 < h1 c) by (apply Rmult_lt_reg_r with (t - 0); lra).
  assert (h1 d < 0) by (apply Rmult_lt_reg_r with (1 - t); lra).
  assert (0 <= h2 e * (d - c)) by (apply Rmult_le_pos; [unfold h2; specialize (C e); lra | lra]). lra.
Qed.

(* f' of at most l in magnitude. *)
Theorem by_speed l t : (forall r, 0 <= r <= 1 -> Rabs (f1 r) <= l) -> 0 <= t <= 1 ->
  f t <= (f 0 + f 1 + l) / 2 /\ f t <= f 0 + l /\ f t <= f 1 + l.
Proof.
  intros L T.
  assert (L0 : 0 <= l) by (apply Rle_trans with (2 := L 0 ltac:(lra)); apply Rabs_pos).
  assert (A : f t <= f 0 + t * l).
  { destruct (Req_dec t 0) as [-> | N]; [lra |].
    destruct (MVT_cor2 f f1 0 t) as (c & E & I); [lra | intros r Ir; apply first_derivative; lra |].
    specialize (L c ltac:(lra)). apply Rabs_le_inv' in L.
    assert (f1 c * (t - 0) <= l * (t - 0)) by (apply Rmult_le_compat_r; lra).
    lra. }
  assert (B : f t <= f 1 + (1 - t) * l).
  { destruct (Req_dec t 1) as [-> | N]; [lra |].
    destruct (MVT_cor2 f f1 t 1) as (c & E & I); [lra | intros r Ir; apply first_derivative; lra |].
    specialize (L c ltac:(lra)). apply Rabs_le_inv' in L.
    assert (- l * (1 - t) <= f1 c * (1 - t)) by (apply Rmult_le_compat_r; lra). lra. }
  assert (t * l <= 1 * l) by (apply Rmult_le_compat_r; lra).
  assert ((1 - t) * l <= 1 * l) by (apply Rmult_le_compat_r; lra). lra.
Qed.
End Path.

(* The greatest of (1 - t) a + t b + 4 t (1 - t) s over the interval. *)
Definition greatest_between (a b s : R) : R :=
  if Rle_dec s 0 then Rmax a b
  else if Rle_dec (4 * s) (Rabs (b - a)) then Rmax a b
  else (a + b) / 2 + s + (b - a) * (b - a) / (16 * s).

Theorem closed_form a b s t : 0 <= t <= 1 ->
  (1 - t) * a + t * b + 4 * t * (1 - t) * s <= greatest_between a b s.
Proof.
  intros T. unfold greatest_between. assert (TT : 0 <= t * (1 - t)) by (apply Rmult_le_pos; lra).
  destruct (Rle_dec s 0) as [S | S].
  - pose proof (Rmax_l a b). pose proof (Rmax_r a b).
  assert (t * (1 - t) * s <= t * (1 - t) * 0) by (apply Rmult_le_compat_l; lra).
    nra.
  - apply Rnot_le_lt in S. destruct (Rle_dec (4 * s) (Rabs (b - a))) as [B | B].
    + (* the slope does not change its sign *)
      assert (TS : t * s <= s) by nra. assert (US : (1 - t) * s <= s) by nra.
      unfold Rabs in B. destruct (Rcase_abs (b - a)) as [N | N].
      * rewrite Rmax_left by lra. assert (0 <= t * (a - b - 4 * ((1 - t) * s))) by (apply Rmult_le_pos; lra). lra.
      * rewrite Rmax_right by lra. assert (0 <= (1 - t) * (b - a - 4 * (t * s))) by (apply Rmult_le_pos; lra). lra.
    + (* a square is left *)
      assert (E : (a + b) / 2 + s + (b - a) * (b - a) / (16 * s) - ((1 - t) * a + t * b + 4 * t * (1 - t) * s) =
                  (4 * s * (2 * t - 1) - (b - a)) * (4 * s * (2 * t - 1) - (b - a)) * / (16 * s)) by (field; lra).
      assert (0 <= (4 * s * (2 * t - 1) - (b - a)) * (4 * s * (2 * t - 1) - (b - a)) * / (16 * s)).
      { apply Rmult_le_pos; [apply Rle_0_sqr | apply Rlt_le, Rinv_0_lt_compat; lra]. }
      lra.
Qed.

(* A vertex moves as its simulation nodes do: f'' = sum w f_j''. How concave each f_j is at most goes through W' as its
   extremum does. *)
Theorem concavity_by_duality lambda (s : list (node * R)) (second : node -> R) :
  in_space s -> Forall (fun p => 0 <= snd p /\ - 8 * extremum (fst p) <= second (fst p)) s ->
  - 8 * dual lambda (map fst s) <= sum (fun p => snd p * second (fst p)) s.
Proof.
  intros W F. pose proof (weak_duality lambda s W) as D.
  assert (- 8 * mean s <= sum (fun p => snd p * second (fst p)) s); [| lra].
  unfold mean. rewrite <- sum_scale. apply sum_le. apply Forall_impl with (2 := F). intros p [P C].
  replace (- 8 * (snd p * extremum (fst p))) with (snd p * (- 8 * extremum (fst p))) by ring.
  now apply Rmult_le_compat_l.
Qed.

(* Together: bounds at the ends, and a bound on the concavity, bound every instant. *)
Theorem bounded_between f f1 f2 a b s t :
  (forall r, 0 <= r <= 1 -> derivable_pt_lim f r (f1 r)) -> (forall r, 0 <= r <= 1 -> derivable_pt_lim f1 r (f2 r)) ->
  (forall r, 0 <= r <= 1 -> - 8 * s <= f2 r) -> f 0 <= a -> f 1 <= b -> 0 <= t <= 1 -> f t <= greatest_between a b s.
Proof.
  intros D1 D2 C A B T. apply Rle_trans with (2 := closed_form a b s t T).
  pose proof (chord_and_bump f f1 f2 D1 D2 s t C T).
  assert ((1 - t) * f 0 <= (1 - t) * a) by (apply Rmult_le_compat_l; lra).
  assert (t * f 1 <= t * b) by (apply Rmult_le_compat_l; lra). lra.
Qed.
