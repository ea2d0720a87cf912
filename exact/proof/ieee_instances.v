(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* Flocq's binary numbers, infinities and NaN fulfil the laws of ieee.v: binary64 and binary32. *)
From Coq Require Import Reals Lra Lia ZArith List Bool.
From Flocq Require Import Core BinarySingleNaN.
From CinchProof Require Import rounding successor model real_model ieee.
Open Scope R_scope.

Section Instance.
Variables prec emax : Z.
Context (prec_gt_0_ : FLX.Prec_gt_0 prec).
Context (prec_lt_emax_ : Prec_lt_emax prec emax).
Notation emin := (3 - emax - prec)%Z.
Context {format : Format prec emin}.
Notation fl := (fl prec emin).
Notation number := (number prec emin).
Notation binary := (binary_float prec emax).

Definition view (x : binary) : value :=
  match x with B754_nan => Nan | B754_infinity s => if s then Minus else Plus | _ => Finite (B2R x) end.

Definition binary_ops : ops binary := {|
  precision := prec; least := emin;
  constant := fun m e => binary_normalize prec emax _ _ mode_NE m e false;
  infinity := B754_infinity false;
  add := Bplus mode_NE;
  sub := Bminus mode_NE;
  mul := Bmult mode_NE;
  absolute := Babs;
  less := Bltb;
  less_equal := Bleb;
  divide := Bdiv mode_NE
|}.

Lemma view_finite x : is_finite x = true -> view x = Finite (B2R x).
Proof. destruct x; simpl; trivial; discriminate. Qed.
Lemma finite_of_view x r : view x = Finite r -> is_finite x = true /\ B2R x = r.
Proof. destruct x as [s | [] | | s m e B]; simpl; try discriminate; intros [= <-]; auto. Qed.
Lemma infinity_of_spec (x : binary) s : B2SF x = SpecFloat.S754_infinity s -> x = B754_infinity s.
Proof. destruct x; simpl; try discriminate. now intros [= ->]. Qed.

Lemma beyond z x : bpow radix2 emax <= Rabs z -> forall c, view x = Finite c -> Rabs c < Rabs z.
Proof.
  intros B c V. apply finite_of_view in V. destruct V as [_ <-].
  apply Rlt_le_trans with (2 := B). apply abs_B2R_lt_emax.
Qed.

Lemma sign_negative (x : binary) : Bsign x = true -> is_finite x = true -> B2R x <= 0.
Proof.
  destruct x as [s | s | | s m e B]; simpl; try discriminate; intros; [lra |]. subst s.
  apply F2R_le_0. simpl. lia.
Qed.
Lemma sign_positive (x : binary) : Bsign x = false -> is_finite x = true -> 0 <= B2R x.
Proof.
  destruct x as [s | s | | s m e B]; simpl; try discriminate; intros; [lra |]. subst s.
  apply F2R_ge_0. simpl. lia.
Qed.

Lemma add_law x y a b : view x = Finite a -> view y = Finite b ->
  view (Bplus mode_NE x y) = Finite (fl (a + b)) \/
  ((forall z c, view z = Finite c -> Rabs c < Rabs (fl (a + b))) /\
   view (Bplus mode_NE x y) = if Rlt_bool (a + b) 0 then Minus else Plus).
Proof.
  intros X Y. apply finite_of_view in X, Y. destruct X as [FX <-]. destruct Y as [FY <-].
  pose proof (Bplus_correct prec emax _ _ mode_NE x y FX FY) as H.
  change (round radix2 (SpecFloat.fexp prec emax) (round_mode mode_NE)) with fl in H.
  revert H. case Rlt_bool_spec; intros L H.
  - left. destruct H as (V & F & _). rewrite view_finite by exact F. now rewrite V.
  - right. destruct H as (V & S). simpl in V. apply infinity_of_spec in V. split; [intros z; now apply beyond |].
    rewrite V. simpl.
    assert (N : B2R x + B2R y <> 0).
    { intros Z0. rewrite Z0, (fl_0 prec emin), Rabs_R0 in L. pose proof (bpow_gt_0 radix2 emax). lra. }
    destruct (Bsign x) eqn:SX.
    + pose proof (sign_negative x SX FX). pose proof (sign_negative y (eq_sym S) FY).
      now rewrite Rlt_bool_true by lra.
    + pose proof (sign_positive x SX FX). pose proof (sign_positive y (eq_sym S) FY).
      now rewrite Rlt_bool_false by lra.
Qed.

Lemma view_opposite y b : view y = Finite b -> view (Bopp y) = Finite (- b).
Proof.
  intros Y. apply finite_of_view in Y. destruct Y as [F <-].
  rewrite view_finite by now rewrite is_finite_Bopp. now rewrite B2R_Bopp.
Qed.

Lemma minus_is_plus (x y : binary) : Bminus mode_NE x y = Bplus mode_NE x (Bopp y).
Proof. destruct x, y; reflexivity. Qed.

Lemma sub_law x y a b : view x = Finite a -> view y = Finite b ->
  view (Bminus mode_NE x y) = Finite (fl (a - b)) \/
  ((forall z c, view z = Finite c -> Rabs c < Rabs (fl (a - b))) /\
   view (Bminus mode_NE x y) = if Rlt_bool (a - b) 0 then Minus else Plus).
Proof. intros X Y. rewrite minus_is_plus. apply add_law; [exact X | now apply view_opposite]. Qed.

Lemma mul_law x y a b : view x = Finite a -> view y = Finite b ->
  view (Bmult mode_NE x y) = Finite (fl (a * b)) \/
  ((forall z c, view z = Finite c -> Rabs c < Rabs (fl (a * b))) /\
   view (Bmult mode_NE x y) = if xorb (Bsign x) (Bsign y) then Minus else Plus).
Proof.
  intros X Y. apply finite_of_view in X, Y. destruct X as [FX <-]. destruct Y as [FY <-].
  pose proof (Bmult_correct prec emax _ _ mode_NE x y) as H.
  change (round radix2 (SpecFloat.fexp prec emax) (round_mode mode_NE)) with fl in H.
  revert H. case Rlt_bool_spec; intros L H.
  - left. destruct H as (V & F & _). rewrite FX, FY in F. rewrite view_finite by exact F. now rewrite V.
  - right. simpl in H. apply infinity_of_spec in H. split; [intros z; now apply beyond |]. rewrite H. reflexivity.
Qed.

Lemma divide_law x y a b : view x = Finite a -> view y = Finite b -> b <> 0 ->
  view (Bdiv mode_NE x y) = Finite (fl (a / b)) \/
  (forall z c, view z = Finite c -> Rabs c < Rabs (fl (a / b))).
Proof.
  intros X Y N. apply finite_of_view in X, Y. destruct X as [FX <-]. destruct Y as [FY <-].
  pose proof (Bdiv_correct prec emax _ _ mode_NE x y N) as H.
  change (round radix2 (SpecFloat.fexp prec emax) (round_mode mode_NE)) with fl in H.
  revert H. case Rlt_bool_spec; intros L H.
  - left. destruct H as (V & F & _). rewrite FX in F. rewrite view_finite by exact F. now rewrite V.
  - right. intros z. now apply beyond.
Qed.

Lemma add_finite x y r : view (Bplus mode_NE x y) = Finite r ->
  exists a b, view x = Finite a /\ view y = Finite b /\ r = fl (a + b).
Proof.
  intros V.
  assert (F : is_finite x = true /\ is_finite y = true).
  { destruct x as [s | [] | | s m e B], y as [t | [] | | t n f C]; simpl in V; try discriminate; now split. }
  destruct F as [FX FY]. exists (B2R x), (B2R y).
  split; [now apply view_finite |]. split; [now apply view_finite |].
  destruct (add_law x y _ _ (view_finite x FX) (view_finite y FY)) as [E | [_ E]]; rewrite E in V.
  - now injection V.
  - destruct Rlt_bool; discriminate.
Qed.

Lemma sub_finite x y r : view (Bminus mode_NE x y) = Finite r ->
  exists a b, view x = Finite a /\ view y = Finite b /\ r = fl (a - b).
Proof.
  intros V. rewrite minus_is_plus in V. destruct (add_finite _ _ _ V) as (a & b & A & B & E).
  exists a, (- b). split; [exact A |]. split; [| rewrite E; f_equal; ring].
  rewrite <- (Bopp_involutive _ _ y). now apply view_opposite.
Qed.

Lemma mul_finite x y r : view (Bmult mode_NE x y) = Finite r ->
  exists a b, view x = Finite a /\ view y = Finite b /\ r = fl (a * b).
Proof.
  intros V.
  assert (F : is_finite x = true /\ is_finite y = true).
  { destruct x as [s | [] | | s m e B], y as [t | [] | | t n f C]; simpl in V; try discriminate; try (now split);
      try (destruct s; discriminate); try (destruct t; discriminate). }
  destruct F as [FX FY]. exists (B2R x), (B2R y).
  split; [now apply view_finite |]. split; [now apply view_finite |].
  destruct (mul_law x y _ _ (view_finite x FX) (view_finite y FY)) as [E | [_ E]]; rewrite E in V.
  - now injection V.
  - destruct xorb; discriminate.
Qed.

Lemma nonnegative_cases x : nonnegative (view x) ->
  x = B754_nan \/ x = B754_infinity false \/ (is_finite x = true /\ 0 <= B2R x).
Proof. destruct x as [s | [] | | s m e B]; simpl; intros N; try contradiction; auto.
Qed.

Lemma add_nonnegative x y :
  nonnegative (view x) -> nonnegative (view y) -> nonnegative (view (Bplus mode_NE x y)).
Proof.
  intros X Y. apply nonnegative_cases in X, Y.
  destruct X as [-> | [-> | [FX PX]]].
  - destruct y as [| [] | |]; exact Logic.I.
  - destruct Y as [-> | [-> | [FY PY]]]; try exact Logic.I. destruct y as [| [] | |]; try exact Logic.I; discriminate.
  - destruct Y as [-> | [-> | [FY PY]]].
    + destruct x; try exact Logic.I; discriminate.
    + destruct x as [| [] | |]; try exact Logic.I; discriminate.
    + destruct (add_law x y _ _ (view_finite x FX) (view_finite y FY)) as [-> | [_ ->]].
      * apply (fl_nonnegative prec emin). lra.
      * rewrite Rlt_bool_false by lra. exact Logic.I.
Qed.

Lemma mul_nonnegative x y :
  nonnegative (view x) -> nonnegative (view y) -> nonnegative (view (Bmult mode_NE x y)).
Proof.
  intros X Y.
  destruct (view (Bmult mode_NE x y)) eqn:V; try exact Logic.I.
  - destruct (mul_finite _ _ _ V) as (a & b & A & B & ->). rewrite A in X. rewrite B in Y.
    apply (fl_nonnegative prec emin). now apply Rmult_le_pos.
  - (* -infinity needs operands of different signs that are not 0 *)
    exfalso. apply nonnegative_cases in X, Y.
    assert (S : forall z : binary, z = B754_infinity false \/ (is_finite z = true /\ 0 <= B2R z) ->
                (exists s, z = B754_zero s) \/ Bsign z = false).
    { intros z [-> | [F P]]; [now right |]. destruct z as [s | s | | s m e B]; try discriminate; [left; now exists s |].
      right. destruct s; [| reflexivity]. exfalso. simpl in P.
      pose proof (F2R_lt_0 radix2 (Float radix2 (Z.neg m) e) (Pos2Z.neg_is_neg m)). simpl in H. lra. }
    destruct X as [-> | X]; [destruct y; discriminate |].
    destruct Y as [-> | Y]; [destruct x; discriminate |].
    destruct (S x X) as [[s ->] | SX]; [destruct y as [| [] | |]; discriminate |].
    destruct (S y Y) as [[t ->] | SY]; [destruct x as [| [] | |]; discriminate |].
    destruct X as [-> | [FX PX]].
    + destruct y as [| t | | t n f C]; simpl in *; try subst t; discriminate.
    + destruct Y as [-> | [FY PY]].
      * destruct x as [| s | | s m e B]; simpl in *; try subst s; discriminate.
      * destruct (mul_law x y _ _ (view_finite x FX) (view_finite y FY)) as [E | [_ E]]; rewrite E in V;
          [discriminate |]. rewrite SX, SY in V. discriminate.
Qed.

Lemma add_minus x y : view (Bplus mode_NE x y) = Minus -> view y <> Plus /\ view y <> Nan.
Proof.
  destruct x as [s | [] | | s m e B], y as [t | [] | | t n f C]; simpl; try discriminate;
    intros V; split; intros W; try discriminate; destruct s; discriminate.
Qed.

Theorem binary_ieee : ieee prec emin binary_ops view.
Proof.
  constructor; try reflexivity.
  - intros x r V. apply finite_of_view in V. destruct V as [_ <-]. apply generic_format_B2R.
  - intros m e M E. simpl.
    pose proof (binary_normalize_correct prec emax _ _ mode_NE m e false) as H. cbv zeta in H.
    change (round radix2 (SpecFloat.fexp prec emax) (round_mode mode_NE)) with fl in H.
    assert (N : F2R (Float radix2 m e) = IZR m * bpow radix2 e) by reflexivity.
    rewrite N in H. rewrite (fl_id prec emin) in H by (apply (scaled_number prec emin); [exact M | lia]).
    rewrite Rlt_bool_true in H.
    + destruct H as (V & F & _). rewrite view_finite by exact F. now rewrite V.
    + rewrite Rabs_mult, (Rabs_pos_eq (bpow radix2 e)) by apply bpow_ge_0. rewrite <- abs_IZR.
      apply Rle_lt_trans with (IZR (Z.abs m) * bpow radix2 0).
      * apply Rmult_le_compat_l; [apply IZR_le; lia | apply bpow_le; lia].
      * simpl (bpow radix2 0). rewrite Rmult_1_r. apply Rlt_le_trans with (bpow radix2 prec).
        -- rewrite <- IZR_power by (unfold FLX.Prec_gt_0 in prec_gt_0_; lia). now apply IZR_lt.
        -- apply bpow_le. unfold Prec_lt_emax in prec_lt_emax_. lia.
  - intros e E. cbn [constant binary_ops].
    pose proof (binary_normalize_correct prec emax _ _ mode_NE 1 e false) as H. cbv zeta in H.
    change (round radix2 (SpecFloat.fexp prec emax) (round_mode mode_NE)) with fl in H.
    assert (N : F2R (Float radix2 1 e) = 1 * bpow radix2 e) by reflexivity.
    pose proof (@prec_large prec emin format) as PL.
    assert (P1 : (Z.abs 1 < 2 ^ prec)%Z).
    { change (Z.abs 1) with 1%Z. apply Z.lt_le_trans with (2 ^ 24)%Z; [reflexivity | apply Z.pow_le_mono_r; lia]. }
    pose proof (@emin_small prec emin format) as ES.
    rewrite N in H. rewrite (fl_id prec emin) in H by (apply (scaled_number prec emin); [exact P1 | lia]).
    rewrite Rlt_bool_true in H.
    + destruct H as (V & F & _). rewrite view_finite by exact F. now rewrite V.
    + rewrite Rmult_1_l, Rabs_pos_eq by apply bpow_ge_0. apply bpow_lt. lia.
  - exact add_law.
  - exact sub_law.
  - intros x y a b X Y. destruct (mul_law x y a b X Y) as [H | [H _]]; [now left | now right].
  - exact divide_law.
  - exact add_finite.
  - exact sub_finite.
  - exact mul_finite.
  - exact add_nonnegative.
  - exact mul_nonnegative.
  - exact add_minus.
  - intros x. destruct x as [s | [] | | s m e B]; simpl; try reflexivity.
    + now rewrite Rabs_R0.
    + f_equal. rewrite <- F2R_Zabs. now destruct s.
  - intros x y. unfold binary_ops, less.
    destruct (is_finite x) eqn:FX.
    + destruct (is_finite y) eqn:FY.
      * rewrite Bltb_correct by assumption. now rewrite !view_finite by assumption.
      * destruct x as [s | [] | | s m e B], y as [t | [] | | t n f C]; try discriminate; try reflexivity; destruct s;
        reflexivity.
    + destruct x as [s | [] | | s m e B], y as [t | [] | | t n f C]; try discriminate; try reflexivity; destruct t;
      reflexivity.
  - intros x y. unfold binary_ops, less_equal.
    destruct (is_finite x) eqn:FX.
    + destruct (is_finite y) eqn:FY.
      * rewrite Bleb_correct by assumption. now rewrite !view_finite by assumption.
      * destruct x as [s | [] | | s m e B], y as [t | [] | | t n f C]; try discriminate; try reflexivity;
          destruct s; reflexivity.
    + destruct x as [s | [] | | s m e B], y as [t | [] | | t n f C]; try discriminate; try reflexivity;
        destruct t; reflexivity.
Qed.
End Instance.

(* double and float. *)
#[global] Instance prec_53 : FLX.Prec_gt_0 53. Proof. reflexivity. Qed.
#[global] Instance prec_24 : FLX.Prec_gt_0 24. Proof. reflexivity. Qed.
#[global] Instance emax_1024 : Prec_lt_emax 53 1024. Proof. reflexivity. Qed.
#[global] Instance emax_128 : Prec_lt_emax 24 128. Proof. reflexivity. Qed.

Definition binary64_ops := binary_ops 53 1024 prec_53 emax_1024.
Definition binary32_ops := binary_ops 24 128 prec_24 emax_128.
Definition binary64_ieee : ieee 53 (-1074) binary64_ops (view 53 1024) := binary_ieee 53 1024 prec_53 emax_1024.
Definition binary32_ieee : ieee 24 (-149) binary32_ops (view 24 128) := binary_ieee 24 128 prec_24 emax_128.
