(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* succ of toolkit/bounds/rounding.hpp: fl(x + fl(fl(phi |x|) + eta)), phi = u (1 + 2u),
  is at least the next number above
   x [Rump, Zimmermann, Boldo, Melquiond 2009]; so that z <= succ(fl z) for every real z. *)
From Coq Require Import Reals Lra Lia ZArith.
From Flocq Require Import Core.
From CinchProof Require Import rounding.
Open Scope R_scope.

Section Successor.
Variables prec emin : Z.
Context {format : Format prec emin}.
Notation fexp := (fexp prec emin).
Notation fl := (fl prec emin).
Notation number := (number prec emin).
Notation u := (u prec).
Notation eta := (eta emin).

Definition phi : R := u * (1 + 2 * u).
Definition succ (x : R) : R := fl (x + fl (fl (phi * Rabs x) + eta)).

Lemma phi_scaled : phi = IZR (2 ^ (prec - 1) + 1) * bpow radix2 (1 - 2 * prec).
Proof.
  pose proof (@prec_large prec emin format). unfold phi, u.
  rewrite plus_IZR, IZR_power by lia.
  rewrite Rmult_plus_distr_r, <- bpow_plus, Rmult_plus_distr_l, Rmult_1_r, Rmult_1_l.
  f_equal; [f_equal; lia |].
  replace (1 - 2 * prec)%Z with (1 + (- prec + - prec))%Z by lia. rewrite 2!bpow_plus.
  change (bpow radix2 1) with 2. ring.
Qed.

Lemma phi_number : number phi.
Proof.
  pose proof (@prec_large prec emin format). pose proof (@emin_small prec emin format).
  rewrite phi_scaled. apply (scaled_number prec emin); [| lia].
  rewrite Z.abs_eq by (pose proof (Z.pow_nonneg 2 (prec - 1)); lia).
  replace prec with (prec - 1 + 1)%Z at 2 by lia. rewrite Z.pow_add_r by lia.
  assert (2 ^ 1 <= 2 ^ (prec - 1))%Z by (apply Z.pow_le_mono_r; lia). lia.
Qed.

Lemma mag_prop_exists x : x <> 0 ->
  exists e, mag_val radix2 x (mag radix2 x) = e /\ bpow radix2 (e - 1) <= Rabs x < bpow radix2 e.
Proof. intros N. destruct (mag radix2 x) as [e M]. exists e. split; [reflexivity | exact (M N)]. Qed.

(* The step is more than half the distance to the next number. *)
Lemma step_above_half_ulp x : / 2 * ulp radix2 fexp x < fl (fl (phi * Rabs x) + eta).
Proof.
  pose proof (@prec_large prec emin format) as P. pose proof (@emin_small prec emin format).
  pose proof (u_positive prec) as U. pose proof (eta_positive emin) as E0.
  assert (PA : 0 <= phi * Rabs x) by (apply Rmult_le_pos; [unfold phi; nra | apply Rabs_pos]).
  pose proof (fl_nonnegative prec emin _ PA) as PF.
  assert (E : eta <= fl (fl (phi * Rabs x) + eta)) by (apply (fl_above prec emin);
    [lra | now apply (eta_number prec emin)]).
  destruct (Rlt_or_le (Rabs x) (bpow radix2 (emin + prec))) as [S | L].
  { assert (HU : ulp radix2 fexp x = eta) by (apply ulp_FLT_small; [typeclasses eauto | exact S]).
    rewrite HU. lra. }
  assert (N : x <> 0).
  { intros Z0. rewrite Z0, Rabs_R0 in L. pose proof (bpow_gt_0 radix2 (emin + prec)). lra. }
  destruct (mag_prop_exists x N) as (e & Me & M1 & M2).
  assert (LE : (emin + prec <= e - 1)%Z).
  { cut (emin + prec < e)%Z; [lia |]. apply lt_bpow with radix2. exact (Rle_lt_trans _ _ _ L M2). }
  assert (HU : / 2 * ulp radix2 fexp x = bpow radix2 (e - 1 - prec)).
  { rewrite ulp_neq_0 by exact N. unfold cexp. rewrite Me. unfold rounding.fexp, FLT_exp. rewrite Z.max_l by lia.
    replace (e - 1 - prec)%Z with (-1 + (e - prec))%Z by lia. rewrite bpow_plus. simpl; lra. }
  rewrite HU. set (q := bpow radix2 (e - 1 - prec)) in *.
  assert (Q : q = u * bpow radix2 (e - 1)).
  { unfold q, u, rounding.u. rewrite <- bpow_plus. f_equal. lia. }
  assert (QP : q * (1 + 2 * u) <= phi * Rabs x).
  { rewrite Q. unfold phi. replace (u * bpow radix2 (e - 1) * (1 + 2 * u))
      with (u * (1 + 2 * u) * bpow radix2 (e - 1)) by ring. apply Rmult_le_compat_l; [nra | exact M1]. }
  assert (Qpos : 0 < q) by apply bpow_gt_0.
  destruct (Z_lt_le_dec (e - 1 - prec) (emin + prec - 1)) as [Sub | Nor].
  - (* q + eta is a number *)
    assert (A : q <= fl (phi * Rabs x)).
    { apply (fl_above prec emin); [nra |]. apply (power_number prec emin); lia. }
    assert (B : number (q + eta)).
    { replace (q + eta) with (IZR (2 ^ (e - 1 - prec - emin) + 1) * bpow radix2 emin).
      - apply (scaled_number prec emin); [| lia].
      rewrite Z.abs_eq by (pose proof (Z.pow_nonneg 2 (e - 1 - prec - emin)); lia).
        apply Z.le_lt_trans with (2 ^ (prec - 2) + 1)%Z.
        + apply Zplus_le_compat_r. apply Z.pow_le_mono_r; lia.
        + replace prec with (prec - 2 + 2)%Z at 2 by lia. rewrite Z.pow_add_r by lia.
          assert (2 ^ 1 <= 2 ^ (prec - 2))%Z by (apply Z.pow_le_mono_r; lia). lia.
      - rewrite plus_IZR, IZR_power by lia.
        rewrite Rmult_plus_distr_r, <- bpow_plus, Rmult_1_l. unfold q, eta, rounding.eta. f_equal. f_equal. lia. }
    apply Rlt_le_trans with (q + eta); [lra |]. apply (fl_above prec emin); [lra | exact B].
  - (* q (1 + 2u) is one *)
    assert (B : number (q * (1 + 2 * u))).
    { replace (q * (1 + 2 * u)) with (IZR (2 ^ (prec - 1) + 1) * bpow radix2 (e - 2 * prec)).
      - apply (scaled_number prec emin); [| lia]. rewrite Z.abs_eq by (pose proof (Z.pow_nonneg 2 (prec - 1)); lia).
        replace prec with (prec - 1 + 1)%Z at 2 by lia. rewrite Z.pow_add_r by lia.
        assert (2 ^ 1 <= 2 ^ (prec - 1))%Z by (apply Z.pow_le_mono_r; lia). lia.
      - replace (q * (1 + 2 * u)) with (bpow radix2 (e - 1) * phi) by (rewrite Q; unfold phi; ring).
        rewrite phi_scaled. replace (e - 2 * prec)%Z with (e - 1 + (1 - 2 * prec))%Z by lia. rewrite bpow_plus. ring. }
    assert (A : q * (1 + 2 * u) <= fl (phi * Rabs x)) by now apply (fl_above prec emin).
    apply Rlt_le_trans with (q * (1 + 2 * u)); [nra |]. apply Rle_trans with (1 := A).
    apply (fl_above prec emin); [lra | now apply (fl_number prec emin)].
Qed.

Lemma next_within_ulp x : number x -> Ulp.succ radix2 fexp x - x <= ulp radix2 fexp x.
Proof.
  intros F. destruct (Rle_or_lt 0 x) as [P | N].
  - rewrite succ_eq_pos by exact P. lra.
  - unfold Ulp.succ. rewrite Rle_bool_false by exact N. rewrite <- (Ropp_involutive x) at 2 3.
    rewrite ulp_opp. set (y := - x). assert (Y : 0 < y) by (unfold y; lra).
    assert (FY : number y) by (apply number_opp; exact F).
    pose proof (pred_plus_ulp radix2 fexp y Y FY) as H. rewrite pred_eq_pos in H by lra.
    assert (ulp radix2 fexp (pred_pos radix2 fexp y) <= ulp radix2 fexp y); [| lra].
    rewrite <- pred_eq_pos by lra. apply ulp_le; try typeclasses eauto.
    rewrite (Rabs_pos_eq y) by lra. rewrite Rabs_pos_eq by (apply pred_ge_0; [typeclasses eauto | exact Y | exact FY]).
    apply pred_le_id.
Qed.

Theorem succ_at_least_next x : number x -> Ulp.succ radix2 fexp x <= succ x.
Proof.
  intros F. unfold succ. apply round_N_ge_midp; [typeclasses eauto | |].
  - apply generic_format_succ; [typeclasses eauto | exact F].
  - rewrite pred_succ by (typeclasses eauto || exact F).
    pose proof (step_above_half_ulp x). pose proof (next_within_ulp x F). lra.
Qed.

Theorem below_succ_fl z : z <= succ (fl z).
Proof.
  apply Rle_trans with (Ulp.succ radix2 fexp (fl z)).
  - apply succ_round_ge_id; typeclasses eauto.
  - apply succ_at_least_next. now apply (fl_number prec emin).
Qed.

Lemma succ_number x : number (succ x).
Proof. now apply (fl_number prec emin). Qed.

Lemma succ_above x : number x -> x <= succ x.
Proof. intros F. pose proof (below_succ_fl x) as B. now rewrite (fl_id prec emin x F) in B. Qed.
End Successor.
