(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* Units are the real values; `rounded` is the rounding of binary64. *)
From Coq Require Import ZArith List Bool Reals Lia Lra.
From Flocq Require Import Core.
From CinchChecker Require Import content statement numbers.
Import ListNotations.
Open Scope R_scope.

(* n in units of 2 ^ -k *)
Definition in_units (k n : Z) : R := IZR n * bpow radix2 (- k).

Lemma in_units_0 k : in_units k 0 = 0.
Proof. unfold in_units. ring. Qed.

Lemma in_units_add k m n : in_units k (m + n) = in_units k m + in_units k n.
Proof. unfold in_units. rewrite plus_IZR. ring. Qed.

Lemma in_units_mul j k m n : in_units (j + k) (m * n) = in_units j m * in_units k n.
Proof.
  unfold in_units. rewrite mult_IZR, Z.opp_add_distr, bpow_plus. ring.
Qed.

Lemma in_units_scale k a n : in_units k (a * n) = IZR a * in_units k n.
Proof. unfold in_units. rewrite mult_IZR. ring. Qed.

Lemma in_units_le k m n : (m <= n)%Z <-> in_units k m <= in_units k n.
Proof.
  unfold in_units. pose proof (bpow_gt_0 radix2 (- k)). split; intro L.
  - apply Rmult_le_compat_r; [lra | now apply IZR_le].
  - apply le_IZR. now apply Rmult_le_reg_r with (bpow radix2 (- k)).
Qed.

Lemma in_units_max k m n : in_units k (Z.max m n) = Rmax (in_units k m) (in_units k n).
Proof.
  destruct (Z.max_spec m n) as [[L ->] | [L ->]].
  - rewrite Rmax_right; [easy |]. apply in_units_le. lia.
  - rewrite Rmax_left; [easy |]. apply in_units_le. lia.
Qed.

Lemma IZR_shiftl n s : (0 <= s)%Z -> IZR (Z.shiftl n s) = IZR n * bpow radix2 s.
Proof.
  intro L. rewrite Z.shiftl_mul_pow2 by easy. rewrite mult_IZR. f_equal. now apply (IZR_Zpower radix2).
Qed.

Lemma units_value k d : (0 <= exn d + k)%Z -> in_units k (units k d) = value d.
Proof.
  intro L. unfold in_units, units, value. rewrite IZR_shiftl by easy. rewrite Rmult_assoc, <- bpow_plus.
  do 2 f_equal. lia.
Qed.

Lemma finest_start l : forall k, (k <= finest k l)%Z.
Proof.
  induction l as [| d l IH]; intro k; cbn; [lia |]. specialize (IH (Z.max k (- exn d))). unfold finest in IH. lia.
Qed.

Lemma finest_enough l : forall k d, In d l -> (0 <= exn d + finest k l)%Z.
Proof.
  induction l as [| e l IH]; intros k d I; [easy |]. destruct I as [-> | I]; cbn.
  - pose proof (finest_start l (Z.max k (- exn d))). unfold finest in H. lia.
  - now apply IH.
Qed.

(* ---- Doubles ---- *)

Lemma log2_digits n : n <> 0%Z -> Zdigits radix2 n = (Z.log2 (Z.abs n) + 1)%Z.
Proof.
  intro N. apply Zdigits_unique.
  assert (0 < Z.abs n)%Z as P by lia.
  pose proof (Z.log2_spec (Z.abs n) P). pose proof (Z.log2_nonneg (Z.abs n)).
  replace (Z.log2 (Z.abs n) + 1 - 1)%Z with (Z.log2 (Z.abs n)) by ring.
  rewrite <- Z.add_1_r in H. cbn [radix_val radix2]. lia.
Qed.

Lemma abs_lt_bpow n e : (0 <= e)%Z -> Rabs (IZR n) < bpow radix2 e <-> (Z.log2 (Z.abs n) < e \/ n = 0)%Z.
Proof.
  intro E. rewrite <- abs_IZR, <- (IZR_Zpower radix2) by easy. cbn [radix_val radix2].
  destruct (Z.eq_dec n 0) as [-> | N].
  - split; [now right |]. intros _. apply IZR_lt. apply Z.pow_pos_nonneg; lia.
  - assert (0 < Z.abs n)%Z as P by lia. split; intro L.
    + left. apply lt_IZR in L. now apply Z.log2_lt_pow2.
    + destruct L as [L | L]; [| easy]. apply IZR_lt. now apply Z.log2_lt_pow2.
Qed.

Lemma value_F2R d : value d = F2R (Float radix2 (man d) (exn d)).
Proof. reflexivity. Qed.

Lemma is_double_sound d : is_double d = true -> binary64 d.
Proof.
  unfold is_double, most_low_bits, subnormal_bits, overflow_bits, one_weight.
  rewrite !andb_true_iff, !Z.ltb_lt, Z.leb_le.
  intros [[[M L] U] T]. split.
  - apply generic_format_FLT. exists (Float radix2 (man d) (exn d)); cbn; [reflexivity | | lia].
    exact M.
  - unfold value. rewrite Rabs_mult, (Rabs_pos_eq (bpow _ _)) by apply bpow_ge_0.
    replace (bpow radix2 1024) with (bpow radix2 (1024 - exn d) * bpow radix2 (exn d)).
    + apply Rmult_lt_compat_r; [apply bpow_gt_0 |]. apply abs_lt_bpow; lia.
    + rewrite <- bpow_plus. f_equal. lia.
Qed.

Lemma is_weight_sound d : is_weight d = true ->
  binary64 d /\ value d = in_units weight_bits (units weight_bits d) /\ (1 <= units weight_bits d)%Z.
Proof.
  unfold is_weight. cbv zeta. rewrite !andb_true_iff, !Z.leb_le. intros [[D E] [L U]].
  split; [now apply is_double_sound |]. split; [| easy]. symmetry. apply units_value. lia.
Qed.

Lemma at_least_sound d k n : at_least d k n = true <-> in_units k n <= value d.
Proof.
  unfold at_least, in_units, value.
  destruct (Z.leb_spec 0 (exn d + k)) as [L | L]; rewrite Z.leb_le.
  - assert (IZR (man d) * bpow radix2 (exn d) = IZR (Z.shiftl (man d) (exn d + k)) * bpow radix2 (- k)) as ->.
    { rewrite IZR_shiftl, Rmult_assoc, <- bpow_plus by easy. do 2 f_equal. lia. }
    pose proof (bpow_gt_0 radix2 (- k)). split; intro G.
    + apply Rmult_le_compat_r; [lra | now apply IZR_le].
    + apply le_IZR. now apply Rmult_le_reg_r with (bpow radix2 (- k)).
  - assert (IZR n * bpow radix2 (- k) = IZR (Z.shiftl n (- (exn d + k))) * bpow radix2 (exn d)) as ->.
    { rewrite IZR_shiftl, Rmult_assoc, <- bpow_plus by lia. do 2 f_equal. lia. }
    pose proof (bpow_gt_0 radix2 (exn d)). split; intro G.
    + apply Rmult_le_compat_r; [lra | now apply IZR_le].
    + apply le_IZR. now apply Rmult_le_reg_r with (bpow radix2 (exn d)).
Qed.

(* ---- Rounding ---- *)

Notation exponents := (FLT_exp (-1074) 53).

Definition rounded_in_units (s n : Z) : Z :=
  let q := Z.shiftr n s in
  match Z.compare (n - Z.shiftl q s) (Z.shiftl 1 (s - 1)) with
  | Lt => Z.shiftl q s
  | Gt => Z.shiftl (q + 1) s
  | Eq => if Z.even q then Z.shiftl q s else Z.shiftl (q + 1) s
  end.

Lemma nearest_even_shift n s : (0 < s)%Z ->
  rounded_in_units s n = (ZnearestE (IZR n * bpow radix2 (- s)) * 2 ^ s)%Z.
Proof.
  intro S. unfold rounded_in_units. cbv zeta.
  rewrite Z.shiftr_div_pow2 by lia. rewrite !Z.shiftl_mul_pow2 by lia. rewrite Z.mul_1_l.
  set (q := (n / 2 ^ s)%Z). set (r := (n - q * 2 ^ s)%Z).
  assert (0 < 2 ^ s)%Z as P by (apply Z.pow_pos_nonneg; lia).
  assert (0 <= r < 2 ^ s)%Z as R.
  { unfold r, q. pose proof (Z.div_mod n (2 ^ s)). pose proof (Z.mod_pos_bound n (2 ^ s)). lia. }
  assert (IZR n * bpow radix2 (- s) = IZR q + IZR r * bpow radix2 (- s)) as X.
  { replace n with (q * 2 ^ s + r)%Z by (unfold r; ring). rewrite plus_IZR, mult_IZR.
    rewrite (IZR_Zpower radix2) by lia. rewrite Rmult_plus_distr_r. f_equal.
    rewrite Rmult_assoc, <- bpow_plus, Z.add_opp_diag_r. cbn. ring. }
  assert (bpow radix2 (- s) * IZR (2 ^ s) = 1) as U.
  { rewrite (IZR_Zpower radix2) by lia. rewrite <- bpow_plus, Z.add_opp_diag_l. reflexivity. }
  pose proof (bpow_gt_0 radix2 (- s)) as B.
  assert (0 <= IZR r * bpow radix2 (- s) < 1) as F.
  { split.
    - apply Rmult_le_pos; [now apply IZR_le | lra].
    - rewrite <- U, Rmult_comm. apply Rmult_lt_compat_l; [easy | now apply IZR_lt]. }
  rewrite X. set (f := IZR r * bpow radix2 (- s)) in *.
  assert (Zfloor (IZR q + f) = q) as Fl by (apply Zfloor_imp; rewrite plus_IZR; lra).
  assert ((2 ^ s)%Z = (2 * 2 ^ (s - 1))%Z) as Half.
  { rewrite <- Z.pow_succ_r by lia. f_equal. lia. }
  assert (f - / 2 = IZR (r - 2 ^ (s - 1)) * bpow radix2 (- s)) as C.
  { unfold f. rewrite minus_IZR, Rmult_minus_distr_r. f_equal.
    rewrite Half, mult_IZR in U. lra. }
  unfold Znearest. rewrite Fl. replace (IZR q + f - IZR q) with f by ring.
  destruct (Z.compare_spec r (2 ^ (s - 1))) as [E | L | G].
  - rewrite Rcompare_Eq.
    + rewrite E, Z.sub_diag in C.
      assert (Zceil (IZR q + f) = q + 1)%Z as ->.
      { apply Zceil_imp. replace (q + 1 - 1)%Z with q by ring. rewrite plus_IZR. lra. }
      destruct (Z.even q); reflexivity.
    + rewrite E, Z.sub_diag in C. lra.
  - rewrite Rcompare_Lt; [reflexivity |].
    assert (IZR (r - 2 ^ (s - 1)) < 0) as N by (apply IZR_lt; lia). nra.
  - rewrite Rcompare_Gt.
    + assert (Zceil (IZR q + f) = q + 1)%Z as ->; [| reflexivity].
      apply Zceil_imp. replace (q + 1 - 1)%Z with q by ring. rewrite plus_IZR.
      assert (0 < IZR (r - 2 ^ (s - 1))) as N by (apply IZR_lt; lia). nra.
    + assert (0 < IZR (r - 2 ^ (s - 1))) as N by (apply IZR_lt; lia). nra.
Qed.

Lemma rounded_value k n :
  let s := Z.max (Z.log2 (Z.abs n) - most_low_bits) (k - subnormal_bits) in
  in_units k (if (s <=? 0)%Z then n else rounded_in_units s n) =
  round radix2 exponents ZnearestE (in_units k n).
Proof.
  cbv zeta. unfold most_low_bits, subnormal_bits. set (s := Z.max _ _).
  destruct (Z.eq_dec n 0) as [-> | N].
  { rewrite in_units_0, round_0 by typeclasses eauto.
    destruct (Z.leb_spec s 0); [apply in_units_0 |]. rewrite nearest_even_shift by easy.
    rewrite Rmult_0_l, (Zrnd_IZR ZnearestE 0). apply in_units_0. }
  assert (cexp radix2 exponents (in_units k n) = s - k)%Z as E.
  { unfold cexp. change (in_units k n) with (F2R (Float radix2 n (- k))). rewrite mag_F2R_Zdigits by easy.
    rewrite log2_digits by easy. unfold FLT_exp. lia. }
  destruct (Z.leb_spec s 0) as [L | L].
  - symmetry. apply round_generic; [typeclasses eauto |].
    change (in_units k n) with (F2R (Float radix2 n (- k))) in *. apply generic_format_F2R. intros _. rewrite E. lia.
  - rewrite nearest_even_shift by easy. unfold round, F2R, scaled_mantissa. cbn [Fnum Fexp]. rewrite E.
    assert (in_units k n * bpow radix2 (- (s - k)) = IZR n * bpow radix2 (- s)) as ->.
    { unfold in_units. rewrite Rmult_assoc, <- bpow_plus. do 2 f_equal. lia. }
    unfold in_units. rewrite mult_IZR, (IZR_Zpower radix2) by lia. rewrite Rmult_assoc, <- bpow_plus.
    do 2 f_equal; lia.
Qed.

Theorem rounded_is_fl k n : (0 <= k)%Z -> option_map (in_units k) (rounded k n) = fl (in_units k n).
Proof.
  intro K. unfold rounded, fl. cbv zeta. rewrite <- rounded_value. cbv zeta.
  fold (rounded_in_units (Z.max (Z.log2 (Z.abs n) - most_low_bits) (k - subnormal_bits)) n).
  set (m := if (_ <=? 0)%Z then n else _).
  assert ((Z.log2 (Z.abs m) < 1024 + k)%Z <-> Rabs (in_units k m) < bpow radix2 1024) as E.
  { unfold in_units. rewrite Rabs_mult, (Rabs_pos_eq (bpow _ _)) by apply bpow_ge_0.
    replace (bpow radix2 1024) with (bpow radix2 (1024 + k) * bpow radix2 (- k))
      by (rewrite <- bpow_plus; f_equal; ring).
    pose proof (bpow_gt_0 radix2 (- k)) as P.
    assert (Rabs (IZR m) < bpow radix2 (1024 + k) <->
            Rabs (IZR m) * bpow radix2 (- k) < bpow radix2 (1024 + k) * bpow radix2 (- k)) as <-.
    { split; intro L; [now apply Rmult_lt_compat_r | now apply Rmult_lt_reg_r with (bpow radix2 (- k))]. }
    rewrite abs_lt_bpow by lia. split; [now left |]. intros [L | ->]; [easy |]. change (Z.log2 (Z.abs 0)) with 0%Z.
    lia. }
  unfold overflow_bits. destruct (Z.ltb_spec (Z.log2 (Z.abs m)) (1024 + k)) as [L | L]; cbn [option_map].
  - rewrite Rlt_bool_true; [reflexivity | now apply E].
  - rewrite Rlt_bool_false; [reflexivity |]. apply Rnot_lt_le. intro B. apply E in B. lia.
Qed.
