(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* greatest_between of toolkit/time/interval_refit.cpp over IEEE values: a finite result is at least whatever lies below
   a point of the parabola, chord and bump, and below what the path's length says. *)
From Coq Require Import Reals Lra Lia ZArith List Bool.
From Flocq Require Import Core.
From CinchProof Require time_bump.
From CinchProof Require Import rounding successor model real_model ieee ieee_forward between_real greatest_mean.
Open Scope R_scope.

Section Ieee.
Variables prec emin : Z.
Context {format : Format prec emin}.
Notation fl := (fl prec emin).
Notation number := (number prec emin).
Notation u := (u prec).
Notation eta := (eta emin).
Notation real_ops := (real_ops prec emin).
Context {num : Type} {o : ops num} {view : num -> value}.
Variable I : ieee prec emin o view.
Notation finite := (finite (view := view)).
Notation val := (val (view := view)).
Notation safe := (safe prec emin).

Lemma val_num x : number (val x). Proof. apply (val_number prec emin I). Qed.

(* A sum with what is at least 0 does not overflow downwards. *)
Lemma add_up x y : finite x -> finite y -> 0 <= val y -> finite (add o x y) \/ view (add o x y) = Plus.
Proof.
  intros X Y P. destruct (law_add _ _ _ _ I x y _ _ (view_val x X) (view_val y Y)) as [H | [H1 H2]];
    [left; eexists; exact H |]. rewrite H2. case Rlt_bool_spec; [| now right]. intros N. exfalso.
  specialize (H1 x _ (view_val x X)).
  assert (fl (val x + val y) <= 0) by (rewrite <- (fl_0 prec emin); apply (fl_le prec emin); lra).
  assert (val x <= fl (val x + val y)) by (apply (fl_above prec emin); [lra | apply val_num]).
  rewrite 2!Rabs_left1 in H1 by lra. lra.
Qed.

Lemma constants : finite (constant o 1 (-1)) /\ val (constant o 1 (-1)) = / 2 /\
  finite (constant o 1 (-4)) /\ val (constant o 1 (-4)) = / 16 /\ finite (constant o 4 0) /\ val (constant o 4 0) = 4 /\
  finite (constant o 1 (4 - precision o)) /\ val (constant o 1 (4 - precision o)) = 16 * u.
Proof.
  pose proof (two_power_large prec emin). destruct (exponents prec emin) as (E & E1 & E2 & E3 & P).
  rewrite (law_precision _ _ _ _ I).
  destruct (constant_value prec emin I 1 (-1) ltac:(lia) ltac:(lia)) as [F1 V1].
  destruct (constant_value prec emin I 1 (-4) ltac:(lia) ltac:(lia)) as [F2 V2].
  destruct (constant_value prec emin I 4 0 ltac:(lia) ltac:(lia)) as [F3 V3].
  destruct (constant_value prec emin I 1 (4 - prec) ltac:(lia) ltac:(lia)) as [F4 V4].
  repeat (split; [assumption |]). rewrite V1, V2, V3, V4. unfold Z.sub. rewrite bpow_plus.
  change (bpow radix2 4) with 16. fold u. unfold u, rounding.u. simpl.
  repeat (split; [first [assumption | lra] |]). first [lra | split; [assumption | lra]].
Qed.

Lemma half_finite x : finite x -> finite (half_of o x) /\ val (half_of o x) = fl (val x * / 2).
Proof.
  intros X. destruct constants as (F & V & _). apply val_is. rewrite <- V.
  destruct (law_mul _ _ _ _ I x _ _ _ (view_val x X) (view_val _ F)) as [H | H]; [exact H |]. exfalso.
  specialize (H x _ (view_val x X)). rewrite V in H.
  assert (Rabs (fl (val x * / 2)) <= Rabs (val x)); [| lra]. rewrite <- (fl_abs prec emin).
  apply (fl_below prec emin); [| apply (number_abs prec emin), val_num].
  rewrite Rabs_mult, (Rabs_pos_eq (/ 2)) by lra. pose proof (Rabs_pos (val x)). lra.
Qed.

Lemma error_backward a b r k : (1 <= k <= 4)%Z -> finite (between_error o a b r k) ->
  finite a /\ finite b /\ finite r /\
  val (between_error o a b r k) = real_error prec emin (val a) (val b) (val r) (IZR k).
Proof.
  intros K F. unfold between_error in *. destruct constants as (_ & _ & _ & _ & _ & _ & _ & V).
  pose proof (two_power_large prec emin).
  apply (add_backward prec emin I) in F. destruct F as (F & _ & ->).
  apply (mul_backward prec emin I) in F. destruct F as (_ & F & ->). rewrite V.
  apply (add_backward prec emin I) in F. destruct F as (F & R & ->).
  apply (add_backward prec emin I) in F. destruct F as (A & B & ->).
  apply (absolute_backward prec emin I) in A, B. destruct A as (A & ->). destruct B as (B & ->).
  rewrite (proj2 (smallest_value prec emin I k ltac:(lia))), model_smallest. auto.
Qed.

Lemma error_nonnegative a b r k : (1 <= k <= 4)%Z -> nonnegative (view r) ->
  nonnegative (view (between_error o a b r k)).
Proof.
  intros K R. destruct constants as (_ & _ & _ & _ & _ & _ & F & V). pose proof (two_power_large prec emin).
  destruct (smallest_value prec emin I k ltac:(lia)) as [FS VS].
  apply (law_add_nonnegative _ _ _ _ I).
  - apply (law_mul_nonnegative _ _ _ _ I).
    + rewrite (view_val _ F), V. simpl. pose proof (u_positive prec). lra.
    + apply (law_add_nonnegative _ _ _ _ I); [| exact R].
      apply (law_add_nonnegative _ _ _ _ I); apply (absolute_nonnegative prec emin I).
  - rewrite (view_val _ FS), VS, model_smallest. simpl. pose proof (eta_positive emin).
    apply Rmult_le_pos; [apply IZR_le; lia | lra].
Qed.

(* The ends, as the code lets them pass. *)
Lemma ends first last : less o (max o first last) (most_safe o) = true ->
  less o (sub o (zero o) (most_safe o)) (min o first last) = true ->
  is_number o first = true -> is_number o last = true ->
  finite first /\ finite last /\ Rabs (val first) <= safe /\ Rabs (val last) <= safe.
Proof.
  intros M L N1 N2. destruct (most_safe_value prec emin I) as [FS VS]. destruct (zero_value prec emin I) as [FZ VZ].
  pose proof (safe_at_least_1 prec emin) as S1.
  destruct (sub_forward prec emin I _ _ FZ FS) as [FN VN]; [rewrite VZ, VS; apply Rabs_le; lra |].
  rewrite VZ, VS, Rminus_0_l, (fl_opp prec emin) in VN. pose proof (safe_number prec emin 0 ltac:(lia)) as NS.
  simpl (bpow radix2 0) in NS. rewrite Rmult_1_l in NS. rewrite (fl_id prec emin _ NS) in VN.
  unfold is_number in *. rewrite (law_less_equal _ _ _ _ I) in N1, N2. unfold max, min in *.
  rewrite !(law_less _ _ _ _ I) in M, L.
  rewrite (view_val _ FS), VS in M. rewrite (view_val _ FN), VN in L. unfold ieee.finite, ieee.val in *.
  destruct (view first) as [a | | |] eqn:A; destruct (view last) as [b | | |] eqn:B; try discriminate;
    cbn [less_value] in M, L; rewrite ?A, ?B in M; rewrite ?A, ?B in L; cbn [less_value] in M, L; try discriminate.
  split; [now exists a |]. split; [now exists b |].
  revert M L. case (Rlt_bool_spec a b); intros H; rewrite ?A, ?B; cbn [less_value];
    (case (Rlt_bool_spec b a); intros H'; rewrite ?A, ?B; cbn [less_value]);
    intros M L; revert M L; (case Rlt_bool_spec; [intros M _ | discriminate]); (case Rlt_bool_spec; [intros L _ |
      discriminate]); split; apply Rabs_le; lra.
Qed.

Lemma ends_value first last : finite first -> finite last ->
  finite (max o first last) /\ finite (min o first last) /\ val (max o first last) = Rmax (val first) (val last) /\
  val (min o first last) = Rmin (val first) (val last).
Proof.
  intros A B. destruct (max_finite prec emin I _ _ A B) as [F1 V1]. destruct (min_value prec emin I _ _ A B) as [F2 V2].
  rewrite real_min in V2. auto.
Qed.

Lemma infinite_unless_finite x : finite (infinite_unless o x) -> finite x /\ infinite_unless o x = x.
Proof.
  unfold infinite_unless. destruct less; [auto |]. intros F. now apply (infinity_not_finite prec emin I) in F.
Qed.

Section Ends.
Variables first last : num.
Hypotheses (A : finite first) (B : finite last).
Hypotheses (SA : Rabs (val first) <= safe) (SB : Rabs (val last) <= safe).

Lemma difference_value : finite (sub o (max o first last) (min o first last)) /\
  val (sub o (max o first last) (min o first last)) = fl (Rmax (val first) (val last) - Rmin (val first) (val last)) /\
  0 <= val (sub o (max o first last) (min o first last)) <= 2 * safe.
Proof.
  destruct (ends_value first last A B) as (FM & Fm & VM & Vm). pose proof (safe_at_least_1 prec emin).
  apply Rabs_le_inv in SA. apply Rabs_le_inv in SB.
  assert (D : 0 <= Rmax (val first) (val last) - Rmin (val first) (val last) <= 2 * safe).
  { unfold Rmax, Rmin. destruct Rle_dec; lra. }
  destruct (sub_forward prec emin I _ _ FM Fm) as [F V]; [rewrite VM, Vm, Rabs_pos_eq; lra |].
  rewrite VM, Vm in V. split; [exact F |]. split; [exact V |]. rewrite V.
  split; [apply (fl_nonnegative prec emin); lra |]. apply (fl_below prec emin); [lra |].
  exact (safe_number prec emin 1 ltac:(lia)).
Qed.

Lemma rounded_below x k : (0 <= k <= 3)%Z -> Rabs x <= bpow radix2 k * safe -> Rabs (fl x) <= bpow radix2 k * safe.
Proof.
  intros K X. rewrite <- (fl_abs prec emin). apply (fl_below prec emin); [exact X | now apply safe_number].
Qed.

Lemma sum_value : finite (add o first last) /\ val (add o first last) = fl (val first + val last) /\
  Rabs (val (add o first last)) <= 2 * safe.
Proof.
  pose proof (Rabs_triang (val first) (val last)). pose proof (safe_at_least_1 prec emin).
  destruct (add_forward prec emin I _ _ A B) as [F V]; [lra |]. split; [exact F |]. split; [exact V |]. rewrite V.
  apply (rounded_below _ 1 ltac:(lia)). simpl (bpow radix2 1). lra.
Qed.

(* Nothing overflows on the way to the parabola's top. *)
Lemma parabola_forward bump : finite bump -> 0 < val bump <= safe ->
  val (sub o (max o first last) (min o first last)) <= 4 * val bump ->
  finite (parabola_value o first last bump) /\
  val (parabola_value o first last bump) = real_parabola prec emin (val first) (val last) (val bump) /\
  Rabs (val (parabola_value o first last bump)) <= 4 * safe.
Proof.
  intros F [P S] L. pose proof (safe_at_least_1 prec emin) as S1. destruct constants as (_ & _ & F16 & V16 & _).
  destruct difference_value as (FD & VD & D). destruct sum_value as (FS & VS & BS).
  destruct (half_finite _ FS) as [FH VH].
  assert (BH : Rabs (val (half_of o (add o first last))) <= safe).
  { rewrite VH. pose proof (rounded_below (val (add o first last) * / 2) 0 ltac:(lia)) as R. simpl (bpow radix2 0) in R.
    rewrite Rmult_1_l in R. apply R. rewrite Rabs_mult, (Rabs_pos_eq (/ 2)) by lra. lra. }
  apply Rabs_le_inv in BH.
  destruct (add_forward prec emin I _ _ FH F) as [FB VB]; [apply Rabs_le; lra |].
  assert (BB : Rabs (val (add o (half_of o (add o first last)) bump)) <= 2 * safe).
  { rewrite VB. apply (rounded_below _ 1 ltac:(lia)). simpl (bpow radix2 1). apply Rabs_le. lra. }
  unfold parabola_value. set (d := sub o (max o first last) (min o first last)) in *.
  assert (Q : 0 <= val d / val bump <= 4).
  { split; [apply Rmult_le_pos; [lra | apply Rlt_le, Rinv_0_lt_compat; lra] |].
    apply Rmult_le_reg_r with (val bump); [lra |]. unfold Rdiv. rewrite Rmult_assoc, Rinv_l by lra. lra. }
  destruct (divide_forward prec emin I d bump FD F) as [FQ VQ]; [lra | rewrite Rabs_pos_eq; lra |].
  assert (N4 : number 4).
  { apply (integer_number prec emin 4). pose proof (two_power_large prec emin). lia. }
  assert (BQ : 0 <= val (divide o d bump) <= 4).
  { rewrite VQ. split; [apply (fl_nonnegative prec emin); lra | apply (fl_below prec emin); [lra | exact N4]]. }
  destruct (mul_forward prec emin I _ _ FQ F16) as [FR VR]; [rewrite V16, Rabs_pos_eq; lra |].
  assert (BR : 0 <= val (mul o (divide o d bump) (constant o 1 (-4))) <= 1).
  { rewrite VR, V16. split; [apply (fl_nonnegative prec emin); lra |]. apply (fl_below prec emin); [lra |].
    apply (integer_number prec emin 1). pose proof (two_power_large prec emin). lia. }
  set (q := mul o (divide o d bump) (constant o 1 (-4))) in *.
  assert (DQ : 0 <= val d * val q <= 2 * safe).
  { split; [apply Rmult_le_pos; lra |]. assert (val d * val q <= 2 * safe * 1) by (apply Rmult_le_compat; lra). lra. }
  destruct (mul_forward prec emin I d q FD FR) as [FG VG]; [rewrite Rabs_pos_eq; lra |].
  assert (BG : Rabs (val (mul o d q)) <= 2 * safe).
  { rewrite VG. apply (rounded_below _ 1 ltac:(lia)). simpl (bpow radix2 1). rewrite Rabs_pos_eq; lra. }
  apply Rabs_le_inv in BB. apply Rabs_le_inv in BG.
  destruct (add_forward prec emin I _ _ FB FG) as [FP VP]; [apply Rabs_le; lra |].
  split; [exact FP |]. split.
  - rewrite VP, VB, VH, VS, VG, VR, V16, VQ, VD. reflexivity.
  - rewrite VP. apply (rounded_below _ 2 ltac:(lia)). simpl (bpow radix2 2). apply Rabs_le. lra.
Qed.

Lemma error_forward bump : finite bump -> 0 <= val bump <= safe -> finite (between_error o first last bump 4) /\
  0 <= val (between_error o first last bump 4) <= 4 * safe.
Proof.
  intros F P. pose proof (safe_at_least_1 prec emin) as S1. destruct constants as (_ & _ & _ & _ & _ & _ & F16 & V16).
  pose proof (u_positive prec) as U. pose proof (u_small prec emin) as US. pose proof (two_power_large prec emin).
  destruct (absolute_forward prec emin I _ A) as [FA VA]. destruct (absolute_forward prec emin I _ B) as [FB VB].
  pose proof (Rabs_pos (val first)). pose proof (Rabs_pos (val last)).
  destruct (add_forward prec emin I _ _ FA FB) as [FS VS]; [rewrite VA, VB, Rabs_pos_eq; lra |].
  assert (BS : Rabs (val (add o (absolute o first) (absolute o last))) <= 2 * safe).
  { rewrite VS. apply (rounded_below _ 1 ltac:(lia)). simpl (bpow radix2 1). rewrite VA, VB, Rabs_pos_eq; lra. }
  apply Rabs_le_inv in BS.
  destruct (add_forward prec emin I _ _ FS F) as [FT VT]; [apply Rabs_le; lra |].
  assert (BT : Rabs (val (add o (add o (absolute o first) (absolute o last)) bump)) <= 4 * safe).
  { rewrite VT. apply (rounded_below _ 2 ltac:(lia)). simpl (bpow radix2 2). apply Rabs_le. lra. }
  set (t := add o (add o (absolute o first) (absolute o last)) bump) in *.
  assert (M16 : Rabs (16 * u * val t) <= safe).
  { rewrite Rabs_mult, (Rabs_pos_eq (16 * u)) by lra. pose proof (Rabs_pos (val t)).
    assert (16 * u * Rabs (val t) <= / 4 * (4 * safe)) by (apply Rmult_le_compat; lra). lra. }
  destruct (mul_forward prec emin I _ _ F16 FT) as [FM VM]; [rewrite V16; lra |].
  assert (BM : Rabs (val (mul o (constant o 1 (4 - precision o)) t)) <= safe).
  { rewrite VM, V16. pose proof (rounded_below (16 * u * val t) 0 ltac:(lia)) as R. simpl (bpow radix2 0) in R.
    rewrite Rmult_1_l in R. now apply R. }
  destruct (smallest_value prec emin I 4 ltac:(lia)) as [F4 V4]. rewrite model_smallest in V4.
  pose proof (eta_below_safe prec emin) as E. pose proof (eta_positive emin).
  assert (u * safe <= / 16777216 * safe) by (apply Rmult_le_compat_r; lra).
  apply Rabs_le_inv in BM.
  destruct (add_forward prec emin I _ _ FM F4) as [FE VE]; [rewrite V4; apply Rabs_le; lra |].
  split; [exact FE |]. split.
  - assert (NN : nonnegative (view (between_error o first last bump 4))).
    { apply error_nonnegative; [lia |]. rewrite (view_val _ F). simpl. lra. }
    unfold between_error in NN |- *. fold t in NN |- *. rewrite (view_val _ FE) in NN. exact NN.
  - unfold between_error. fold t. rewrite VE. apply Rle_trans with (1 := Rle_abs _).
    apply (rounded_below _ 2 ltac:(lia)). simpl (bpow radix2 2). rewrite V4. apply Rabs_le. lra.
Qed.

Lemma parabola_sound bump v : finite bump -> 0 < val bump ->
  val (sub o (max o first last) (min o first last)) < 4 * val bump ->
  v <= time_bump.greatest_between (val first) (val last) (val bump) ->
  finite (parabola_top o first last bump) -> v <= val (parabola_top o first last bump).
Proof.
  intros F P D V T. unfold parabola_top in *. destruct (most_safe_value prec emin I) as [FS VS].
  destruct (less o bump (most_safe o)) eqn:L; [| now apply (infinity_not_finite prec emin I) in T].
  rewrite (less_finite prec emin I _ _ F FS), VS in L. revert L. case Rlt_bool_spec; [intros L _ | discriminate].
  destruct (parabola_forward bump F ltac:(lra) ltac:(lra)) as (FP & VP & BP).
  destruct (error_forward bump F ltac:(lra)) as (FE & BE).
  apply infinite_unless_finite in T. destruct T as [T ->]. apply Rabs_le_inv in BP.
  destruct (add_forward prec emin I _ _ FP FE) as [FA VA]; [apply Rabs_le; lra |].
  destruct (ends_value first last A B) as (FM & _ & _ & _).
  destruct (max_finite prec emin I _ _ FM FA) as [_ ->]. apply Rle_trans with (2 := Rmax_r _ _). rewrite VA.
  destruct (error_backward first last bump 4 ltac:(lia) FE) as (_ & _ & _ & ->). rewrite VP.
  apply Rle_trans with (1 := V). destruct difference_value as (_ & VD & _). rewrite VD in D.
  apply (parabola_covers prec emin); try apply val_num; [exact P | | lra |].
  - apply Rnot_le_lt. intros Up. apply (fl_above prec emin) in Up; [lra |]. apply (four_times prec emin), val_num.
  - apply (scaled_number prec emin 4); [pose proof (two_power_large prec emin); lia | lia].
Qed.

Lemma lipschitz_sound path v : nonnegative (view path) ->
  (finite path -> v <= (val first + val last + val path) / 2 /\ v <= Rmin (val first) (val last) + val path) ->
  finite (max o (max o first last) (lipschitz_top o first last path)) ->
  v <= val (max o (max o first last) (lipschitz_top o first last path)).
Proof.
  intros N V F. destruct (ends_value first last A B) as (FM & Fm & VM & Vm).
  unfold lipschitz_top in *.
  set (way := min o (half_of o (add o (add o first last) path)) (add o (min o first last) path)) in *.
  set (e := between_error o first last path 1) in *.
  assert (NE : nonnegative (view e)) by (apply error_nonnegative; [lia | exact N]).
  destruct (less o (add o way e) (infinity o)) eqn:L.
  2: { exfalso. unfold infinite_unless in F. rewrite L in F. unfold max at 1 in F.
       rewrite (law_less _ _ _ _ I), (view_val _ FM), (law_infinity _ _ _ _ I) in F. cbn [less_value] in F.
       now apply (infinity_not_finite prec emin I) in F. }
  assert (Path : finite e -> finite path /\ 0 <= val path).
  { intros Fe. destruct (error_backward first last path 1 ltac:(lia) Fe) as (_ & _ & Fp & _). split; [exact Fp |].
    rewrite (view_val _ Fp) in N. exact N. }
  assert (FW : finite (add o way e)).
  { apply (below_infinity prec emin I) in L. destruct L as [L | L]; [exact L |]. exfalso.
    destruct (law_add_minus _ _ _ _ I _ _ L) as [E1 E2].
    assert (Fe : finite e) by (destruct (view e) eqn:Ee; [now exists r | congruence | contradiction | congruence]).
    destruct (Path Fe) as [Fp Pp]. assert (Pe : 0 <= val e) by (rewrite (view_val _ Fe) in NE; exact NE).
    assert (Up : finite way \/ nonnegative (view way)).
    { destruct sum_value as (FS & _ & _).
      assert (U1 : finite (half_of o (add o (add o first last) path)) \/
                   nonnegative (view (half_of o (add o (add o first last) path)))).
      { destruct (add_up _ path FS Fp Pp) as [H | H]; [left; now apply half_finite |]. right.
        apply (law_mul_nonnegative _ _ _ _ I); [now rewrite H |]. destruct constants as (F2 & V2 & _).
        rewrite (view_val _ F2), V2. simpl. lra. }
      assert (U2 : finite (add o (min o first last) path) \/ nonnegative (view (add o (min o first last) path))).
      { destruct (add_up _ path Fm Fp Pp) as [H | H]; [now left | right; now rewrite H]. }
      unfold way, min. destruct less; assumption. }
    destruct Up as [Up | Up].
    - destruct (add_up way e Up Fe Pe) as [[r H] | H]; congruence.
    - pose proof (law_add_nonnegative _ _ _ _ I way e Up NE) as H. rewrite L in H. exact H. }
  unfold infinite_unless in *. rewrite L in *.
  destruct (max_finite prec emin I _ _ FM FW) as [_ ->]. apply Rle_trans with (2 := Rmax_r _ _).
  apply (add_backward prec emin I) in FW. destruct FW as (FWay & Fe & ->). destruct (Path Fe) as [Fp Pp].
  destruct (error_backward first last path 1 ltac:(lia) Fe) as (_ & _ & _ & Ve). fold e in Ve. rewrite Ve.
  destruct (V Fp) as [V1 V2]. apply (way_covers prec emin); try apply val_num; [exact Pp |].
  unfold way, min in *. destruct less.
  - right. split; [| exact V2]. apply (add_backward prec emin I) in FWay. destruct FWay as (_ & _ & ->). now rewrite Vm.
  - left. split; [| exact V1]. unfold half_of in *. apply (mul_backward prec emin I) in FWay.
    destruct FWay as (FWay & _ & ->). destruct constants as (_ & -> & _).
    apply (add_backward prec emin I) in FWay. destruct FWay as (_ & _ & ->). destruct sum_value as (_ & -> & _).
    reflexivity.
Qed.
End Ends.

Lemma or_infinity x : view x <> Minus ->
  finite x /\ number_or_infinity o x = x \/ view (number_or_infinity o x) = Plus.
Proof.
  intros N. unfold number_or_infinity, is_number. rewrite (law_less_equal _ _ _ _ I).
  destruct (view x) eqn:E; cbn [less_equal_value]; [| now right | congruence | right; apply (law_infinity _ _ _ _ I)].
  rewrite Rle_bool_true by lra. left. split; [now exists r | reflexivity].
Qed.

(* v: the value at one instant. A bump or path that is infinite or no number says nothing. *)
Theorem greatest_between_sound first last bump path v :
  view bump <> Minus -> nonnegative (view path) ->
  (finite bump -> exists t, 0 <= t <= 1 /\
     v <= (1 - t) * val first + t * val last + 4 * t * (1 - t) * val bump) ->
  (finite path -> v <= (val first + val last + val path) / 2 /\ v <= Rmin (val first) (val last) + val path) ->
  finite (greatest_between o first last bump path) ->
  finite first /\ finite last /\ v <= val (greatest_between o first last bump path).
Proof.
  intros NB NP HB HP F. unfold greatest_between in *.
  destruct (_ && is_number o last) eqn:C; [| now apply (infinity_not_finite prec emin I) in F].
  apply andb_prop in C. destruct C as [C C4]. apply andb_prop in C. destruct C as [C C3].
  apply andb_prop in C. destruct C as [C1 C2]. destruct (ends first last C1 C2 C3 C4) as (A & B & SA & SB).
  split; [exact A |]. split; [exact B |]. clear C1 C2 C3 C4.
  destruct (ends_value first last A B) as (FM & Fm & VM & Vm).
  destruct (difference_value first last A B SA SB) as (FD & VD & D).
  destruct (zero_value prec emin I) as [FZ VZ]. destruct constants as (_ & _ & _ & _ & F4 & V4 & _).
  assert (NP' : view path <> Minus) by (intros E; now rewrite E in NP).
  set (s := number_or_infinity o bump) in *. set (p := number_or_infinity o path) in *.
  assert (HS : finite s -> v <= time_bump.greatest_between (val first) (val last) (val s)).
  { intros Fs. destruct (or_infinity bump NB) as [[Fb E] | E]; fold s in E; [| destruct Fs as [r Fs]; congruence].
    rewrite E. destruct (HB Fb) as (t & T & V). apply Rle_trans with (1 := V). now apply time_bump.closed_form. }
  assert (VS : finite s \/ view s = Plus).
  { destruct (or_infinity bump NB) as [[Fb E] | E]; fold s in E; [left; now rewrite E | now right]. }
  assert (HPath : nonnegative (view p) /\ (finite p ->
    v <= (val first + val last + val p) / 2 /\ v <= Rmin (val first) (val last) + val p)).
  { destruct (or_infinity path NP') as [[Fp E] | E]; fold p in E.
    - rewrite E. now split.
    - rewrite E. split; [exact Logic.I |]. intros [r Fp]. congruence. }
  destruct HPath as [NNp HPath].
  assert (Up : forall x, finite (model.succ o x) -> val x <= val (model.succ o x)).
  { intros x Fx. apply (succ_backward prec emin I) in Fx. destruct Fx as (_ & ->). rewrite (model_succ prec emin).
    pose proof (below_succ_fl prec emin (val x)) as H. now rewrite (fl_id prec emin _ (val_num x)) in H. }
  destruct (less_equal o s (zero o)) eqn:Neg; cbn [orb] in *.
  - (* no bump *)
    apply Rle_trans with (2 := Up _ F). rewrite VM. rewrite (law_less_equal _ _ _ _ I), (view_val _ FZ), VZ in Neg.
    destruct VS as [Fs | Fs]; [| rewrite Fs in Neg; discriminate]. rewrite (view_val _ Fs) in Neg. cbn
      [less_equal_value]
      in Neg.
    apply Rle_trans with (1 := HS Fs). unfold time_bump.greatest_between. revert Neg. case Rle_bool_spec; [|
      discriminate].
    intros Neg _. destruct (Rle_dec (val s) 0); [apply Rle_refl | contradiction].
  - assert (Pos : finite s -> 0 < val s).
    { intros Fs. rewrite (law_less_equal _ _ _ _ I), (view_val _ FZ), VZ, (view_val _ Fs) in Neg. cbn [less_equal_value]
        in Neg. revert Neg. case Rle_bool_spec; [discriminate | trivial]. }
    assert (N4 : finite s -> finite (mul o (constant o 4 0) s) -> val (mul o (constant o 4 0) s) = 4 * val s).
    { intros Fs Fm4. apply (mul_backward prec emin I) in Fm4. destruct Fm4 as (_ & _ & ->). rewrite V4.
      apply (fl_id prec emin), (four_times prec emin), val_num. }
    assert (NN : nonnegative (view (mul o (constant o 4 0) s))).
    { apply (law_mul_nonnegative _ _ _ _ I); [rewrite (view_val _ F4), V4; simpl; lra |].
      destruct VS as [Fs | Fs]; [rewrite (view_val _ Fs); simpl; specialize (Pos Fs); lra | now rewrite Fs]. }
    destruct (less_equal o (mul o (constant o 4 0) s) (sub o (max o first last) (min o first last))) eqn:Steep.
    + (* the chord is steep *)
      rewrite (law_less_equal _ _ _ _ I), (view_val _ FD) in Steep.
      assert (F4s : finite (mul o (constant o 4 0) s)).
      { destruct (view (mul o (constant o 4 0) s)) eqn:E; [now exists r | discriminate | contradiction |
        discriminate]. }
      assert (Fs : finite s) by (apply (mul_backward prec emin I) in F4s; apply F4s).
      rewrite (view_val _ F4s), (N4 Fs F4s), VD in Steep. cbn [less_equal_value] in Steep.
      apply (succ_backward prec emin I) in F. destruct F as (_ & ->). rewrite (model_succ prec emin), VM.
      apply Rle_trans with (1 := HS Fs). apply (steep prec emin); try apply val_num; [now apply Pos |].
      revert Steep. case Rle_bool_spec; [trivial | discriminate].
    + apply Rle_trans with (2 := Up _ F). apply (succ_backward prec emin I) in F. destruct F as (F & _).
      unfold min at 1 in F. unfold min at 1.
      destruct (less o _ (parabola_top o first last s)).
      * now apply lipschitz_sound.
      * assert (Fs : finite s).
        { destruct VS as [Fs | Fs]; [exact Fs | exfalso]. unfold parabola_top in F.
          rewrite (law_less _ _ _ _ I s), Fs in F. destruct (most_safe_value prec emin I) as [FS _].
          rewrite (view_val _ FS) in F. cbn [less_value] in F. now apply (infinity_not_finite prec emin I) in F. }
        apply parabola_sound; trivial; [now apply Pos | | now apply HS].
        destruct (Rlt_or_le (val (sub o (max o first last) (min o first last))) (4 * val s)) as [H | H]; [exact H |].
        exfalso. destruct (mul_forward prec emin I _ _ F4 Fs) as [F4s _].
        { rewrite V4. specialize (Pos Fs). rewrite Rabs_pos_eq; lra. }
        rewrite (law_less_equal _ _ _ _ I), (view_val _ FD), (view_val _ F4s), (N4 Fs F4s) in Steep.
        cbn [less_equal_value] in Steep. rewrite Rle_bool_true in Steep by exact H. discriminate.
Qed.
End Ieee.
