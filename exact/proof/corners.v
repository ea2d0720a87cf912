(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* best_corner of toolkit/bounds/bound_box.cpp: the greatest of the n(n - 1) corners of section 5.2.2 with its error
   term is at least every mean of W'. With rounding and underflow; overflow is dealt with in ieee_corners.v. *)
From Coq Require Import Reals Lra Lia ZArith List Permutation.
From Flocq Require Import Core.
From CinchProof Require Import duality rounding successor approximation model real_model dual_bound.
Import ListNotations.
Open Scope R_scope.

(* The two greatest of at least two. *)
Lemma greatest_first {A} (f : A -> R) a s :
  exists b t, Permutation (a :: s) (b :: t) /\ Forall (fun c => f c <= f b) t.
Proof.
  revert a. induction s as [| c s IH]; intros a; [exists a, []; split; [apply Permutation_refl | constructor] |].
  destruct (IH c) as (b & t & P & F). destruct (Rle_or_lt (f a) (f b)) as [L | L].
  - exists b, (a :: t). split; [| now constructor].
    apply Permutation_trans with (a :: b :: t); [now constructor | apply perm_swap].
  - exists a, (b :: t). split; [now constructor |]. constructor; [lra |].
    apply Forall_impl with (2 := F). intros d D. lra.
Qed.

Lemma two_greatest_exist {A} (f : A -> R) a1 a2 s : exists b1 b2 t,
  Permutation (a1 :: a2 :: s) (b1 :: b2 :: t) /\ f b2 <= f b1 /\ Forall (fun c => f c <= f b2) t.
Proof.
  destruct (greatest_first f a1 (a2 :: s)) as (b1 & r & P & F).
  destruct r as [| c r]; [apply Permutation_length in P; discriminate |].
  destruct (greatest_first f c r) as (b2 & t & Q & G). exists b1, b2, t.
  split; [apply Permutation_trans with (1 := P); now constructor |]. split; [| exact G].
  apply (Permutation_Forall Q) in F. now apply Forall_inv in F.
Qed.

(* Each entry is picked once, with all others. *)
Lemma picks_in {A} (s : list A) : forall before a t, Permutation (a :: t) s ->
  exists others, In (a, before ++ others) (picks before s) /\ Permutation others t.
Proof.
  induction s as [| c s IH]; intros before a t P; [apply Permutation_sym, Permutation_nil in P; discriminate |].
  destruct (Permutation_in a P (or_introl eq_refl)) as [-> | In].
  - exists s. split; [now left |]. apply Permutation_sym. now apply Permutation_cons_inv with a.
  - apply in_split in In. destruct In as (s1 & s2 & E).
    assert (Q : Permutation (a :: s1 ++ s2) s) by (rewrite E; apply Permutation_middle).
    destruct (IH (before ++ [c]) a (s1 ++ s2) Q) as (others & I & R). exists (c :: others). split.
    + right. rewrite <- app_assoc in I. exact I.
    + apply Permutation_cons_inv with a. apply Permutation_trans with (c :: a :: others); [apply perm_swap |].
      apply Permutation_trans with (2 := Permutation_sym P). constructor.
      apply Permutation_trans with (2 := Q). now constructor.
Qed.

Lemma picks_map {A B} (f : A -> B) s : forall before,
  picks (map f before) (map f s) = map (fun p => (f (fst p), map f (snd p))) (picks before s).
Proof.
  induction s as [| a s IH]; intros before; [reflexivity |]. cbn [map picks fst snd]. rewrite map_app. f_equal.
  specialize (IH (before ++ [a])). rewrite map_app in IH. exact IH.
Qed.
Lemma picks_within {A} (s : list A) : forall before i others, In (i, others) (picks before s) ->
  In i s /\ forall j, In j others -> In j (before ++ s).
Proof.
  induction s as [| a s IH]; intros before i others; [contradiction |]. intros [E | H].
  - injection E as <- <-. split; [now left |]. intros j J. apply in_app_or in J. apply in_or_app.
    destruct J as [J | J]; [now left | right; now right].
  - destruct (IH _ _ _ H) as [Ii J]. split; [now right |]. intros j Ij. specialize (J j Ij).
    rewrite <- app_assoc in J. exact J.
Qed.

Section Corners.
Variables prec emin : Z.
Context {format : Format prec emin}.
Notation fl := (fl prec emin).
Notation number := (number prec emin).
Notation u := (u prec).
Notation eta := (eta emin).
Notation real_ops := (real_ops prec emin).
Notation approximates := (approximates prec emin).
Notation growth := (growth prec).

Lemma real_max_l a b : a <= max real_ops a b.
Proof. unfold max. cbn [less real_model.real_ops]. case Rlt_bool_spec; lra. Qed.
Lemma real_max_r a b : b <= max real_ops a b.
Proof. unfold max. cbn [less real_model.real_ops]. case Rlt_bool_spec; lra. Qed.

Lemma fold_max_ge {A} (f : A -> R) s : forall r, r <= fold_left (fun r a => max real_ops r (f a)) s r /\
  Forall (fun a => f a <= fold_left (fun r a => max real_ops r (f a)) s r) s.
Proof.
  induction s as [| a s IH]; intros r; cbn [fold_left]; [split; [lra | constructor] |].
  destruct (IH (max real_ops r (f a))) as [L F]. pose proof (real_max_l r (f a)). pose proof (real_max_r r (f a)).
  split; [lra |]. constructor; [lra | exact F].
Qed.

Lemma best_ge base slack ps : forall r i others j, In (i, others) ps -> In j others ->
  corner_value real_ops base slack i j <=
  fold_left (fun best p => fold_left (fun best j => max real_ops best (corner_value real_ops base slack (fst p) j))
                                     (snd p) best) ps r.
Proof.
  assert (Up : forall qs r, r <= fold_left (fun best (p : entry * list entry) =>
             fold_left (fun best j => max real_ops best (corner_value real_ops base slack (fst p) j)) (snd p) best)
               qs r).
  { induction qs as [| q qs IH]; intros r; cbn [fold_left]; [lra |]. apply Rle_trans with (2 := IH _).
    apply (fold_max_ge (fun j => corner_value real_ops base slack (fst q) j)). }
  induction ps as [| p ps IH]; intros r i others j I J; [contradiction |]. cbn [fold_left]. destruct I as [-> | I].
  - apply Rle_trans with (2 := Up _ _). cbn [fst snd].
    destruct (fold_max_ge (fun j => corner_value real_ops base slack i j) others r) as [_ F].
    rewrite Forall_forall in F. now apply F.
  - now apply IH with others.
Qed.

(* Weights in units of u: sums and differences within [-1, 1] are exact. *)
Definition dyadic (x : R) : Prop := exists k : Z, x = IZR k * u.
Lemma dyadic_number x : dyadic x -> Rabs x <= 1 -> number x.
Proof.
  intros [k ->] B. pose proof (@prec_large prec emin format). pose proof (@emin_small prec emin format).
  destruct (Z.eq_dec (Z.abs k) (2 ^ prec)) as [E | N].
  - assert (H1 : k = (2 ^ prec)%Z \/ k = (- 2 ^ prec)%Z) by lia.
    assert (H2 : IZR (2 ^ prec) * u = 1)
      by (rewrite IZR_power by lia; unfold u, rounding.u; rewrite <- bpow_plus, Z.add_opp_diag_r; reflexivity).
    assert (N1 : number 1) by (apply (integer_number prec emin 1); apply Z.lt_le_trans with (2 ^ 24)%Z;
                               [reflexivity | apply Z.pow_le_mono_r; lia]).
    destruct H1 as [-> | ->].
    + rewrite H2. exact N1.
    + rewrite opp_IZR. replace (- IZR (2 ^ prec) * u) with (- 1) by lra. now apply (number_opp prec emin).
  - apply (scaled_number prec emin); [| lia].
    assert (IZR (Z.abs k) <= IZR (2 ^ prec)).
    { rewrite Rabs_mult, (Rabs_pos_eq u) in B by (apply Rlt_le, u_positive). rewrite <- abs_IZR in B.
      rewrite IZR_power by lia. apply Rmult_le_reg_r with u; [apply u_positive |].
      replace (bpow radix2 prec * u) with 1 by (unfold u, rounding.u; rewrite <- bpow_plus, Z.add_opp_diag_r;
        reflexivity).
      exact B. }
    apply le_IZR in H1. lia.
Qed.
Lemma dyadic_sub x y : dyadic x -> dyadic y -> dyadic (x - y).
Proof. intros [k ->] [m ->]. exists (k - m)%Z. rewrite minus_IZR. ring. Qed.
Lemma dyadic_1 : dyadic 1.
Proof.
  pose proof (@prec_large prec emin format). exists (2 ^ prec)%Z. rewrite IZR_power by lia.
  unfold u, rounding.u. rewrite <- bpow_plus, Z.add_opp_diag_r. reflexivity.
Qed.

Definition corner_entry (e : entry (num := R)) : Prop :=
  dyadic (entry_l e) /\ dyadic (entry_h e) /\ 0 <= entry_l e <= entry_h e /\ entry_h e <= 1 /\ number (entry_b e).

Lemma slack_exact nodes : Forall corner_entry nodes -> forall s, dyadic s -> s <= 1 -> 0 <= s - sum entry_l nodes ->
  fold_left (fun s n => fl (s - entry_l n)) nodes s = s - sum entry_l nodes /\ dyadic (s - sum entry_l nodes).
Proof.
  induction 1 as [| e nodes (L & _ & (P & _) & _) F IH]; intros s D S R.
  - unfold sum. cbn. rewrite Rminus_0_r. auto.
  - cbn [fold_left]. rewrite sum_cons in *.
    assert (0 <= sum entry_l nodes).
    { apply sum_nonnegative. apply Forall_impl with (2 := F). intros a (_ & _ & (Q & _) & _). exact Q. }
    rewrite (fl_id prec emin) by (apply dyadic_number; [now apply dyadic_sub | apply Rabs_le; lra]).
    replace (s - (entry_l e + sum entry_l nodes)) with (s - entry_l e - sum entry_l nodes) by ring.
    apply IH; [now apply dyadic_sub | lra | lra].
Qed.

Definition lost (n : nat) : R := / 2 * INR n * (1 + u) ^ n.

(* Sum of l b: n leaves pass at most n roundings. *)
Lemma base_from nodes : Forall corner_entry nodes -> forall n s e X, (1 <= n)%nat -> approximates n s e X (lost n) ->
  approximates (n + length nodes) (fold_left (fun s m => fl (s + fl (entry_l m * entry_b m))) nodes s)
    (e + sum (fun m => entry_l m * entry_b m) nodes) (X + sum (fun m => entry_l m * Rabs (entry_b m)) nodes)
    (lost (n + length nodes)).
Proof.
  induction 1 as [| m nodes (L & H & (P & Q) & O & B) F IH]; intros n s e X N A.
  - unfold sum. simpl. rewrite !Rplus_0_r, Nat.add_0_r. exact A.
  - rewrite !sum_cons. cbn [fold_left length]. rewrite <- !Rplus_assoc.
    replace (n + S (length nodes))%nat with (S n + length nodes)%nat by lia. apply IH; [lia |].
    pose proof (u_positive prec) as U. pose proof (power_at_least_1 prec n).
    assert (FL : number (entry_l m)) by (apply dyadic_number; [exact L | apply Rabs_le; lra]).
    pose proof (approximates_mul prec emin 0 0 _ _ _ _ _ _ (approximates_exact prec emin _ FL)
                  (approximates_exact prec emin _ B)) as T.
    rewrite (Rabs_pos_eq (entry_l m)) in T by lra.
    eapply (approximates_weaken prec emin); [apply Nat.le_refl | |].
    2: { apply (approximates_add prec emin); [exact A |].
         eapply (approximates_weaken prec emin); [| apply Rle_refl | exact T]. lia. }
    unfold lost. rewrite S_INR. simpl ((1 + u) ^ S n).
    replace (/ 2 * (INR n + 1) * ((1 + u) * (1 + u) ^ n)) with ((1 + u) * (/ 2 * INR n * (1 + u) ^ n + / 2 * (1 + u)
      ^ n))
      by ring.
    apply Rmult_le_compat_l; lra.
Qed.

Lemma base_approximates m nodes : Forall corner_entry (m :: nodes) ->
  approximates (S (length nodes)) (corner_base real_ops (m :: nodes))
    (sum (fun m => entry_l m * entry_b m) (m :: nodes)) (sum (fun m => entry_l m * Rabs (entry_b m)) (m :: nodes))
    (lost (S (length nodes))).
Proof.
  intros F. inversion F as [| ? ? (L & H & (P & Q) & O & B) G]; subst. unfold corner_base. rewrite model_zero.
  cbn [fold_left add mul real_model.real_ops]. rewrite !sum_cons.
  rewrite Rplus_0_l, (fl_id prec emin (fl _)) by apply (fl_number prec emin).
  assert (FL : number (entry_l m)) by (apply dyadic_number; [exact L | apply Rabs_le; lra]).
  apply (base_from nodes G 1); [lia |].
  pose proof (approximates_mul prec emin 0 0 _ _ _ _ _ _ (approximates_exact prec emin _ FL)
                (approximates_exact prec emin _ B)) as T.
  rewrite (Rabs_pos_eq (entry_l m)) in T by lra.
  apply (approximates_weaken prec emin 1 1 _ _ _ (/ 2)); [lia | | exact T].
  unfold lost. pose proof (u_positive prec). simpl. lra.
Qed.

(* One corner. *)
Lemma corner_approximates nodes i j most : (2 <= length nodes)%nat -> Forall corner_entry nodes ->
  sum entry_l nodes <= 1 -> In i nodes -> In j nodes -> Forall (fun m => Rabs (entry_b m) <= most) nodes ->
  let slack := 1 - sum entry_l nodes in let range := entry_h i - entry_l i in
  Rabs (corner_value real_ops (corner_base real_ops nodes) (corner_slack real_ops nodes) i j -
        (sum (fun m => entry_l m * entry_b m) nodes + range * entry_b i + (slack - range) * entry_b j)) <=
  growth (length nodes + 2) * (3 * most) + lost (length nodes + 2) * eta.
Proof.
  intros Len F SL Ii Ij M slack range. pose proof (u_positive prec) as U.
  rewrite Forall_forall in F, M. destruct (F i Ii) as (Li & Hi & (Pi & Qi) & Oi & Bi).
  destruct (F j Ij) as (_ & _ & _ & _ & Bj).
  pose proof (M i Ii) as Mi. pose proof (M j Ij) as Mj. rewrite <- Forall_forall in F, M.
  assert (P : 0 <= sum entry_l nodes).
  { apply sum_nonnegative. apply Forall_impl with (2 := F). intros a (_ & _ & (Q & _) & _). exact Q. }
  destruct (slack_exact nodes F 1 dyadic_1 (Rle_refl 1)) as [ES DS]; [lra |]. fold slack in ES, DS.
  assert (CS : corner_slack real_ops nodes = slack).
  { unfold corner_slack. cbn [sub constant real_model.real_ops]. simpl (bpow radix2 0). rewrite Rmult_1_r. exact ES. }
  assert (DR : dyadic range) by (apply dyadic_sub; assumption).
  assert (FR : number range) by (apply dyadic_number; [exact DR | unfold range; apply Rabs_le; lra]).
  assert (FD : number (slack - range)).
  { apply dyadic_number; [now apply dyadic_sub |]. unfold slack, range. apply Rabs_le. lra. }
  unfold corner_value. rewrite CS. cbn [add sub mul real_model.real_ops]. fold range.
  rewrite (fl_id prec emin range FR), (fl_id prec emin (slack - range) FD).
  destruct nodes as [| m nodes]; [simpl in Len; lia |].
  pose proof (base_approximates m nodes F) as B. set (n := S (length nodes)) in *.
  change (length (m :: nodes)) with n.
  pose proof (approximates_mul prec emin 0 0 _ _ _ _ _ _ (approximates_exact prec emin _ FR)
                (approximates_exact prec emin _ Bi)) as TI.
  pose proof (approximates_mul prec emin 0 0 _ _ _ _ _ _ (approximates_exact prec emin _ FD)
                (approximates_exact prec emin _ Bj)) as TJ.
  assert (TI' := approximates_weaken prec emin 1 n _ _ _ (/ 2) (/ 2) ltac:(unfold n; lia) (Rle_refl _) TI).
  assert (TJ' := approximates_weaken prec emin 1 (S n) _ _ _ (/ 2) (/ 2) ltac:(lia) (Rle_refl _) TJ).
  pose proof (approximates_add prec emin _ _ _ _ _ _ _ _ _ (approximates_add prec emin _ _ _ _ _ _ _ _ _ B TI') TJ')
    as (_ & _ & E).
  apply Rle_trans with (1 := E). replace (n + 2)%nat with (S (S n)) by lia.
  pose proof (eta_positive emin). pose proof (growth_nonnegative prec (S (S n))).
  assert (SM : sum (fun m0 => entry_l m0 * Rabs (entry_b m0)) (m :: nodes) <= sum entry_l (m :: nodes) * most).
  { rewrite (Rmult_comm (sum _ _)), <- sum_scale. apply sum_le. rewrite Forall_forall in F, M |- *. intros a Ia.
    destruct (F a Ia) as (_ & _ & (Pa & _) & _). rewrite (Rmult_comm most).
    apply Rmult_le_compat_l; [exact Pa | now apply M]. }
  pose proof (Rabs_pos (entry_b i)) as Bi0.
  assert (RI : Rabs range * Rabs (entry_b i) <= range * most).
  { rewrite Rabs_pos_eq by (unfold range; lra). apply Rmult_le_compat_l; [unfold range; lra | exact Mi]. }
  assert (RJ : Rabs (slack - range) * Rabs (entry_b j) <= Rabs (slack - range) * most)
    by (apply Rmult_le_compat_l; [apply Rabs_pos | exact Mj]).
  assert (SR : sum entry_l (m :: nodes) + range + Rabs (slack - range) <= 3).
  { unfold slack, range. unfold Rabs. destruct Rcase_abs; lra. }
  apply Rplus_le_compat.
  - apply Rmult_le_compat_l; [assumption |].
    assert ((sum entry_l (m :: nodes) + range + Rabs (slack - range)) * most <= 3 * most)
      by (apply Rmult_le_compat_r; lra). lra.
  - apply Rmult_le_compat_r; [lra |]. unfold lost. rewrite 2!S_INR.
    pose proof (power_at_least_1 prec n). pose proof (pos_INR n).
    apply Rle_trans with
      ((1 + u) * ((1 + u) * (/ 2 * INR n * (1 + u) ^ n + / 2 * (1 + u) ^ n) + / 2 * ((1 + u) * (1 + u) ^ n)));
      [| right; rewrite <- !tech_pow_Rmult; ring].
    apply Rmult_le_compat_l; [lra |]. apply Rplus_le_compat; [apply Rmult_le_compat_l; lra |].
    assert (1 * 1 <= (1 + u) * (1 + u) ^ n) by (apply Rmult_le_compat; lra). lra.
Qed.

Lemma magnitude_ge nodes :
  Forall (fun m => Rabs (entry_b m) <= corner_magnitude real_ops nodes) nodes.
Proof. unfold corner_magnitude. apply (fold_max_ge (fun m => Rabs (entry_b m))). Qed.

Lemma corner_error_covers nodes : (2 <= length nodes)%nat -> INR (length nodes + 8) * u <= / 16 ->
  growth (length nodes + 2) * (3 * corner_magnitude real_ops nodes) + lost (length nodes + 2) * eta <=
  corner_error real_ops nodes.
Proof.
  intros Len Sm. set (B := corner_magnitude real_ops nodes) in *.
  pose proof (u_positive prec) as U. pose proof (u_small prec emin) as US. pose proof (eta_positive emin) as E0.
  assert (B0 : 0 <= B).
  { destruct nodes as [| m nodes]; [simpl in Len; lia |]. apply Rle_trans with (Rabs (entry_b m)); [apply Rabs_pos |].
    exact (Forall_inv (magnitude_ge (m :: nodes))). }
  set (n := length nodes) in *.
  assert (N2 : 2 <= INR n) by (apply (le_INR 2); exact Len).
  rewrite plus_INR in Sm. replace (INR 8) with 8 in Sm by (simpl; ring).
  assert (Big : (8 * Z.of_nat n + 64 < 2 ^ prec)%Z).
  { pose proof (@prec_large prec emin format). apply lt_IZR.
  rewrite IZR_power, plus_IZR, mult_IZR, <- INR_IZR_INZ by lia.
    assert (HU : u * bpow radix2 prec = 1)
      by (unfold u, rounding.u; rewrite <- bpow_plus, Z.add_opp_diag_l; reflexivity).
    pose proof (bpow_gt_0 radix2 prec).
    assert ((INR n + 8) * (u * bpow radix2 prec) <= / 16 * bpow radix2 prec)
      by (rewrite <- Rmult_assoc; apply Rmult_le_compat_r; lra). rewrite HU in *. lra. }
  (* the computed term *)
  assert (ZN : IZR (length_of nodes) = INR n) by (unfold length_of, n; now rewrite <- INR_IZR_INZ).
  assert (T : corner_error real_ops nodes =
              successor.succ prec emin (fl (fl (fl (IZR (4 * (Z.of_nat n + 8)) * u) * B) + IZR (2 * Z.of_nat n) *
                eta))).
  { unfold corner_error. rewrite (model_succ prec emin), model_u. fold B. rewrite model_smallest, Rmult_1_l.
    cbn [add mul constant real_model.real_ops]. simpl (bpow radix2 0). rewrite !Rmult_1_r. unfold length_of. fold n.
    assert (I : forall k, (Z.abs k < 2 ^ prec)%Z -> fl (IZR k) = IZR k)
      by (intros k K; apply (fl_id prec emin), (integer_number prec emin); exact K).
    rewrite <- plus_IZR, I by lia. rewrite <- mult_IZR, I by lia. rewrite <- mult_IZR, I by lia.
    f_equal. f_equal. f_equal. apply (fl_id prec emin), (scaled_number prec emin); lia. }
  rewrite T. pose proof (error_term prec emin (4 * (Z.of_nat n + 8)) (2 * Z.of_nat n) B ltac:(lia) B0) as E.
  apply Rle_trans with (2 := E). rewrite !mult_IZR, plus_IZR, <- INR_IZR_INZ.
  assert (N8 : INR (n + 2) * u <= / 16).
  { rewrite plus_INR. replace (INR 2) with 2 by (simpl; ring). apply Rle_trans with (2 := Sm).
    apply Rmult_le_compat_r; lra. }
  assert (N9 : 0 <= INR (n + 2) * u) by (apply Rmult_le_pos; [apply pos_INR | lra]).
  pose proof (growth_small prec (n + 2) ltac:(lra)) as G.
  assert (G2 : growth (n + 2) <= 17 / 16 * ((INR n + 2) * u)).
  { assert (INR (n + 2) * u * (INR (n + 2) * u) <= / 16 * (INR (n + 2) * u)) by (apply Rmult_le_compat_r; lra).
    rewrite plus_INR in *. replace (INR 2) with 2 in * by (simpl; ring). lra. }
  assert (GB : growth (n + 2) * (3 * B) <= 17 / 16 * ((INR n + 2) * u) * (3 * B)) by (apply Rmult_le_compat_r; lra).
  assert (UB : 0 <= u * B) by (apply Rmult_le_pos; lra).
  assert (NUB : 0 <= INR n * (u * B)) by (apply Rmult_le_pos; lra).
  assert (UUB : u * ((INR n + 8) * (u * B)) <= / 16777216 * ((INR n + 8) * (u * B)))
    by (apply Rmult_le_compat_r; [apply Rmult_le_pos; lra | lra]).
  apply Rplus_le_compat.
  - apply Rle_trans with (1 := GB).
    replace (17 / 16 * ((INR n + 2) * u) * (3 * B)) with (51 / 16 * (INR n * (u * B)) + 51 / 8 * (u * B)) by field.
    replace (4 * (INR n + 8) * u * (1 - u) * B)
      with (4 * (INR n * (u * B)) + 32 * (u * B) - 4 * (u * ((INR n + 8) * (u * B)))) by ring.
    lra.
  - apply Rmult_le_compat_r; [lra |]. unfold lost. unfold approximation.growth in G.
    assert (PW : (1 + u) ^ (n + 2) <= 1.1).
    { assert (INR (n + 2) * u * (INR (n + 2) * u) <= / 16 * / 16) by (apply Rmult_le_compat; lra). lra. }
    pose proof (power_at_least_1 prec (n + 2)). rewrite plus_INR. replace (INR 2) with 2 by (simpl; ring).
    apply Rle_trans with (/ 2 * (INR n + 2) * 1.1); [apply Rmult_le_compat_l; lra | lra].
Qed.

(* With its error term the computed corner of the two greatest is at least every mean of W'. *)
Lemma some_corner nodes weights : (2 <= length nodes)%nat ->
  Forall corner_entry nodes -> INR (length nodes + 8) * u <= / 16 ->
  map fst weights = map node_of_entry nodes -> in_space weights ->
  exists i others j, In (i, others) (picks [] nodes) /\ In j others /\
    mean weights <= corner_value real_ops (corner_base real_ops nodes) (corner_slack real_ops nodes) i j +
                    corner_error real_ops nodes.
Proof.
  intros Len F Sm E W. destruct nodes as [| a [| b nodes]]; [simpl in Len; lia | simpl in Len; lia |].
  set (all := a :: b :: nodes) in *.
  assert (SL : sum entry_l all <= 1).
  { destruct W as [Win Wsum]. rewrite <- Wsum.
    assert (Q : sum entry_l all = sum (fun p => low (fst p)) weights).
    { transitivity (sum low (map node_of_entry all)); [now rewrite sum_map |]. rewrite <- E. now rewrite sum_map. }
    rewrite Q. apply sum_le. apply Forall_impl with (2 := Win). intros p [P _]. exact P. }
  destruct (two_greatest_exist entry_b a b nodes) as (i & j & t & P & G & H). fold all in P.
  destruct (picks_in all [] i (j :: t) (Permutation_sym P)) as (others & Io & Po).
  assert (Jo : In j others) by (apply (Permutation_in j (Permutation_sym Po)); now left).
  assert (Ii : In i all) by (apply (Permutation_in i (Permutation_sym P)); now left).
  assert (Ij : In j all) by (apply (Permutation_in j (Permutation_sym P)); right; now left).
  pose proof (corner_approximates all i j _ Len F SL Ii Ij (magnitude_ge all)) as A. cbv zeta in A.
  pose proof (corner_error_covers all Len Sm) as C.
  assert (M : mean weights <= sum (fun m => entry_l m * entry_b m) all + (entry_h i - entry_l i) * entry_b i +
                              (1 - sum entry_l all - (entry_h i - entry_l i)) * entry_b j).
  { apply (corners_bound (node_of_entry i) (node_of_entry j) (map node_of_entry t)).
    - split; [exact G |]. apply Forall_map. exact H.
    - rewrite E. apply (Permutation_map node_of_entry) in P. exact P.
    - exact W.
    - rewrite E. unfold corner. rewrite !sum_map. apply Rle_refl. }
  exists i, others, j. split; [exact Io |]. split; [exact Jo |]. apply Rabs_le_inv in A. lra.
Qed.

(* One node has the weight 1. *)
Lemma only_node e weights : map fst weights = [node_of_entry e] -> in_space weights -> mean weights <= entry_b e.
Proof.
  intros E W. destruct weights as [| [n w] [| p weights]]; try discriminate. injection E as E. destruct W as [_ W].
  unfold mean, sum in *. simpl in *. subst n. simpl. replace w with 1 by lra. lra.
Qed.

Theorem best_corner_at_least_mean nodes weights :
  Forall corner_entry nodes -> nodes <> [] -> INR (length nodes + 8) * u <= / 16 ->
  map fst weights = map node_of_entry nodes -> in_space weights ->
  mean weights <= match nodes with [n] => entry_b n | _ => corner_bound real_ops nodes end.
Proof.
  intros F Ne Sm E W. destruct nodes as [| a [| b nodes]]; [congruence | now apply only_node |].
  set (all := a :: b :: nodes) in *.
  destruct (some_corner all weights ltac:(unfold all; simpl; lia) F Sm E W) as (i & others & j & Io & Jo & M).
  pose proof (best_ge (corner_base real_ops all) (corner_slack real_ops all) (picks [] all) (lowest real_ops) i
    others j Io Jo) as B. fold (best_of_corners real_ops all) in B.
  change (mean weights <= model.succ real_ops (add real_ops (best_of_corners real_ops all) (corner_error real_ops
    all))).
  rewrite (model_succ prec emin). cbn [add real_model.real_ops].
  pose proof (below_succ_fl prec emin (best_of_corners real_ops all + corner_error real_ops all)) as S1. lra.
Qed.
End Corners.
