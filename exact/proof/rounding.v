(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* Rounding to nearest even with gradual underflow, of any precision and least exponent, and the next number above
   (succ of toolkit/bounds/rounding.hpp). *)
From Coq Require Import Reals Lra Lia ZArith.
From Flocq Require Import Core Relative Plus_error.
Open Scope R_scope.

(* A binary format: numbers m 2^e with |m| < 2^prec and e >= emin. *)
Class Format (prec emin : Z) := {
  prec_large : (24 <= prec)%Z;
  emin_small : (emin <= - 3 * prec)%Z
}.

#[global] Instance binary64_format : Format 53 (-1074).
Proof. split; lia. Qed.
#[global] Instance binary32_format : Format 24 (-149).
Proof. split; lia. Qed.

Lemma IZR_power e : (0 <= e)%Z -> IZR (2 ^ e) = bpow radix2 e.
Proof. exact (IZR_Zpower radix2 e). Qed.

Section Rounding.
Variables prec emin : Z.
Context {format : Format prec emin}.

#[global] Instance prec_positive : Prec_gt_0 prec.
Proof. unfold Prec_gt_0. pose proof prec_large. lia. Qed.

Definition fexp := FLT_exp emin prec.
Definition fl : R -> R := round radix2 fexp ZnearestE.
Definition number : R -> Prop := generic_format radix2 fexp.
(* u and eta of rounding.hpp. *)
Definition u : R := bpow radix2 (- prec).
Definition eta : R := bpow radix2 emin.

#[global] Instance fexp_valid : Valid_exp fexp := FLT_exp_valid emin prec.
#[global] Instance fexp_monotone : Monotone_exp fexp := FLT_exp_monotone emin prec.

Lemma u_positive : 0 < u. Proof. apply bpow_gt_0. Qed.
Lemma eta_positive : 0 < eta. Proof. apply bpow_gt_0. Qed.
Lemma u_small : u <= / 16777216.
Proof.
  unfold u. replace (/ 16777216) with (bpow radix2 (-24)) by (simpl; lra).
  apply bpow_le. pose proof prec_large. lia.
Qed.

Lemma fl_number x : number (fl x). Proof. apply generic_format_round; typeclasses eauto. Qed.
Lemma fl_id x : number x -> fl x = x. Proof. intros F. apply round_generic; [typeclasses eauto | exact F]. Qed.
Lemma fl_le x y : x <= y -> fl x <= fl y. Proof. intros L. apply round_le; [typeclasses eauto .. | exact L]. Qed.
Lemma fl_0 : fl 0 = 0. Proof. apply round_0. typeclasses eauto. Qed.
Lemma fl_opp x : fl (- x) = - fl x. Proof. apply round_NE_opp. Qed.
Lemma fl_abs x : fl (Rabs x) = Rabs (fl x). Proof. apply round_NE_abs; typeclasses eauto. Qed.
Lemma fl_nonnegative x : 0 <= x -> 0 <= fl x. Proof. intros P. rewrite <- fl_0. now apply fl_le. Qed.
Lemma number_0 : number 0. Proof. apply generic_format_0. Qed.
Lemma number_opp x : number x -> number (- x). Proof. apply generic_format_opp. Qed.
Lemma number_abs x : number x -> number (Rabs x). Proof. apply generic_format_abs. Qed.
Lemma fl_below x y : x <= y -> number y -> fl x <= y.
Proof. intros L F. rewrite <- (fl_id y F). now apply fl_le. Qed.
Lemma fl_above x y : x <= y -> number x -> x <= fl y.
Proof. intros L F. rewrite <- (fl_id x F). now apply fl_le. Qed.

Lemma ulp_below x : / 2 * ulp radix2 fexp x <= u * Rabs x + eta / 2.
Proof.
  pose proof u_positive. pose proof (Rabs_pos x). pose proof eta_positive.
  destruct (Rle_or_lt (bpow radix2 (emin + prec - 1)) (Rabs x)) as [L | S].
  - pose proof (ulp_FLT_le radix2 emin prec x L) as B. fold fexp in B.
    unfold Z.sub in B. rewrite bpow_plus in B. fold u in B. change (bpow radix2 1) with 2 in B. nra.
  - assert (E : ulp radix2 fexp x = eta); [| rewrite E; nra].
    apply ulp_FLT_small; [typeclasses eauto |]. apply Rlt_trans with (1 := S). apply bpow_lt. lia.
Qed.

(* Any rounding, against the result. *)
Lemma fl_error_result z : Rabs (fl z - z) <= u * Rabs (fl z) + eta / 2.
Proof.
  apply Rle_trans with (/ 2 * ulp radix2 fexp (fl z)); [| apply ulp_below].
  apply error_le_half_ulp_round; typeclasses eauto.
Qed.

(* Any rounding, against what is rounded. *)
Lemma fl_error z : Rabs (fl z - z) <= u * Rabs z + eta / 2.
Proof.
  apply Rle_trans with (/ 2 * ulp radix2 fexp z); [| apply ulp_below].
  apply error_le_half_ulp; typeclasses eauto.
Qed.

(* u_ro of Flocq is u. *)
Lemma u_ro_u : u_ro radix2 prec = u.
Proof.
  unfold u_ro, u. replace (- prec + 1)%Z with (1 + - prec)%Z by ring. rewrite bpow_plus.
  change (bpow radix2 1) with 2. lra.
Qed.

(* Sums do not underflow. *)
Lemma fl_plus_error_result x y :
  number x -> number y -> Rabs (fl (x + y) - (x + y)) <= u * Rabs (fl (x + y)).
Proof.
  intros X Y.
  destruct (FLT_plus_error_N_round_ex radix2 emin prec (fun n => negb (Z.even n)) x y X Y) as (d & D & E).
  fold fexp in E. fold ZnearestE in E. fold fl in E. rewrite u_ro_u in D. rewrite E at 2.
  replace (fl (x + y) - fl (x + y) * (1 + d)) with (- (d * fl (x + y))) by ring.
  rewrite Rabs_Ropp, Rabs_mult. apply Rmult_le_compat_r; [apply Rabs_pos | exact D].
Qed.

Lemma fl_plus_error x y : number x -> number y -> Rabs (fl (x + y) - (x + y)) <= u * Rabs (x + y).
Proof.
  intros X Y.
  destruct (FLT_plus_error_N_ex radix2 emin prec (fun n => negb (Z.even n)) x y X Y) as (d & D & E).
  fold fexp in E. fold ZnearestE in E. fold fl in E. rewrite u_ro_u in D. rewrite E.
  replace ((x + y) * (1 + d) - (x + y)) with (d * (x + y)) by ring.
  rewrite Rabs_mult. apply Rmult_le_compat_r; [apply Rabs_pos |].
  apply Rle_trans with (1 := D). pose proof u_positive.
  apply Rmult_le_reg_r with (1 + u); [lra |]. unfold Rdiv. rewrite Rmult_assoc, Rinv_l by lra. nra.
Qed.

Lemma power_number e : (emin <= e)%Z -> number (bpow radix2 e).
Proof.
  intros E. apply generic_format_bpow. unfold fexp, FLT_exp. pose proof prec_large. lia.
Qed.

Lemma scaled_number m e : (Z.abs m < 2 ^ prec)%Z -> (emin <= e)%Z -> number (IZR m * bpow radix2 e).
Proof.
  intros M E. apply generic_format_FLT. exists (Float radix2 m e); simpl; [reflexivity | exact M | exact E].
Qed.

Lemma integer_number m : (Z.abs m < 2 ^ prec)%Z -> number (IZR m).
Proof.
  intros M. replace (IZR m) with (IZR m * bpow radix2 0) by (simpl; ring). apply scaled_number; [exact M |].
  pose proof prec_large. pose proof emin_small. lia.
Qed.

Lemma u_number : number u.
Proof. apply power_number. pose proof prec_large. pose proof emin_small. lia. Qed.
Lemma eta_number : number eta.
Proof. apply power_number. lia. Qed.
End Rounding.
