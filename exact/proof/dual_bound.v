(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* dual_bound of toolkit/bounds/weight_space.cpp: what it computes is at least the exact D(lambda) of the numbers given.
   Every rounding is bounded by u times its computed result,
     so that no gamma_k and no small number of terms is needed. *)
From Coq Require Import Reals Lra Lia ZArith List.
From Flocq Require Import Core.
From CinchProof Require Import duality rounding successor model real_model.
Import ListNotations.
Open Scope R_scope.

Section Dual_bound.
Variables prec emin : Z.
Context {format : Format prec emin}.
Notation fl := (fl prec emin).
Notation number := (number prec emin).
Notation u := (u prec).
Notation eta := (eta emin).
Notation real_ops := (real_ops prec emin).

Definition node_of_entry (e : entry) : node := Node (entry_l e) (entry_h e) (entry_b e).
Definition entry_number (e : entry) : Prop := number (entry_l e) /\ number (entry_h e) /\ number (entry_b e).
Definition selected (lambda : R) (e : entry) : R := if Rle_dec lambda (entry_b e) then entry_h e else entry_l e.
Definition exact_product (lambda : R) (e : entry) : R := selected lambda e * (entry_b e - lambda).

Lemma exact_dual lambda nodes :
  dual lambda (map node_of_entry nodes) = lambda + sum (exact_product lambda) nodes.
Proof.
  unfold dual. f_equal. rewrite sum_map. apply sum_ext. apply Forall_forall. intros e _.
  rewrite dual_term_selects. reflexivity.
Qed.

(* fl(b - lambda) has the sign of b - lambda. *)
Lemma same_sign lambda b : number lambda -> number b -> Rle_bool 0 (fl (b - lambda)) = (if Rle_dec lambda b then true
  else false).
Proof.
  intros L B. destruct (Rle_dec lambda b) as [G | N].
  - apply Rle_bool_true. apply (fl_nonnegative prec emin). lra.
  - apply Rle_bool_false. apply Rnot_le_lt in N.
    pose proof (fl_plus_error prec emin b (- lambda) B (number_opp prec emin _ L)) as E.
    replace (b + - lambda) with (b - lambda) in E by ring. rewrite (Rabs_left (b - lambda)) in E by lra.
    apply Rabs_le_inv in E. pose proof (u_small prec emin). pose proof (u_positive prec). nra.
Qed.

Lemma product_number lambda e : number (dual_product real_ops lambda e).
Proof. apply (fl_number prec emin). Qed.

Lemma product_error lambda e :
  number lambda -> entry_number e ->
  Rabs (dual_product real_ops lambda e - exact_product lambda e) <=
  (2 + u) * u * Rabs (dual_product real_ops lambda e) + (1 + u) * eta / 2.
Proof.
  intros L (_ & _ & B). unfold dual_product, exact_product, selected. rewrite model_zero. simpl.
  rewrite same_sign by assumption.
  replace (if if Rle_dec lambda (entry_b e) then true else false then entry_h e else entry_l e)
    with (selected lambda e) by (unfold selected; destruct (Rle_dec lambda (entry_b e)); reflexivity).
  fold (selected lambda e). set (w := selected lambda e). set (a := fl (entry_b e - lambda)).
  set (d := entry_b e - lambda). set (t := fl (w * a)).
  pose proof (fl_error_result prec emin (w * a)) as T. fold t in T.
  pose proof (fl_plus_error_result prec emin (entry_b e) (- lambda) B (number_opp prec emin _ L)) as E.
  replace (entry_b e + - lambda) with d in E by (unfold d; ring). fold a in E.
  pose proof (u_positive prec). pose proof (u_small prec emin). pose proof (eta_positive emin).
  assert (W : Rabs (w * a - w * d) <= u * Rabs (w * a)).
  { rewrite <- Rmult_minus_distr_l, 2!Rabs_mult.
    replace (u * (Rabs w * Rabs a)) with (Rabs w * (u * Rabs a)) by ring.
    apply Rmult_le_compat_l; [apply Rabs_pos | exact E]. }
  assert (V : Rabs (w * a) <= Rabs t + (u * Rabs t + eta / 2)).
  { replace (w * a) with (t - (t - w * a)) by ring. pose proof (Rabs_triang t (- (t - w * a))) as Q.
    rewrite Rabs_Ropp in Q. unfold Rminus at 1. lra. }
  replace (t - w * d) with ((t - w * a) + (w * a - w * d)) by ring.
  pose proof (Rabs_triang (t - w * a) (w * a - w * d)). pose proof (Rabs_pos t).
  assert (u * Rabs (w * a) <= u * (Rabs t + (u * Rabs t + eta / 2))) by (apply Rmult_le_compat_l; lra).
  nra.
Qed.

(* After some nodes: the computed sums s and A, the exact sum T, and the exact sum P of the computed |products|. *)
Record invariant (n T P s A : R) : Prop := Invariant {
  inv_s : number s; inv_A : number A;
  inv_below : Rabs s <= A;
  inv_error : Rabs (s - T) <= n * u * A + (2 + u) * u * P + n * ((1 + u) * eta / 2);
  inv_products : 0 <= P <= A + n * u * A
}.

Lemma invariant_step lambda e n T P s A :
  number lambda -> entry_number e -> 0 <= n -> invariant n T P s A ->
  let t := dual_product real_ops lambda e in
  invariant (n + 1) (T + exact_product lambda e) (P + Rabs t) (fl (s + t)) (fl (A + Rabs t)).
Proof.
  intros L E N [Fs FA B I J] t.
  pose proof (u_positive prec) as U. pose proof (eta_positive emin).
  assert (Ft : number t) by apply product_number.
  pose proof (product_error lambda e L E) as PE. fold t in PE.
  pose proof (Rabs_pos t) as At. pose proof (Rabs_pos s) as As.
  assert (G : A <= fl (A + Rabs t)) by (apply (fl_above prec emin); [lra | exact FA]).
  assert (S : Rabs (fl (s + t)) <= fl (A + Rabs t)).
  { rewrite <- (fl_abs prec emin). apply (fl_le prec emin). pose proof (Rabs_triang s t). lra. }
  pose proof (fl_plus_error_result prec emin s t Fs Ft) as RS.
  pose proof (fl_plus_error_result prec emin A (Rabs t) FA (number_abs prec emin _ Ft)) as RA.
  set (A' := fl (A + Rabs t)) in *. rewrite (Rabs_pos_eq A') in RA by lra. apply Rabs_le_inv in RA.
  constructor; try now apply (fl_number prec emin).
  - exact S.
  - replace (fl (s + t) - (T + exact_product lambda e))
      with ((fl (s + t) - (s + t)) + ((s - T) + (t - exact_product lambda e))) by ring.
    pose proof (Rabs_triang (fl (s + t) - (s + t)) ((s - T) + (t - exact_product lambda e))).
    pose proof (Rabs_triang (s - T) (t - exact_product lambda e)).
    assert (n * u * A <= n * u * A') by (apply Rmult_le_compat_l; [nra | exact G]).
    assert (u * Rabs (fl (s + t)) <= u * A') by (apply Rmult_le_compat_l; lra).
    lra.
  - assert (n * u * A <= n * u * A') by (apply Rmult_le_compat_l; [nra | exact G]). lra.
Qed.

Lemma sums_invariant lambda nodes n T P s A :
  number lambda -> Forall entry_number nodes -> 0 <= n -> invariant n T P s A ->
  exists P', let r := fold_left (dual_step real_ops lambda) nodes (s, A) in
  invariant (n + IZR (length_of nodes)) (T + sum (exact_product lambda) nodes) P' (fst r) (snd r).
Proof.
  intros L F. revert n T P s A. induction F as [| e nodes E _ IH]; intros n T P s A N I.
  - exists P. unfold length_of, sum. simpl. now rewrite !Rplus_0_r.
  - pose proof (invariant_step lambda e n T P s A L E N I) as J. simpl in J.
    destruct (IH _ _ _ _ _ (Rplus_le_le_0_compat n 1 N Rle_0_1) J) as [P' K]. exists P'.
    rewrite sum_cons. replace (n + IZR (length_of (e :: nodes))) with (n + 1 + IZR (length_of nodes)).
    + rewrite <- Rplus_assoc. exact K.
    + unfold length_of. simpl length. rewrite Nat2Z.inj_succ, succ_IZR. ring.
Qed.

Lemma invariant_0 : invariant 0 0 0 0 0.
Proof.
  pose proof (eta_positive emin).
  constructor; try apply (number_0 prec emin); rewrite ?Rminus_0_r, ?Rabs_R0; lra.
Qed.

(* The error term covers it. *)
Lemma sum_error_covers n T P s A :
  (1 <= n)%Z -> IZR n * u <= / 8 -> (n + 4 < 2 ^ prec)%Z -> invariant (IZR n) T P s A ->
  Rabs (s - T) <= sum_error real_ops n A.
Proof.
  intros N NU NP [_ FA B I J]. rewrite (model_sum_error prec emin n A (Z.le_trans 0 1 n Z.le_0_1 N) NP).
  pose proof (u_positive prec) as U. pose proof (u_small prec emin) as US. pose proof (eta_positive emin).
  assert (PA : 0 <= A) by (pose proof (Rabs_pos s); lra).
  assert (N0 : 0 <= IZR n) by (apply IZR_le; lia).
  apply Rle_trans with (1 := I).
  destruct (Req_dec A 0) as [-> | NZ].
  - rewrite !Rmult_0_r in *. assert (P = 0) by lra. subst P. rewrite Rmult_0_r, !Rplus_0_l.
    pose proof (error_term_0 prec emin (n + 4) n) as E. rewrite Rmult_0_r in E.
    assert (IZR n * ((1 + u) * eta / 2) <= IZR n * eta) by (apply Rmult_le_compat_l; nra). lra.
  - assert (EA : eta <= A) by (apply (number_bit prec emin); [exact FA | lra]).
    pose proof (error_term prec emin (n + 4) n A ltac:(lia) PA) as E.
    rewrite plus_IZR in E |- *.
    assert (NA : IZR n * u * A <= / 8 * A) by now apply Rmult_le_compat_r.
    assert (HP : (2 + u) * u * P <= (2 + u) * u * (A + / 8 * A)).
    { apply Rmult_le_compat_l; [apply Rmult_le_pos |]; lra. }
    set (X := u * A) in *. assert (XP : 0 <= X) by (apply Rmult_le_pos; lra).
    assert (X1 : u * eta <= X) by (apply Rmult_le_compat_l; lra).
    assert (X2 : u * X <= / 16777216 * X) by now apply Rmult_le_compat_r.
    assert (X3 : IZR n * u * X <= / 8 * X) by now apply Rmult_le_compat_r.
    replace (IZR n * u * A) with (IZR n * X) by (unfold X; ring).
    replace ((2 + u) * u * (A + / 8 * A)) with (9 / 4 * X + 9 / 8 * (u * X)) in HP by (unfold X; field).
    replace ((IZR n + 4) * u * (1 - u) * A)
      with (IZR n * X + 4 * X - IZR n * u * X - 4 * (u * X)) in E by (unfold X; ring).
    assert (ET : IZR n * ((1 + u) * eta / 2) <= (IZR n - / 2) * eta + u * eta); [| lra].
    assert (N1 : 1 <= IZR n) by (apply IZR_le; lia).
    assert (0 <= (IZR n - 1) * (1 - u) * eta) by (repeat apply Rmult_le_pos; lra).
    assert (0 <= u * eta) by (apply Rmult_le_pos; lra). lra.
Qed.

Lemma small_count n : IZR n * u <= / 8 -> (n + 4 < 2 ^ prec)%Z.
Proof.
  intros S. pose proof (@prec_large prec emin format) as PL. apply lt_IZR. rewrite plus_IZR, IZR_power by lia.
  assert (H : u * bpow radix2 prec = 1) by (unfold u, rounding.u; rewrite <- bpow_plus, Z.add_opp_diag_l; reflexivity).
  assert (16777216 <= bpow radix2 prec).
  { replace 16777216 with (bpow radix2 24) by (simpl; lra). now apply bpow_le. }
  assert (IZR n * (u * bpow radix2 prec) <= / 8 * bpow radix2 prec).
  { rewrite <- Rmult_assoc. apply Rmult_le_compat_r; lra. }
  rewrite H, Rmult_1_r in *. lra.
Qed.

Theorem dual_bound_at_least_exact lambda nodes :
  number lambda -> Forall entry_number nodes ->
  IZR (length_of nodes) * u <= / 8 ->
  dual lambda (map node_of_entry nodes) <= dual_value real_ops lambda nodes.
Proof.
  intros L F S.
  destruct nodes as [| first others].
  { unfold dual, dual_value, dual_sums. rewrite model_zero. cbn [fold_left map]. rewrite !(model_succ prec emin).
  unfold sum.
    cbn [fold_right]. rewrite Rplus_0_r. cbn [add real_model.real_ops].
    assert (E : 0 <= sum_error real_ops (length_of (@nil (entry (num := R)))) 0).
    { change (length_of []) with 0%Z. rewrite (model_sum_error prec emin 0 0);
        [| lia | apply small_count; rewrite Rmult_0_l; lra].
      apply Rle_trans with (IZR 0 * eta); [lra |]. now apply (error_term_0 prec emin 4 0). }
    set (e := sum_error real_ops (length_of []) 0) in *.
    pose proof (below_succ_fl prec emin (0 + e)) as B1.
    pose proof (below_succ_fl prec emin (lambda + successor.succ prec emin (fl (0 + e)))) as B2.
    cbn [snd] in *. lra. }
  set (nodes := first :: others) in *.
  destruct (sums_invariant lambda nodes 0 0 0 0 0 L F (Rle_refl 0) invariant_0) as [P I].
  rewrite !Rplus_0_l in I. unfold dual_value, dual_sums. rewrite model_zero.
  destruct (fold_left (dual_step real_ops lambda) nodes (0, 0)) as [s A]. simpl in I.
  assert (N0 : (1 <= length_of nodes)%Z) by (unfold length_of, nodes; simpl length; lia).
  assert (NP : (length_of nodes + 4 < 2 ^ prec)%Z) by now apply small_count.
  pose proof (sum_error_covers _ _ _ _ _ N0 S NP I) as C. apply Rabs_le_inv in C.
  rewrite exact_dual, !(model_succ prec emin). cbn [add real_model.real_ops].
  set (e := sum_error real_ops (length_of nodes) A) in *.
  pose proof (below_succ_fl prec emin (s + e)) as B1.
  pose proof (below_succ_fl prec emin (lambda + successor.succ prec emin (fl (s + e)))) as B2. lra.
Qed.

(* So it is at least every mean of W', for every lambda. *)
Corollary dual_bound_at_least_mean lambda nodes weights :
  number lambda -> Forall entry_number nodes -> IZR (length_of nodes) * u <= / 8 ->
  map fst weights = map node_of_entry nodes -> in_space weights ->
  mean weights <= dual_value real_ops lambda nodes.
Proof.
  intros L F S E W. apply Rle_trans with (dual lambda (map fst weights)); [now apply weak_duality |].
  rewrite E. now apply dual_bound_at_least_exact.
Qed.
End Dual_bound.
