(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* bound_vertex of toolkit/bounds/bound_vertex.cpp,
  by which leaves are bounded: a finite support is at least the vertex,
   exact and as evaluate_vertex computes it. *)
From Coq Require Import Reals Lra Lia ZArith List Bool.
From Flocq Require Import Core.
From CinchProof Require Import duality geometry rounding successor approximation model real_model extremum evaluation
  ieee ieee_dual ieee_extremum ieee_bound_box.
Import ListNotations.
Open Scope R_scope.

Section Real.
Variables prec emin : Z.
Context {format : Format prec emin}.
Notation fl := (fl prec emin).
Notation number := (number prec emin).
Notation u := (u prec).
Notation eta := (eta emin).
Notation real_ops := (real_ops prec emin).
Notation approximates := (approximates prec emin).
Notation growth := (growth prec).
Notation row_number := (row_number prec emin).
Notation is_weight := (is_weight prec emin).
Notation underflow := (underflow prec).

(* The computed magnitude passes as many roundings as the coordinate. *)
Lemma magnitude_row_approximates x r : all_of number x -> row_number r ->
  approximates 4 (magnitude_row real_ops x r) (size_row x r) (size_row x r) (1.52).
Proof.
  intros (X0 & X1 & X2) ((C0 & C1 & C2) & O). pose proof (u_positive prec). pose proof (u_small prec emin).
  assert (P : forall a b, number a -> number b ->
    approximates 1 (Rabs (fl (a * b))) (Rabs a * Rabs b) (Rabs a * Rabs b) (/ 2)).
  { intros a b A B. rewrite <- (Rabs_mult a b) at 1. apply (approximates_abs prec emin).
    apply (approximates_mul prec emin 0 0); now apply (approximates_exact prec emin). }
  assert (Q : approximates 0 (Rabs (offset r)) (Rabs (offset r)) (Rabs (offset r)) 0).
  { apply (approximates_abs prec emin). now apply (approximates_exact prec emin). }
  unfold magnitude_row, size_row, sum3, absolutes. cbn [add mul absolute real_model.real_ops at0 at1 at2].
  eapply (approximates_weaken prec emin); [apply Nat.le_refl | |].
  2: { apply (approximates_add prec emin); [apply (approximates_add prec emin);
    [apply (approximates_add prec emin) |] |].
       - now apply P.
       - now apply P.
       - eapply (approximates_weaken prec emin); [| apply Rle_refl | now apply P]. lia.
       - eapply (approximates_weaken prec emin); [| apply Rle_refl | exact Q]. lia. }
  nra.
Qed.

Lemma magnitude_term x w r : all_of number x -> row_number r -> is_weight w ->
  approximates 5 (fl (w * magnitude_row real_ops x r)) (w * size_row x r) (w * size_row x r) (2.03).
Proof.
  intros X R (F & I). pose proof (u_positive prec). pose proof (u_small prec emin).
  eapply (approximates_weaken prec emin); [apply Nat.le_refl | |].
  2: { apply (approximates_weighted prec emin); [exact F | exact I | | now apply magnitude_row_approximates]. lra. }
  nra.
Qed.

Lemma magnitude_from x nodes : all_of number x ->
  Forall (fun n => is_weight (fst n) /\ row_number (snd n)) nodes ->
  forall n s e, (1 <= n)%nat -> approximates (4 + n) s e e (underflow n) ->
  approximates (4 + (n + length nodes))
    (fold_left (fun sum n => fl (sum + fl (fst n * magnitude_row real_ops x (snd n)))) nodes s)
    (e + size_coordinate x nodes) (e + size_coordinate x nodes) (underflow (n + length nodes)).
Proof.
  intros Fx F. unfold size_coordinate.
  induction F as [| [w r] nodes [W R] _ IH]; intros n s e N A.
  - unfold sum. simpl. rewrite !Rplus_0_r, Nat.add_0_r. exact A.
  - rewrite !sum_cons. cbn [fold_left fst snd length]. rewrite <- !Rplus_assoc.
    replace (n + S (length nodes))%nat with (S n + length nodes)%nat by lia.
    apply IH; [lia |]. cbn [fst snd] in *.
    pose proof (magnitude_term x w r Fx R W) as T. pose proof (u_positive prec) as U.
    pose proof (power_at_least_1 prec n) as Pn.
    eapply (approximates_weaken prec emin); [apply Nat.le_refl | |].
    2: { apply (approximates_add prec emin); [exact A |].
         eapply (approximates_weaken prec emin); [| | exact T]; [lia | apply Rle_refl]. }
    unfold evaluation.underflow. rewrite S_INR. simpl ((1 + u) ^ S n).
    replace (2.03 * (INR n + 1) * ((1 + u) * (1 + u) ^ n))
      with ((1 + u) * (2.03 * INR n * (1 + u) ^ n + 2.03 * (1 + u) ^ n)) by ring.
    apply Rmult_le_compat_l; lra.
Qed.

Lemma coordinate_magnitude_approximates x nodes : all_of number x ->
  Forall (fun n => is_weight (fst n) /\ row_number (snd n)) nodes ->
  approximates (4 + length nodes) (coordinate_magnitude real_ops x nodes) (size_coordinate x nodes)
    (size_coordinate x nodes) (underflow (length nodes)).
Proof.
  intros Fx F. unfold coordinate_magnitude. rewrite model_zero. destruct nodes as [| [w r] nodes].
  - unfold size_coordinate, sum, evaluation.underflow. simpl.
    apply (approximates_weaken prec emin 0 4 0 0 0 0); [lia | lra |]. apply approximates_0; exact format.
  - cbn [fold_left fst snd]. inversion F as [| ? ? [W R] G]; subst. cbn [fst snd] in *.
    pose proof (magnitude_term x w r Fx R W) as T.
    assert (Z0 : add real_ops 0 (mul real_ops w (magnitude_row real_ops x r)) = fl (w * magnitude_row real_ops x r)).
    { cbn [add mul real_model.real_ops]. rewrite Rplus_0_l. apply (fl_id prec emin), (fl_number prec emin). }
    rewrite Z0. change (length ((w, r) :: nodes)) with (1 + length nodes)%nat.
    unfold size_coordinate. rewrite !sum_cons. cbn [fst snd].
    apply (magnitude_from x nodes Fx G 1); [lia |].
    apply (approximates_weaken prec emin 5 (4 + 1) _ _ _ (2.03)); [lia | | exact T].
    unfold evaluation.underflow. pose proof (u_positive prec). simpl. nra.
Qed.

(* evaluation_error of the vertex's own magnitude. *)
Theorem own_error_covers x nodes : all_of number x ->
  Forall (fun n => is_weight (fst n) /\ row_number (snd n)) nodes ->
  nodes <> [] -> INR (length nodes + 8) * INR (length nodes + 8) * u <= 1 ->
  Rabs (evaluate_coordinate real_ops x nodes - exact_coordinate x nodes) <=
  evaluation_error real_ops (length_of nodes) (coordinate_magnitude real_ops x nodes).
Proof.
  intros Fx F Ne S.
  destruct (coordinate_approximates prec emin x nodes Fx F) as (_ & _ & E).
  destruct (coordinate_magnitude_approximates x nodes Fx F) as (_ & P & M). apply Rle_trans with (1 := E). clear E.
  set (X := size_coordinate x nodes) in *. set (B := coordinate_magnitude real_ops x nodes) in *.
  set (n := length nodes) in *.
  assert (X0 : 0 <= X) by (apply Rle_trans with (2 := P); apply Rabs_pos).
  assert (B0 : 0 <= B).
  { assert (R : forall r, 0 <= magnitude_row real_ops x r).
    { intros r. unfold magnitude_row. cbn [add absolute real_model.real_ops].
      repeat (apply (fl_nonnegative prec emin); apply Rplus_le_le_0_compat); apply Rabs_pos. }
    assert (H : forall nodes s, Forall (fun n => is_weight (fst n) /\ row_number (snd n)) nodes -> 0 <= s ->
      0 <= fold_left (fun sum n => add real_ops sum (mul real_ops (fst n) (magnitude_row real_ops x (snd n)))) nodes s).
    { induction nodes0 as [| m nodes0 IH]; intros s G P0; cbn [fold_left]; [exact P0 |].
      inversion G as [| ? ? [[_ W] _] G']; subst. apply IH; [exact G' |]. cbn [add mul real_model.real_ops].
      apply (fl_nonnegative prec emin). apply Rplus_le_le_0_compat; [exact P0 |]. apply (fl_nonnegative prec emin).
      apply Rmult_le_pos; [lra | apply R]. }
    unfold B, coordinate_magnitude. rewrite model_zero. apply H; [exact F | lra]. }
  pose proof (u_positive prec) as U. pose proof (u_small prec emin) as US. pose proof (eta_positive emin) as E0.
  assert (N1 : 1 <= INR n).
  { apply (le_INR 1). unfold n. destruct nodes; [congruence | simpl; lia]. }
  rewrite plus_INR in S. replace (INR 8) with 8 in S by (simpl; ring).
  set (q := (INR n + 8) * u).
  assert (Q0 : 0 <= q) by (apply Rmult_le_pos; lra).
  assert (Q : q <= / 4096).
  { apply Rsqr_incr_0_var; [| lra]. unfold Rsqr.
    replace (q * q) with ((INR n + 8) * (INR n + 8) * u * u) by (unfold q; ring).
    assert ((INR n + 8) * (INR n + 8) * u * u <= 1 * u) by (apply Rmult_le_compat_r; lra). lra. }
  assert (QQ : q * q <= u).
  { replace (q * q) with ((INR n + 8) * (INR n + 8) * u * u) by (unfold q; ring).
    rewrite <- (Rmult_1_l u) at 3. apply Rmult_le_compat_r; lra. }
  assert (IN : INR (4 + n) * u = q - 4 * u).
  { unfold q. rewrite plus_INR. replace (INR 4) with 4 by (simpl; ring). ring. }
  assert (I0 : 0 <= INR (4 + n) * u) by (apply Rmult_le_pos; [apply pos_INR | lra]).
  pose proof (growth_small prec (4 + n) ltac:(lra)) as G.
  assert (G1 : growth (4 + n) <= q - 3 * u).
  { assert (INR (4 + n) * u * (INR (4 + n) * u) <= q * q) by (apply Rmult_le_compat; lra). lra. }
  pose proof (growth_nonnegative prec (4 + n)) as G0.
  assert (IN2 : 0 <= INR n * u <= / 4096) by (split; [apply Rmult_le_pos; lra | unfold q in Q; lra]).
  pose proof (growth_small prec n ltac:(lra)) as Gn. unfold approximation.growth in Gn.
  assert (INR n * u * (INR n * u) <= / 4096 * / 4096) by (apply Rmult_le_compat; lra).
  assert (UF : 0 <= underflow n <= 2.1 * INR n).
  { unfold evaluation.underflow. pose proof (power_at_least_1 prec n). split.
    - apply Rmult_le_pos; lra.
    - assert (INR n * (1 + u) ^ n <= INR n * 1.001) by (apply Rmult_le_compat_l; lra). lra. }
  apply Rabs_le_inv in M.
  set (W := underflow n * eta) in *.
  assert (W0 : 0 <= W) by (apply Rmult_le_pos; lra).
  assert (W1 : W <= 2.1 * INR n * eta) by (apply Rmult_le_compat_r; lra).
  (* X <= (B + W) / (1 - q) *)
  assert (XB : X <= B + W + q * X).
  { assert (growth (4 + n) * X <= q * X) by (apply Rmult_le_compat_r; lra). lra. }
  assert (XB2 : X <= (1001 / 1000) * (B + W)).
  { assert (q * X <= / 4096 * X) by (apply Rmult_le_compat_r; lra). lra. }
  assert (XB3 : X <= B + W + q * ((1001 / 1000) * (B + W))).
  { assert (q * X <= q * ((1001 / 1000) * (B + W))) by (apply Rmult_le_compat_l; lra). lra. }
  assert (GX : growth (4 + n) * X <= (q - 3 * u) * (B + W + q * ((1001 / 1000) * (B + W))))
    by (apply Rmult_le_compat; lra).
  assert (BW : 0 <= B + W) by lra.
  assert (H1 : q * q * (B + W) <= u * (B + W)) by (apply Rmult_le_compat_r; lra).
  assert (H2 : 0 <= u * q * (B + W)) by (apply Rmult_le_pos; [apply Rmult_le_pos |]; lra).
  assert (GX2 : growth (4 + n) * X <= (q - 1.9 * u) * (B + W)).
  { apply Rle_trans with (1 := GX).
    replace ((q - 3 * u) * (B + W + q * ((1001 / 1000) * (B + W))))
      with ((q - 3 * u) * (B + W) + (1001 / 1000) * (q * q * (B + W)) - (3003 / 1000) * (u * q * (B + W))) by field.
    assert (0 <= u * (B + W)) by (apply Rmult_le_pos; lra). lra. }
  (* the term *)
  assert (ZK : IZR (length_of nodes + 8) = INR n + 8)
    by (rewrite plus_IZR; unfold length_of; rewrite <- INR_IZR_INZ; reflexivity).
  assert (Big : (length_of nodes + 8 < 2 ^ prec)%Z).
  { pose proof (@prec_large prec emin format). apply lt_IZR. rewrite IZR_power, ZK by lia.
    assert (HU : u * bpow radix2 prec = 1)
      by (unfold u, rounding.u; rewrite <- bpow_plus, Z.add_opp_diag_l; reflexivity).
    pose proof (bpow_gt_0 radix2 prec).
    assert (Q4 : q * bpow radix2 prec <= / 4096 * bpow radix2 prec) by (apply Rmult_le_compat_r; lra).
    unfold q in Q4. rewrite Rmult_assoc, HU in Q4. lra. }
  assert (L0 : (0 <= length_of nodes)%Z) by apply Zle_0_nat.
  rewrite (model_evaluation_error prec emin) by lia. fold B.
  pose proof (error_term prec emin (length_of nodes + 8) (8 * length_of nodes) B ltac:(lia) B0) as T.
  apply Rle_trans with (2 := T). rewrite ZK, mult_IZR. unfold length_of. fold n. rewrite <- INR_IZR_INZ.
  assert (UB : 0 <= u * B) by (apply Rmult_le_pos; lra).
  assert (QB : q * (u * B) <= / 4096 * (u * B)) by (apply Rmult_le_compat_r; lra).
  assert (QW : (q - 1.9 * u) * W <= / 4096 * W) by (apply Rmult_le_compat_r; lra).
  replace ((INR n + 8) * u * (1 - u) * B) with (q * B - q * (u * B)) by (unfold q; ring).
  replace ((q - 1.9 * u) * (B + W)) with (q * B - 1.9 * (u * B) + (q - 1.9 * u) * W) in GX2 by ring.
  assert (1 * eta <= INR n * eta) by (apply Rmult_le_compat_r; lra). lra.
Qed.
End Real.

Section Ieee.
Variables prec emin : Z.
Context {format : Format prec emin}.
Notation fl := (fl prec emin).
Notation real_ops := (real_ops prec emin).
Context {num : Type} {o : ops num} {view : num -> value}.
Variable I : ieee prec emin o view.
Notation finite := (finite (view := view)).
Notation val := (val (view := view)).
Notation triple_value := (triple_value (view := view)).
Notation row_value := (row_value (view := view)).

Lemma magnitude_row_backward x r : finite (magnitude_row o x r) ->
  val (magnitude_row o x r) = magnitude_row real_ops (triple_value x) (row_value r).
Proof.
  unfold magnitude_row. intros F.
  apply (add_backward prec emin I) in F. destruct F as (F & F3 & ->).
  apply (add_backward prec emin I) in F. destruct F as (F & F2 & ->).
  apply (add_backward prec emin I) in F. destruct F as (F0 & F1 & ->).
  apply (absolute_backward prec emin I) in F0, F1, F2, F3.
  destruct F0 as (F0 & ->). destruct F1 as (F1 & ->). destruct F2 as (F2 & ->). destruct F3 as (_ & ->).
  apply (mul_backward prec emin I) in F0, F1, F2.
  destruct F0 as (_ & _ & ->). destruct F1 as (_ & _ & ->). destruct F2 as (_ & _ & ->). reflexivity.
Qed.

Definition node_values (nodes : list (num * row (num := num))) : list (R * row (num := R)) :=
  map (fun n => (val (fst n), row_value (snd n))) nodes.

Lemma magnitude_backward_sum x nodes : finite (coordinate_magnitude o x nodes) ->
  val (coordinate_magnitude o x nodes) = coordinate_magnitude real_ops (triple_value x) (node_values nodes).
Proof.
  unfold coordinate_magnitude, node_values.
  assert (H : forall s, finite (fold_left (fun sum n => add o sum (mul o (fst n) (magnitude_row o x (snd n)))) nodes
    s) ->
    finite s /\ val (fold_left (fun sum n => add o sum (mul o (fst n) (magnitude_row o x (snd n)))) nodes s) =
    fold_left (fun sum n => add real_ops sum (mul real_ops (fst n) (magnitude_row real_ops (triple_value x) (snd n))))
      (map (fun n => (val (fst n), row_value (snd n))) nodes) (val s)).
  { induction nodes as [| [w r] nodes IH]; intros s F; cbn [fold_left map fst snd] in *; [auto |].
    destruct (IH _ F) as [S ->]. apply (add_backward prec emin I) in S. destruct S as (S & P & ->).
    apply (mul_backward prec emin I) in P. destruct P as (_ & P & ->). rewrite (magnitude_row_backward x r P). auto. }
  intros F. destruct (H _ F) as [_ ->]. now rewrite (proj2 (zero_value prec emin I)), model_zero.
Qed.

(* One coordinate is added, rounded up: at least the sum with anything that its error term covers. *)
Lemma upper_step_sound sign c e s x : (-1 <= sign <= 1)%Z -> finite (upper_step o sign c e s) ->
  (finite c -> finite e -> Rabs (val c - x) <= val e) ->
  finite s /\ val s + IZR sign * x <= val (upper_step o sign c e s) /\
  (sign <> 0%Z -> val s + IZR sign * val c <= val (upper_step o sign c e s)).
Proof.
  intros S F C. unfold upper_step in *. destruct (Z.eqb_spec sign 0) as [-> | N].
  { split; [exact F |]. split; [lra | congruence]. }
  set (upper := model.succ o (add o (mul o (constant o sign 0) c) e)) in *.
  assert (U : finite upper -> IZR sign * x <= val upper /\ IZR sign * val c <= val upper).
  { intros Fu. unfold upper in *. apply (succ_backward prec emin I) in Fu. destruct Fu as (Fu & ->).
    apply (add_backward prec emin I) in Fu. destruct Fu as (Fm & Fe & ->).
    apply (mul_backward prec emin I) in Fm. destruct Fm as (_ & Fc & ->). specialize (C Fc Fe).
    destruct (sign_value prec emin I sign S) as [_ ->]. simpl (bpow radix2 0). rewrite Rmult_1_r.
    rewrite (signed_exact prec emin) by (exact S || apply (val_number prec emin I)).
    rewrite (model_succ prec emin). pose proof (below_succ_fl prec emin (IZR sign * val c + val e)) as B.
    pose proof (Rabs_pos (val c - x)). apply Rabs_le_inv in C.
    assert (Sg : sign = (-1)%Z \/ sign = 1%Z) by lia. destruct Sg as [-> | ->]; lra. }
  destruct (zero_value prec emin I) as [Z0 V0].
  destruct (less_equal o s (zero o) && less_equal o (zero o) s) eqn:Q.
  - apply andb_prop in Q. destruct Q as [Q1 Q2].
    rewrite (law_less_equal _ _ _ _ I), (view_val _ Z0) in Q1, Q2.
    assert (Fs : finite s) by (unfold ieee.finite; destruct (view s) as [r | | |]; try discriminate; now exists r).
    rewrite (view_val _ Fs), V0 in Q1, Q2. cbn [less_equal_value] in Q1, Q2.
    assert (Vs : val s = 0).
    { revert Q1 Q2. case Rle_bool_spec; [| discriminate]. intros A _. case Rle_bool_spec; [lra | discriminate]. }
    destruct (U F) as [U1 U2]. split; [exact Fs |]. rewrite Vs. split; [lra | intros _; lra].
  - apply (succ_backward prec emin I) in F. destruct F as (F & ->).
    apply (add_backward prec emin I) in F. destruct F as (Fs & Fu & ->). destruct (U Fu) as [U1 U2].
    rewrite (model_succ prec emin). pose proof (below_succ_fl prec emin (val s + val upper)).
    split; [exact Fs |]. split; [lra | intros _; lra].
Qed.

Theorem bound_vertex_sound along axis x nodes :
  is_axis axis -> few_influences prec (length nodes) -> Forall (fun n => 0 <= val (fst n) <= 1) nodes ->
  finite (bound_vertex o along axis x nodes) ->
  let support := val (bound_vertex o along axis x nodes) in
  side along * along_axis axis (exact_vertex (triple_value x) (row_values (view := view) nodes)) <= support /\
  (all_finite (view := view) (evaluate_vertex o x nodes) ->
   side along * along_axis axis (triple_value (evaluate_vertex o x nodes)) <= support).
Proof.
  intros (A0 & A1 & A2) K W F support. unfold support. clear support.
  pose (rows := fun f : map_rows (num := num) -> row (num := num) => map (fun n => (fst n, f (snd n))) nodes).
  pose (error := fun f => evaluation_error o (length_of nodes) (coordinate_magnitude o x (rows f))).
  pose (sign := fun a => if along then a else (- a)%Z).
  pose (s0 := upper_step o (sign (at0 axis)) (evaluate_coordinate o x (rows at0)) (error at0) (zero o)).
  pose (s1 := upper_step o (sign (at1 axis)) (evaluate_coordinate o x (rows at1)) (error at1) s0).
  pose (s2 := upper_step o (sign (at2 axis)) (evaluate_coordinate o x (rows at2)) (error at2) s1).
  assert (E : bound_vertex o along axis x nodes = s2).
  { unfold bound_vertex in F |- *. cbv zeta in F |- *.
    match type of F with ieee.finite (if ?c then _ else _) => destruct c end; [reflexivity |].
    now apply (infinity_not_finite prec emin I) in F. }
  rewrite E in *. clear E.
  assert (SG : forall a, (-1 <= a <= 1)%Z -> (-1 <= sign a <= 1)%Z) by (intros a Ia; unfold sign; destruct along; lia).
  assert (C : forall f g, (forall m, row_value (f m) = g (map_value (view := view) m)) ->
    (forall m, row_number prec emin (g (map_value (view := view) m))) ->
    finite (evaluate_coordinate o x (rows f)) -> finite (error f) ->
    Rabs (val (evaluate_coordinate o x (rows f)) -
          exact_coordinate (triple_value x) (rows_of g (row_values (view := view) nodes))) <= val (error f)).
  { intros f g Hf Hn Fc Fe. unfold error in *.
    apply (evaluation_error_backward prec emin I) in Fe; [| apply Zle_0_nat | now apply (few_is_small prec emin)].
    destruct Fe as (Fm & ->). rewrite (coordinate_backward prec emin I _ _ Fc), (magnitude_backward_sum _ _ Fm).
    assert (E : node_values (rows f) = rows_of g (row_values (view := view) nodes)).
    { unfold node_values, rows, rows_of, row_values. rewrite !map_map. apply map_ext. intros n. cbn [fst snd].
    now rewrite Hf. }
    unfold node_values in E |- *. rewrite E. unfold length_of.
    destruct nodes as [| n0 rest] eqn:En.
    - unfold rows_of, row_values, evaluate_coordinate, exact_coordinate, sum. cbn [map fold_left fold_right].
      rewrite model_zero, Rminus_0_r, Rabs_R0. destruct K as [K1 _]. simpl in K1. lia.
    - rewrite <- En in *. replace (Z.of_nat (length nodes)) with
        (length_of (rows_of g (row_values (view := view) nodes)))
        by (unfold length_of, rows_of, row_values; now rewrite !map_length).
      apply own_error_covers; try exact format.
      + repeat split; apply (val_number prec emin I).
      + unfold rows_of, row_values. rewrite map_map. apply Forall_map. apply Forall_impl with (2 := W).
        intros n Wn. cbn [fst snd]. split; [split; [apply (val_number prec emin I) | exact Wn] | apply Hn].
      + rewrite En. discriminate.
      + unfold rows_of, row_values. rewrite !map_length. apply K. }
  assert (RN : forall r, row_number prec emin (row_value r)) by (intros r; repeat split;
    apply (val_number prec emin I)).
  destruct (upper_step_sound _ _ _ _ _ (SG _ A2) F (C at2 at2 (fun m => eq_refl) (fun m => RN (at2 m)))) as (F1 & U2
    & V2).
  destruct (upper_step_sound _ _ _ _ _ (SG _ A1) F1 (C at1 at1 (fun m => eq_refl) (fun m => RN (at1 m)))) as (F0 & U1
    & V1).
  destruct (upper_step_sound _ _ _ _ _ (SG _ A0) F0 (C at0 at0 (fun m => eq_refl) (fun m => RN (at0 m)))) as (_ & U0
    & V0).
  fold s2 in U2, V2. fold s1 in U1, V1. fold s0 in U0, V0. destruct (zero_value prec emin I) as [_ VZ].
  rewrite VZ in U0, V0.
  assert (SI : forall a, IZR (sign a) = side along * IZR a).
  { intros a. unfold sign, side. destruct along; [ring |]. rewrite opp_IZR. ring. }
  rewrite SI in U0, U1, U2. split.
  - unfold along_axis, exact_vertex. cbn [at0 at1 at2]. lra.
  - intros _. unfold along_axis, ieee_extremum.triple_value. cbn [at0 at1 at2 evaluate_vertex].
    fold (rows at0). fold (rows at1). fold (rows at2).
    assert (H : forall a s s' c, (IZR (sign a) * c + s <= s' \/ a = 0%Z /\
      s <= s') -> side along * (IZR a * c) + s <= s').
    { intros a s s' c [L | [-> L]]; [rewrite SI in L; lra | lra]. }
    assert (Z0 : forall a, (a = 0%Z \/ sign a <> 0%Z)) by (intros a; unfold sign; destruct along; lia).
    assert (H0 := H (at0 axis) 0 (val s0) (val (evaluate_coordinate o x (rows at0)))).
    assert (H1 := H (at1 axis) (val s0) (val s1) (val (evaluate_coordinate o x (rows at1)))).
    assert (H2 := H (at2 axis) (val s1) (val s2) (val (evaluate_coordinate o x (rows at2)))).
    assert (L0 : side along * (IZR (at0 axis) * val (evaluate_coordinate o x (rows at0))) + 0 <= val s0).
    { apply H0. destruct (Z0 (at0 axis)) as [E | E]; [right; split; [exact E |]; rewrite E in U0; lra | left].
      specialize (V0 E). lra. }
    assert (L1 : side along * (IZR (at1 axis) * val (evaluate_coordinate o x (rows at1))) + val s0 <= val s1).
    { apply H1. destruct (Z0 (at1 axis)) as [E | E]; [right; split; [exact E |]; rewrite E in U1; lra | left].
      specialize (V1 E). lra. }
    assert (L2 : side along * (IZR (at2 axis) * val (evaluate_coordinate o x (rows at2))) + val s1 <= val s2).
    { apply H2. destruct (Z0 (at2 axis)) as [E | E]; [right; split; [exact E |]; rewrite E in U2; lra | left].
      specialize (V2 E). lra. }
    lra.
Qed.
End Ieee.
