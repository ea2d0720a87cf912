(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* The filter of toolkit/collide/orientation.cpp in two dimensions. *)
From Coq Require Import Reals Lra Lia ZArith List Bool.
From Flocq Require Import Core.
From CinchProof Require Import rounding approximation model real_model orientation.
Import ListNotations.
Open Scope R_scope.

Section Orientation2.
Variables prec emin : Z.
Context {format : Format prec emin}.
Notation fl := (fl prec emin).
Notation number := (number prec emin).
Notation u := (u prec).
Notation eta := (eta emin).
Notation real_ops := (real_ops prec emin).
Notation range_ok := (range_ok prec emin).

Lemma error2_at_least range m0 m1 : range_ok range ->
  bpow radix2 (- range) <= m0 -> bpow radix2 (- range) <= m1 ->
  8.9 * u * (m0 * m1) <= fl (fl (9 * u * m0) * m1) /\ eta <= / 64 * u * (m0 * m1).
Proof.
  intros R A0 A1.
  assert (L1 : bpow radix2 (- range) <= 1).
  { destruct R as [R _]. change 1 with (bpow radix2 0). apply bpow_le. lia. }
  destruct (underflow_small prec emin range m0 m1 1 R A0 A1 L1) as (E1 & _ & _ & E4).
  rewrite Rmult_1_r in E1, E4. split; [| exact E1].
  pose proof (u_positive prec) as U. pose proof (u_small prec emin) as US. pose proof (eta_positive emin) as E0.
  pose proof (bpow_gt_0 radix2 (- range)) as LP. set (M := m0 * m1) in *.
  assert (MP : 0 <= M) by (apply Rmult_le_pos; lra).
  pose proof (product_at_least prec emin (9 * u) m0 (9 * u) ltac:(lra) ltac:(lra) (Rle_refl _)) as B1.
  set (c1 := 9 * u * m0 * (1 - u) - eta / 2) in *.
  assert (C1 : 0 <= c1).
  { assert (Q : eta <= / 64 * u * m0).
    { apply Rmult_le_reg_r with m1; [lra |]. replace (/ 64 * u * m0 * m1) with (/ 64 * u * M) by (unfold M; ring).
    exact E4. }
    assert (0 <= u * m0) by (apply Rmult_le_pos; lra).
    assert (u * m0 * u <= u * m0 * / 16777216) by (apply Rmult_le_compat_l; lra). unfold c1. lra. }
  pose proof (product_at_least prec emin _ m1 c1 ltac:(lra) C1 B1) as B2. apply Rle_trans with (2 := B2). unfold c1.
  assert (UM : 0 <= u * M) by (apply Rmult_le_pos; lra).
  assert (UUM : u * u * M <= / 16777216 * u * M) by (rewrite !(Rmult_assoc _ u M); apply Rmult_le_compat_r; lra).
  assert (U4 : 0 <= u * u * u * M) by (repeat apply Rmult_le_pos; lra).
  assert (V1 : 0 <= u * (eta * m1)) by (repeat apply Rmult_le_pos; lra).
  replace ((9 * u * m0 * (1 - u) - eta / 2) * m1 * (1 - u) - eta / 2)
    with (9 * (u * M) - 18 * (u * u * M) + 9 * (u * u * u * M) - (eta * m1) / 2 + u * (eta * m1) / 2 - eta / 2)
    by (unfold M; field).
  lra.
Qed.

Theorem filter2_correct range a0 a1 b0 b1 c0 c1 : range_ok range ->
  number a0 -> number a1 -> number b0 -> number b1 -> number c0 -> number c1 ->
  sign_is (filter2 real_ops range a0 a1 b0 b1 c0 c1) ((b0 - a0) * (c1 - a1) - (b1 - a1) * (c0 - a0)).
Proof.
  intros R A0 A1 B0 B1 C0 C1. unfold filter2. cbn [sub absolute real_model.real_ops].
  set (p0 := fl (b0 - a0)). set (p1 := fl (b1 - a1)). set (q0 := fl (c0 - a0)). set (q1 := fl (c1 - a1)).
  pose proof (max_real prec emin (Rabs p0) (Rabs q0)) as (P0 & Q0).
  pose proof (max_real prec emin (Rabs p1) (Rabs q1)) as (P1 & Q1).
  set (g0 := max real_ops (Rabs p0) (Rabs q0)) in *. set (g1 := max real_ops (Rabs p1) (Rabs q1)) in *.
  unfold filtered_sign. cbn [existsb forallb fold_left]. rewrite model_zero, !orb_false_r, !andb_true_r.
  cbn [less_equal real_model.real_ops].
  destruct (Rle_bool g0 0 || Rle_bool g1 0) eqn:Small.
  - apply orb_prop in Small.
    assert (H : g0 <= 0 \/ g1 <= 0)
      by (destruct Small as [S | S]; [left | right]; revert S; case Rle_bool_spec; trivial; discriminate).
    unfold sign_is. destruct H as [H | H].
    + rewrite (difference_zero prec emin _ _ g0 B0 A0 P0 H), (difference_zero prec emin _ _ g0 C0 A0 Q0 H). ring.
    + rewrite (difference_zero prec emin _ _ g1 B1 A1 P1 H), (difference_zero prec emin _ _ g1 C1 A1 Q1 H). ring.
  - destruct (_ && _) eqn:In; [| exact Logic.I].
    apply andb_prop in In. destruct In as [I0 I1]. apply andb_prop in I0, I1. destruct I0 as [I0 _].
    destruct I1 as [I1 _].
    cbn [constant real_model.real_ops] in I0, I1. rewrite Rmult_1_l in I0, I1.
    assert (L0 : bpow radix2 (- range) <= g0) by (revert I0; case Rle_bool_spec; [trivial | discriminate]).
    assert (L1 : bpow radix2 (- range) <= g1) by (revert I1; case Rle_bool_spec; [trivial | discriminate]).
    pose proof (bpow_gt_0 radix2 (- range)) as LP.
    pose proof (determinant2_error prec emin p0 p1 q0 q1 (b0 - a0) (b1 - a1) (c0 - a0) (c1 - a1) g0 g1
                  ltac:(lra) ltac:(lra)
                  (difference_approximates prec emin _ _ _ B0 A0 P0) (difference_approximates prec emin _ _ _ B1 A1 P1)
                  (difference_approximates prec emin _ _ _ C0 A0 Q0) (difference_approximates prec emin _ _ _ C1 A1
                    Q1)) as E.
    destruct (error2_at_least range g0 g1 R L0 L1) as [F E1].
    cbn [constant mul less sub precision real_model.real_ops]. fold u.
    replace (IZR 9 * bpow radix2 (- prec)) with (9 * u) by reflexivity.
    set (e := fl (fl (9 * u * g0) * g1)) in *. set (v := determinant2 real_ops p0 p1 q0 q1) in *.
    set (x := (b0 - a0) * (c1 - a1) - (b1 - a1) * (c0 - a0)) in *.
    assert (UM : 0 <= u * (g0 * g1)) by (pose proof (u_positive prec); repeat apply Rmult_le_pos; lra).
    assert (Near : Rabs (v - x) <= e) by lra. apply Rabs_le_inv in Near.
    assert (Opp : fl (0 - e) = - e).
    { unfold Rminus. rewrite Rplus_0_l, (fl_opp prec emin). f_equal. apply (fl_id prec emin), (fl_number prec emin). }
    rewrite Opp. case Rlt_bool_spec; intros V; [simpl; lra |]. case Rlt_bool_spec; intros W; simpl; [lra | trivial].
Qed.
End Orientation2.
