(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* The filters of toolkit/collide/orientation.cpp: where they decide, they decide as the exact determinant does.
Rounding
   and underflow are here; that nothing overflows is the range of the greatest differences. *)
From Coq Require Import Reals Lra Lia ZArith List Bool.
From Flocq Require Import Core.
From CinchProof Require Import rounding approximation model real_model.
Import ListNotations.
Open Scope R_scope.

Section Orientation.
Variables prec emin : Z.
Context {format : Format prec emin}.
Notation fl := (fl prec emin).
Notation number := (number prec emin).
Notation u := (u prec).
Notation eta := (eta emin).
Notation real_ops := (real_ops prec emin).
Notation approximates := (approximates prec emin).
Notation growth := (growth prec).

Definition sign_is (v : verdict) (x : R) : Prop :=
  match v with Positive => 0 < x | Negative => x < 0 | Zero => x = 0 | Undecided => True end.

(* A computed difference of at most m in magnitude. *)
Lemma difference_approximates x y m : number x -> number y -> Rabs (fl (x - y)) <= m ->
  approximates 1 (fl (x - y)) (x - y) ((1 + u) * m) 0.
Proof.
  intros X Y M. pose proof (fl_plus_error_result prec emin x (- y) X (number_opp prec emin _ Y)) as E.
  replace (x + - y) with (x - y) in E by ring. pose proof (u_positive prec).
  pose proof (Rabs_pos (fl (x - y))).
  assert (UM : u * Rabs (fl (x - y)) <= u * m) by (apply Rmult_le_compat_l; lra).
  split; [apply (fl_number prec emin) |]. split.
  - replace (x - y) with (fl (x - y) - (fl (x - y) - (x - y))) by ring.
    pose proof (Rabs_triang (fl (x - y)) (- (fl (x - y) - (x - y)))) as T. rewrite Rabs_Ropp in T.
    unfold Rminus at 1. lra.
  - replace (growth 1) with u by (unfold growth; simpl; ring).
    assert (0 <= u * (u * m)) by (apply Rmult_le_pos; [lra |]; apply Rmult_le_pos; lra). lra.
Qed.

(* A product with what has lost something to underflow. *)
Lemma approximates_mul_lossy j k c x X a d y Y : 0 <= a ->
  approximates j c x X 0 -> approximates k d y Y a ->
  approximates (S (j + k)) (fl (c * d)) (x * y) (X * Y) ((1 + u) ^ S j * X * a + / 2).
Proof.
  intros A0 (F & B & E) (G & C & D). pose proof (u_positive prec). pose proof (Rabs_pos x). pose proof (Rabs_pos y).
  rewrite Rmult_0_l, Rplus_0_r in E. pose proof (eta_positive emin).
  pose proof (growth_nonnegative prec j) as GJ. pose proof (growth_nonnegative prec k) as GK.
  assert (XY : Rabs (x * y) <= X * Y) by (rewrite Rabs_mult; apply Rmult_le_compat; lra).
  assert (AE : 0 <= a * eta) by (apply Rmult_le_pos; lra).
  split; [apply (fl_number prec emin) |]. split; [exact XY |].
  assert (W : Rabs (c * d - x * y) <= growth (j + k) * (X * Y) + (1 + u) ^ j * X * a * eta).
  { replace (c * d - x * y) with ((c - x) * (d - y) + (c - x) * y + x * (d - y)) by ring.
    pose proof (Rabs_triang ((c - x) * (d - y) + (c - x) * y) (x * (d - y))).
    pose proof (Rabs_triang ((c - x) * (d - y)) ((c - x) * y)).
    pose proof (Rabs_pos (c - x)). pose proof (Rabs_pos (d - y)).
    assert (Rabs ((c - x) * (d - y)) <= growth j * X * (growth k * Y + a * eta)) by
      (rewrite Rabs_mult; apply Rmult_le_compat; lra).
    assert (Rabs ((c - x) * y) <= growth j * X * Y) by (rewrite Rabs_mult; apply Rmult_le_compat; lra).
    assert (Rabs (x * (d - y)) <= X * (growth k * Y + a * eta)) by (rewrite Rabs_mult; apply Rmult_le_compat; lra).
    replace ((1 + u) ^ j) with (1 + growth j) by (unfold approximation.growth; ring).
    replace (growth (j + k)) with (growth j * growth k + growth j + growth k)
      by (unfold approximation.growth; rewrite pow_add; ring). lra. }
  pose proof (fl_error prec emin (c * d)) as R.
  replace (fl (c * d) - x * y) with ((fl (c * d) - c * d) + (c * d - x * y)) by ring.
  pose proof (Rabs_triang (fl (c * d) - c * d) (c * d - x * y)).
  assert (V : Rabs (c * d) <= (1 + growth (j + k)) * (X * Y) + (1 + u) ^ j * X * a * eta).
  { replace (c * d) with (x * y + (c * d - x * y)) by ring.
    pose proof (Rabs_triang (x * y) (c * d - x * y)). lra. }
  assert (u * Rabs (c * d) <= u * ((1 + growth (j + k)) * (X * Y) + (1 + u) ^ j * X * a * eta))
    by (apply Rmult_le_compat_l; lra).
  replace (growth (S (j + k))) with ((1 + u) * growth (j + k) + u) by (unfold approximation.growth; simpl; ring).
  simpl ((1 + u) ^ S j). lra.
Qed.

Lemma minor_approximates a b c d xa xb xc xd A B :
  approximates 1 a xa A 0 -> approximates 1 b xb B 0 -> approximates 1 c xc B 0 -> approximates 1 d xd A 0 ->
  approximates 4 (minor real_ops a b c d) (xa * xb - xc * xd) (2 * (A * B)) (1 + u).
Proof.
  intros HA HB HC HD.
  pose proof (approximates_mul prec emin 1 1 _ _ _ _ _ _ HA HB) as P.
  pose proof (approximates_mul prec emin 1 1 _ _ _ _ _ _ HC HD) as Q.
  unfold minor. cbn [sub mul real_model.real_ops].
  replace (2 * (A * B)) with (A * B + B * A) by ring. replace (1 + u) with ((1 + u) * (/ 2 + / 2)) by field.
  now apply (approximates_sub prec emin).
Qed.

Definition exact3 (p q r : triple R) : R :=
  at0 p * (at1 q * at2 r - at2 q * at1 r) - at0 q * (at1 p * at2 r - at2 p * at1 r) +
  at0 r * (at1 p * at2 q - at2 p * at1 q).

Definition near (p x m : triple R) : Prop :=
  approximates 1 (at0 p) (at0 x) ((1 + u) * at0 m) 0 /\ approximates 1 (at1 p) (at1 x) ((1 + u) * at1 m) 0 /\
  approximates 1 (at2 p) (at2 x) ((1 + u) * at2 m) 0.

Lemma determinant3_error p q r x y z m :
  0 <= at0 m -> 0 <= at1 m -> 0 <= at2 m -> near p x m -> near q y m -> near r z m ->
  Rabs (determinant3 real_ops p q r - exact3 x y z) <=
  48.01 * u * (at0 m * (at1 m * at2 m)) + (3.2 * at0 m + 1.7) * eta.
Proof.
  intros M0 M1 M2 (P0 & P1 & P2) (Q0 & Q1 & Q2) (R0 & R1 & R2).
  pose proof (u_positive prec) as U. pose proof (u_small prec emin) as US.
  pose proof (minor_approximates _ _ _ _ _ _ _ _ _ _ Q1 R2 Q2 R1) as NP.
  pose proof (minor_approximates _ _ _ _ _ _ _ _ _ _ P1 R2 P2 R1) as NQ.
  pose proof (minor_approximates _ _ _ _ _ _ _ _ _ _ P1 Q2 P2 Q1) as NR.
  assert (UA : 0 <= 1 + u) by lra.
  pose proof (approximates_mul_lossy 1 4 _ _ _ _ _ _ _ UA P0 NP) as TP.
  pose proof (approximates_mul_lossy 1 4 _ _ _ _ _ _ _ UA Q0 NQ) as TQ.
  pose proof (approximates_mul_lossy 1 4 _ _ _ _ _ _ _ UA R0 NR) as TR.
  cbn [Nat.add] in TP, TQ, TR.
  set (A := (1 + u) ^ 2 * ((1 + u) * at0 m) * (1 + u) + / 2) in *.
  pose proof (approximates_sub prec emin _ _ _ _ _ _ _ _ _ TP TQ) as TPQ.
  assert (TR7 := approximates_weaken prec emin 6 7 _ _ _ A A ltac:(lia) (Rle_refl A) TR).
  pose proof (approximates_add prec emin _ _ _ _ _ _ _ _ _ TPQ TR7) as (_ & _ & T).
  unfold determinant3, exact3. cbn [add sub mul real_model.real_ops]. apply Rle_trans with (1 := T). clear T.
  set (M := at0 m * (at1 m * at2 m)). assert (MP : 0 <= M) by (repeat apply Rmult_le_pos; assumption).
  pose proof (eta_positive emin) as E0.
  replace ((1 + u) * at0 m * (2 * ((1 + u) * at1 m * ((1 + u) * at2 m))) +
           (1 + u) * at0 m * (2 * ((1 + u) * at1 m * ((1 + u) * at2 m))) +
           (1 + u) * at0 m * (2 * ((1 + u) * at1 m * ((1 + u) * at2 m)))) with (6 * (1 + u) ^ 3 * M)
    by (unfold M; ring).
  assert (U2 : u * u <= / 16777216 * u) by (apply Rmult_le_compat_r; lra).
  assert (C3 : (1 + u) ^ 3 <= 1 + 3.01 * u).
  { replace ((1 + u) ^ 3) with (1 + 3 * u + 3 * (u * u) + u * (u * u)) by ring.
    assert (u * (u * u) <= 1 * (u * u)) by (apply Rmult_le_compat_r; [apply Rmult_le_pos |]; lra). lra. }
  assert (G8 : growth 8 <= 8.00001 * u).
  { pose proof (growth_small prec 8) as G. replace (INR 8) with 8 in G by (simpl; ring). specialize (G ltac:(lra)).
  lra. }
  apply Rplus_le_compat.
  - rewrite <- Rmult_assoc. apply Rmult_le_compat_r; [exact MP |].
    pose proof (growth_nonnegative prec 8). pose proof (power_at_least_1 prec 3).
    apply Rle_trans with (8.00001 * u * (6 * (1 + 3.01 * u))).
    + apply Rmult_le_compat; lra.
    + lra.
  - apply Rmult_le_compat_r; [lra |].
    assert (C4 : (1 + u) ^ 2 * ((1 + u) * at0 m) * (1 + u) <= 1.001 * at0 m).
    { replace ((1 + u) ^ 2 * ((1 + u) * at0 m) * (1 + u)) with ((1 + u) ^ 3 * (1 + u) * at0 m) by ring.
      apply Rmult_le_compat_r; [exact M0 |]. apply Rle_trans with ((1 + 3.01 * u) * (1 + u)); [| lra].
      apply Rmult_le_compat_r; lra. }
    assert (A1 : A <= 1.001 * at0 m + / 2) by (unfold A; lra).
    apply Rle_trans with ((1 + u) * ((1 + u) * (2 * (1.001 * at0 m + / 2)) + (1.001 * at0 m + / 2))).
    + apply Rmult_le_compat_l; [lra |]. apply Rplus_le_compat; [| exact A1]. apply Rmult_le_compat_l; lra.
    + assert (u * at0 m <= / 16777216 * at0 m) by (apply Rmult_le_compat_r; lra).
      assert (u * u * at0 m <= / 16777216 * u * at0 m) by (apply Rmult_le_compat_r; lra).
      lra.
Qed.

Lemma determinant2_error p0 p1 q0 q1 x0 x1 y0 y1 m0 m1 : 0 <= m0 -> 0 <= m1 ->
  approximates 1 p0 x0 ((1 + u) * m0) 0 -> approximates 1 p1 x1 ((1 + u) * m1) 0 ->
  approximates 1 q0 y0 ((1 + u) * m0) 0 -> approximates 1 q1 y1 ((1 + u) * m1) 0 ->
  Rabs (determinant2 real_ops p0 p1 q0 q1 - (x0 * y1 - x1 * y0)) <= 8.01 * u * (m0 * m1) + 1.1 * eta.
Proof.
  intros M0 M1 P0 P1 Q0 Q1. pose proof (u_positive prec) as U. pose proof (u_small prec emin) as US.
  pose proof (minor_approximates _ _ _ _ _ _ _ _ _ _ P0 Q1 P1 Q0) as (_ & _ & T).
  unfold determinant2. apply Rle_trans with (1 := T). clear T. pose proof (eta_positive emin).
  set (M := m0 * m1). assert (MP : 0 <= M) by now apply Rmult_le_pos.
  replace (2 * ((1 + u) * m0 * ((1 + u) * m1))) with (2 * (1 + u) ^ 2 * M) by (unfold M; ring).
  assert (U2 : u * u <= / 16777216 * u) by (apply Rmult_le_compat_r; lra).
  assert (G4 : growth 4 <= 4.00001 * u).
  { pose proof (growth_small prec 4) as G. replace (INR 4) with 4 in G by (simpl; ring). specialize (G ltac:(lra)).
  lra. }
  apply Rplus_le_compat; [| apply Rmult_le_compat_r; lra].
  rewrite <- Rmult_assoc. apply Rmult_le_compat_r; [exact MP |].
  pose proof (growth_nonnegative prec 4). pose proof (power_at_least_1 prec 2).
  apply Rle_trans with (4.00001 * u * (2 * (1 + 2.01 * u))).
  - apply Rmult_le_compat; lra.
  - lra.
Qed.

(* The computed error bound: constant u m0 m1 m2, three products. *)
Lemma product_at_least e m c : 0 <= m -> 0 <= c -> c <= e -> c * m * (1 - u) - eta / 2 <= fl (e * m).
Proof.
  intros M C E. pose proof (fl_error prec emin (e * m)) as R. pose proof (u_positive prec).
  assert (EM : c * m <= e * m) by now apply Rmult_le_compat_r.
  assert (0 <= c * m) by now apply Rmult_le_pos.
  rewrite (Rabs_pos_eq (e * m)) in R by lra. apply Rabs_le_inv in R. pose proof (u_small prec emin).
  assert (c * m * (1 - u) <= e * m * (1 - u)) by (apply Rmult_le_compat_r; lra). lra.
Qed.

(* What the range is for: underflow is small against u M. *)
Definition range_ok (range : Z) : Prop := (0 <= range)%Z /\ eta <= / 64 * u * bpow radix2 (-3 * range).

Lemma underflow_small range m0 m1 m2 : range_ok range ->
  bpow radix2 (- range) <= m0 -> bpow radix2 (- range) <= m1 -> bpow radix2 (- range) <= m2 ->
  let M := m0 * (m1 * m2) in
  eta <= / 64 * u * M /\ eta * m0 <= / 64 * u * M /\ eta * m2 <= / 64 * u * M /\ eta * (m1 * m2) <= / 64 * u * M.
Proof.
  intros [R E]. set (L := bpow radix2 (- range)) in *. pose proof (u_positive prec) as U.
  pose proof (eta_positive emin) as E0.
  assert (LP : 0 < L) by apply bpow_gt_0.
  assert (L1 : L <= 1) by (unfold L; change 1 with (bpow radix2 0); apply bpow_le; lia).
  replace (bpow radix2 (-3 * range)) with (L * (L * L)) in E
    by (unfold L; rewrite <- !bpow_plus; f_equal; ring).
  intros A0 A1 A2 M.
  assert (P12 : L * L <= m1 * m2) by (apply Rmult_le_compat; lra).
  assert (L2 : L * L <= 1) by (rewrite <- (Rmult_1_l 1); apply Rmult_le_compat; lra).
  assert (H : forall k X, 0 < k -> 0 <= X -> L * (L * L) * X <= M -> eta * X <= / 64 * u * M).
  { intros k X _ X0 B. apply Rle_trans with (/ 64 * u * (L * (L * L)) * X); [now apply Rmult_le_compat_r |].
    rewrite Rmult_assoc. apply Rmult_le_compat_l; [| exact B]. apply Rmult_le_pos; lra. }
  assert (LL : 0 <= L * L) by (apply Rmult_le_pos; lra).
  split; [| split; [| split]].
  - rewrite <- (Rmult_1_r eta). apply (H 1); [lra | lra |]. rewrite Rmult_1_r. unfold M. apply Rmult_le_compat; lra.
  - apply (H 1); [lra | lra |]. unfold M. replace (L * (L * L) * m0) with (m0 * (L * (L * L))) by ring.
    apply Rmult_le_compat_l; [lra |]. apply Rle_trans with (1 * (L * L)); [apply Rmult_le_compat_r; lra | lra].
  - apply (H 1); [lra | lra |]. unfold M. replace (L * (L * L) * m2) with (L * L * (L * m2)) by ring.
    apply Rmult_le_compat; [lra | apply Rmult_le_pos; lra | |].
    + apply Rle_trans with (L * 1); [apply Rmult_le_compat_l; lra | lra].
    + apply Rmult_le_compat_r; lra.
  - apply (H 1); [lra | apply Rmult_le_pos; lra |]. unfold M. apply Rmult_le_compat_r; [apply Rmult_le_pos; lra |].
    apply Rle_trans with (L * 1); [apply Rmult_le_compat_l; lra | lra].
Qed.

Lemma error3_at_least range m0 m1 m2 : range_ok range ->
  bpow radix2 (- range) <= m0 -> bpow radix2 (- range) <= m1 -> bpow radix2 (- range) <= m2 ->
  48.9 * u * (m0 * (m1 * m2)) <= fl (fl (fl (49 * u * m0) * m1) * m2).
Proof.
  intros R A0 A1 A2. destruct (underflow_small range m0 m1 m2 R A0 A1 A2) as (E1 & E2 & E3 & E4).
  pose proof (u_positive prec) as U. pose proof (u_small prec emin) as US. pose proof (eta_positive emin) as E0.
  pose proof (bpow_gt_0 radix2 (- range)) as LP. set (L := bpow radix2 (- range)) in *.
  assert (M12 : 0 < m1 * m2) by (apply Rmult_lt_0_compat; lra).
  set (M := m0 * (m1 * m2)) in *. assert (MP : 0 <= M) by (apply Rmult_le_pos; lra).
  pose proof (product_at_least (49 * u) m0 (49 * u) ltac:(lra) ltac:(lra) (Rle_refl _)) as B1.
  set (c1 := 49 * u * m0 * (1 - u) - eta / 2) in *.
  assert (C1 : 0 <= c1).
  { (* eta m1 m2 <= u M / 64 *)
    assert (Q : eta <= / 64 * u * m0).
    { apply Rmult_le_reg_r with (m1 * m2); [exact M12 |].
      replace (/ 64 * u * m0 * (m1 * m2)) with (/ 64 * u * M) by (unfold M; ring). exact E4. }
    assert (0 <= u * m0) by (apply Rmult_le_pos; lra).
    assert (u * m0 * u <= u * m0 * / 16777216) by (apply Rmult_le_compat_l; lra). unfold c1. lra. }
  pose proof (product_at_least _ m1 c1 ltac:(lra) C1 B1) as B2.
  set (c2 := c1 * m1 * (1 - u) - eta / 2) in *.
  assert (UM : 0 <= u * M) by (apply Rmult_le_pos; lra).
  assert (UUM : u * u * M <= / 16777216 * u * M) by (rewrite !(Rmult_assoc _ u M); apply Rmult_le_compat_r; lra).
  assert (U4 : 0 <= u * u * M) by (apply Rmult_le_pos; [apply Rmult_le_pos |]; lra).
  assert (U5 : u * u * u * M <= / 16777216 * (u * u * M))
    by (replace (u * u * u * M) with (u * (u * u * M)) by ring; apply Rmult_le_compat_r; lra).
  assert (U6 : 0 <= u * u * u * M) by (repeat apply Rmult_le_pos; lra).
  assert (V1 : 0 <= u * (eta * (m1 * m2))) by (repeat apply Rmult_le_pos; lra).
  assert (V2 : 0 <= u * (eta * m2)) by (repeat apply Rmult_le_pos; lra).
  assert (V3 : u * (eta * (m1 * m2)) <= 1 * (eta * (m1 * m2))) by (apply Rmult_le_compat_r;
    [repeat apply Rmult_le_pos |]; lra).
  assert (V4 : 0 <= u * u * (eta * (m1 * m2))) by (repeat apply Rmult_le_pos; lra).
  assert (V5 : u * u * (eta * (m1 * m2)) <= u * 1 * (eta * (m1 * m2)))
    by (apply Rmult_le_compat_r; [repeat apply Rmult_le_pos; lra |]; apply Rmult_le_compat_l; lra).
  assert (C2 : 0 <= c2).
  { apply Rmult_le_reg_r with m2; [lra |]. rewrite Rmult_0_l. unfold c2, c1.
    replace (((49 * u * m0 * (1 - u) - eta / 2) * m1 * (1 - u) - eta / 2) * m2)
      with (49 * (u * M) - 98 * (u * u * M) + 49 * (u * u * u * M) - (eta * (m1 * m2)) / 2 +
            u * (eta * (m1 * m2)) / 2 - (eta * m2) / 2) by (unfold M; field). lra. }
  pose proof (product_at_least _ m2 c2 ltac:(lra) C2 B2) as B3. apply Rle_trans with (2 := B3). unfold c2, c1.
  assert (U7 : u * u * u * u * M <= / 16777216 * (u * u * u * M))
    by (replace (u * u * u * u * M) with (u * (u * u * u * M)) by ring; apply Rmult_le_compat_r; lra).
  replace (((49 * u * m0 * (1 - u) - eta / 2) * m1 * (1 - u) - eta / 2) * m2 * (1 - u) - eta / 2)
    with (49 * (u * M) - 147 * (u * u * M) + 147 * (u * u * u * M) - 49 * (u * u * u * u * M) -
          (eta * (m1 * m2)) / 2 + u * (eta * (m1 * m2)) - u * u * (eta * (m1 * m2)) / 2 -
          (eta * m2) / 2 + u * (eta * m2) / 2 - eta / 2) by (unfold M; field).
  lra.
Qed.

Lemma max_real a b : a <= max real_ops a b /\ b <= max real_ops a b.
Proof. unfold max. cbn [less real_model.real_ops]. case Rlt_bool_spec; lra. Qed.

Lemma greatest3_real a b c : let g := greatest3 real_ops a b c in Rabs a <= g /\ Rabs b <= g /\ Rabs c <= g.
Proof.
  unfold greatest3. cbn [absolute real_model.real_ops].
  pose proof (max_real (Rabs a) (Rabs b)). pose proof (max_real (max real_ops (Rabs a) (Rabs b)) (Rabs c)). lra.
Qed.

(* Differences are computed as 0 only where they are. *)
Lemma difference_zero x y m : number x -> number y -> Rabs (fl (x - y)) <= m -> m <= 0 -> x - y = 0.
Proof.
  intros X Y M N. destruct (difference_approximates x y m X Y M) as (_ & B & _). pose proof (u_positive prec).
  pose proof (Rabs_pos (fl (x - y))). assert (m = 0) by lra. subst m. rewrite Rmult_0_r in B.
  destruct (Req_dec (x - y) 0) as [E | E]; [exact E |]. apply Rabs_pos_lt in E. lra.
Qed.

Definition exact_difference (a b : triple R) : triple R := Triple (at0 b - at0 a) (at1 b - at1 a) (at2 b - at2 a).
Definition point_number (p : triple R) : Prop := number (at0 p) /\ number (at1 p) /\ number (at2 p).

Lemma units_exact k : (0 <= k < 16777216)%Z -> constant real_ops k (- prec) = IZR k * u.
Proof. reflexivity. Qed.

Theorem filter3_correct range a b c d : range_ok range ->
  point_number a -> point_number b -> point_number c -> point_number d ->
  sign_is (filter3 real_ops range a b c d)
          (exact3 (exact_difference a b) (exact_difference a c) (exact_difference a d)).
Proof.
  intros R (A0 & A1 & A2) (B0 & B1 & B2) (C0 & C1 & C2) (D0 & D1 & D2).
  unfold filter3. set (p := difference real_ops a b). set (q := difference real_ops a c).
  set (r := difference real_ops a d).
  destruct (greatest3_real (at0 p) (at0 q) (at0 r)) as (P0 & Q0 & R0).
  destruct (greatest3_real (at1 p) (at1 q) (at1 r)) as (P1 & Q1 & R1).
  destruct (greatest3_real (at2 p) (at2 q) (at2 r)) as (P2 & Q2 & R2).
  set (g0 := greatest3 real_ops (at0 p) (at0 q) (at0 r)) in *.
  set (g1 := greatest3 real_ops (at1 p) (at1 q) (at1 r)) in *.
  set (g2 := greatest3 real_ops (at2 p) (at2 q) (at2 r)) in *.
  unfold filtered_sign. cbn [existsb forallb fold_left]. rewrite model_zero. rewrite !orb_false_r, !andb_true_r.
  cbn [less_equal real_model.real_ops].
  set (x := exact_difference a b). set (y := exact_difference a c). set (z := exact_difference a d).
  destruct (Rle_bool g0 0 || (Rle_bool g1 0 || Rle_bool g2 0)) eqn:Small.
  - apply orb_prop in Small.
    assert (H : g0 <= 0 \/ g1 <= 0 \/ g2 <= 0).
    { destruct Small as [S | S]; [left; revert S; case Rle_bool_spec; [trivial | discriminate] |].
      apply orb_prop in S. right. destruct S as [S | S]; [left | right]; revert S; case Rle_bool_spec; trivial;
        discriminate. }
    unfold sign_is, exact3, x, y, z, exact_difference. cbn [at0 at1 at2].
    destruct H as [H | [H | H]].
    + rewrite (difference_zero _ _ g0 B0 A0 P0 H), (difference_zero _ _ g0 C0 A0 Q0 H),
      (difference_zero _ _ g0 D0 A0 R0 H). ring.
    + rewrite (difference_zero _ _ g1 B1 A1 P1 H), (difference_zero _ _ g1 C1 A1 Q1 H),
      (difference_zero _ _ g1 D1 A1 R1 H). ring.
    + rewrite (difference_zero _ _ g2 B2 A2 P2 H), (difference_zero _ _ g2 C2 A2 Q2 H),
      (difference_zero _ _ g2 D2 A2 R2 H). ring.
  - destruct (_ && _) eqn:In; [| exact Logic.I].
    apply andb_prop in In. destruct In as [I0 In]. apply andb_prop in In. destruct In as [I1 I2].
    apply andb_prop in I0, I1, I2. destruct I0 as [I0 _]. destruct I1 as [I1 _]. destruct I2 as [I2 _].
    cbn [constant real_model.real_ops] in I0, I1, I2. rewrite Rmult_1_l in I0, I1, I2.
    assert (L0 : bpow radix2 (- range) <= g0) by (revert I0; case Rle_bool_spec; [trivial | discriminate]).
    assert (L1 : bpow radix2 (- range) <= g1) by (revert I1; case Rle_bool_spec; [trivial | discriminate]).
    assert (L2 : bpow radix2 (- range) <= g2) by (revert I2; case Rle_bool_spec; [trivial | discriminate]).
    pose proof (bpow_gt_0 radix2 (- range)) as LP.
    assert (NP : near p x (Triple g0 g1 g2)) by (split; [| split]; apply difference_approximates; assumption).
    assert (NQ : near q y (Triple g0 g1 g2)) by (split; [| split]; apply difference_approximates; assumption).
    assert (NR : near r z (Triple g0 g1 g2)) by (split; [| split]; apply difference_approximates; assumption).
    pose proof (determinant3_error p q r x y z (Triple g0 g1 g2) ltac:(simpl; lra) ltac:(simpl; lra) ltac:(simpl; lra)
                  NP NQ NR) as E. cbn [at0 at1 at2] in E.
    pose proof (error3_at_least range g0 g1 g2 R L0 L1 L2) as F.
    destruct (underflow_small range g0 g1 g2 R L0 L1 L2) as (E1 & E2 & _).
    cbn [constant mul less sub precision real_model.real_ops]. fold u.
    replace (IZR 49 * bpow radix2 (- prec)) with (49 * u) by reflexivity.
    set (e := fl (fl (fl (49 * u * g0) * g1) * g2)) in *.
    set (v := determinant3 real_ops p q r) in *.
    assert (UM : 0 <= u * (g0 * (g1 * g2))) by (pose proof (u_positive prec); repeat apply Rmult_le_pos; lra).
    assert (Near : Rabs (v - exact3 x y z) <= e) by lra. apply Rabs_le_inv in Near.
    assert (Opp : fl (0 - e) = - e).
    { unfold Rminus. rewrite Rplus_0_l, (fl_opp prec emin). f_equal. apply (fl_id prec emin), (fl_number prec emin). }
    rewrite Opp. case Rlt_bool_spec; intros V; [simpl; lra |]. case Rlt_bool_spec; intros W; simpl; [lra | trivial].
Qed.
End Orientation.

Lemma range_binary64 : range_ok 53 (-1074) 320.
Proof.
  split; [lia |]. unfold rounding.eta, rounding.u. replace (/ 64) with (bpow radix2 (-6)) by (simpl; lra).
  rewrite <- !bpow_plus. apply bpow_le. lia.
Qed.
