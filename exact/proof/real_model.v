(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* The model over real numbers with rounding and without overflow, and what its constants and error terms are. *)
From Coq Require Import Reals Lra Lia ZArith List.
From Flocq Require Import Core.
From CinchProof Require Import rounding successor model.
Open Scope R_scope.

Section Real_model.
Variables prec emin : Z.
Context {format : Format prec emin}.
Notation fl := (fl prec emin).
Notation number := (number prec emin).
Notation u := (u prec).
Notation eta := (eta emin).
Notation succ := (successor.succ prec emin).

Definition real_ops : ops R := {|
  precision := prec; least := emin;
  constant := fun m e => IZR m * bpow radix2 e;
  infinity := 0;
  add := fun x y => fl (x + y);
  sub := fun x y => fl (x - y);
  mul := fun x y => fl (x * y);
  absolute := Rabs;
  less := fun x y => Rlt_bool x y;
  less_equal := fun x y => Rle_bool x y;
  divide := fun x y => fl (x / y)
|}.

Lemma model_zero : zero real_ops = 0.
Proof. unfold zero. simpl. ring. Qed.
Lemma model_smallest n : smallest_times real_ops n = IZR n * eta.
Proof. reflexivity. Qed.
Lemma model_u : unit_roundoff real_ops = u.
Proof. unfold unit_roundoff, u, rounding.u. simpl. ring. Qed.

Lemma model_succ x : model.succ real_ops x = succ x.
Proof.
  unfold model.succ, successor.succ. rewrite model_smallest.
  replace (model.phi real_ops) with (successor.phi prec) by (rewrite (phi_scaled prec emin); reflexivity).
  rewrite Rmult_1_l. reflexivity.
Qed.

Lemma number_bit x : number x -> 0 < x -> eta <= x.
Proof.
  intros F P. apply FLT_format_generic in F; [| typeclasses eauto].
  destruct F as [[m e] -> _ E]. simpl in E. unfold F2R in *. simpl in *.
  apply Rle_trans with (bpow radix2 e); [apply bpow_le; exact E |].
  pose proof (bpow_gt_0 radix2 e).
  assert (M : (0 < m)%Z).
  { apply lt_IZR. apply Rmult_lt_reg_r with (bpow radix2 e); [assumption | lra]. }
  assert (1 <= IZR m) by (apply IZR_le; lia). nra.
Qed.

(* k u as it is computed, k an integer. *)
Lemma integer_u k : (Z.abs k < 2 ^ prec)%Z -> fl (IZR k * u) = IZR k * u.
Proof.
  intros K. apply (fl_id prec emin). apply (scaled_number prec emin); [exact K |].
  pose proof (@prec_large prec emin format). pose proof (@emin_small prec emin format). lia.
Qed.

(* An error term fl(fl(k u M) + n eta) and the step after it: at least k u (1 - u) M + (n - 1/2) eta. *)
Lemma error_term k n M :
  (0 <= k < 2 ^ prec)%Z -> 0 <= M ->
  IZR k * u * (1 - u) * M + (IZR n - / 2) * eta <= succ (fl (fl (fl (IZR k * u) * M) + IZR n * eta)).
Proof.
  intros K P. rewrite integer_u by lia.
  pose proof (below_succ_fl prec emin (fl (IZR k * u * M) + IZR n * eta)) as B.
  pose proof (fl_error prec emin (IZR k * u * M)) as E. apply Rabs_le_inv in E.
  assert (0 <= IZR k) by (apply IZR_le; lia).
  pose proof (u_positive prec). rewrite Rabs_pos_eq in E by (repeat apply Rmult_le_pos; lra). nra.
Qed.

(* The same without a loss to underflow where M is exactly 0. *)
Lemma error_term_0 k n :
  IZR n * eta <= succ (fl (fl (fl (IZR k * u) * 0) + IZR n * eta)).
Proof.
  rewrite Rmult_0_r, (fl_0 prec emin), Rplus_0_l. apply below_succ_fl; exact format.
Qed.

Lemma model_sum_error n A :
  (0 <= n)%Z -> (n + 4 < 2 ^ prec)%Z ->
  sum_error real_ops n A = succ (fl (fl (fl (IZR (n + 4) * u) * A) + IZR n * eta)).
Proof.
  intros P S. unfold sum_error. rewrite model_succ, model_u, model_smallest. simpl.
  rewrite !Rmult_1_r, <- plus_IZR. rewrite (fl_id prec emin (IZR (n + _))); [reflexivity |].
  apply (integer_number prec emin). lia.
Qed.

Lemma model_evaluation_error n M :
  (0 <= n)%Z -> (n + 8 < 2 ^ prec)%Z ->
  evaluation_error real_ops n M = succ (fl (fl (fl (IZR (n + 8) * u) * M) + IZR (8 * n) * eta)).
Proof.
  intros P S. unfold evaluation_error. rewrite model_succ, model_u, model_smallest. simpl.
  rewrite !Rmult_1_r, <- plus_IZR. rewrite (fl_id prec emin (IZR (n + _))); [reflexivity |].
  apply (integer_number prec emin). lia.
Qed.

Lemma model_extremum_error M :
  extremum_error real_ops M = succ (fl (fl (fl (IZR 10 * u) * M) + IZR 16 * eta)).
Proof.
  unfold extremum_error. rewrite model_succ, model_u, model_smallest. simpl.
  rewrite !Rmult_1_r, Rmult_1_l. rewrite (fl_id prec emin (16 * _)); [reflexivity |].
  apply (scaled_number prec emin); [| lia].
  apply Z.lt_le_trans with (2 ^ 24)%Z; [reflexivity |]. apply Z.pow_le_mono_r; [lia |].
  exact (@prec_large prec emin format).
Qed.

Lemma sum_error_number n A : number (sum_error real_ops n A).
Proof. unfold sum_error. rewrite model_succ. apply succ_number; exact format. Qed.
End Real_model.
