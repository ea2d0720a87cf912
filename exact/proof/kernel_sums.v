(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* Sums of products by fused multiply-add, in lanes that meet in a tree, as toolkit/bounds/kernel/ takes them; what
   dual_sum_factor and dual_sum_underflow of rounding.hpp cover. *)
From Coq Require Import Reals Lra Lia ZArith List Permutation.
From Flocq Require Import Core.
From CinchProof Require Import duality rounding approximation.
Import ListNotations.
Open Scope R_scope.

(* Nothing yet, one more product, or two lanes together. *)
Inductive fused := Nothing | More (before : fused) (weight factor : R) | Meet (a b : fused).

Fixpoint products (t : fused) : list (R * R) :=
  match t with Nothing => [] | More t w a => (w, a) :: products t | Meet a b => products a ++ products b end.
Fixpoint fused_depth (t : fused) : nat :=
  match t with
  | Nothing => 0
  | More t _ _ => S (fused_depth t)
  | Meet a b => S (Nat.max (fused_depth a) (fused_depth b))
  end.
Definition exact_products (t : fused) : R := sum (fun p => fst p * snd p) (products t).
Definition size_products (t : fused) : R := sum (fun p => Rabs (fst p) * Rabs (snd p)) (products t).
Definition count (t : fused) : nat := length (products t).

Section Kernel_sums.
Variables prec emin : Z.
Context {format : Format prec emin}.
Notation fl := (fl prec emin).
Notation number := (number prec emin).
Notation u := (u prec).
Notation eta := (eta emin).
Notation growth := (growth prec).

Fixpoint computed (t : fused) : R :=
  match t with
  | Nothing => 0
  | More t w a => fl (w * a + computed t)
  | Meet a b => fl (computed a + computed b)
  end.

Lemma computed_number t : number (computed t).
Proof. destruct t; [apply (number_0 prec emin) | apply (fl_number prec emin) | apply (fl_number prec emin)]. Qed.

Lemma size_nonnegative t : Rabs (exact_products t) <= size_products t.
Proof.
  unfold exact_products, size_products. induction (products t) as [| [w a] s IH].
  - unfold sum. simpl. rewrite Rabs_R0. lra.
  - rewrite !sum_cons. cbn [fst snd]. pose proof (Rabs_triang (w * a) (sum (fun p => fst p * snd p) s)).
    rewrite Rabs_mult in H. lra.
Qed.

Theorem fused_error t :
  Rabs (computed t - exact_products t) <=
  growth (fused_depth t) * size_products t + INR (count t) * (1 + u) ^ fused_depth t * (eta / 2).
Proof.
  pose proof (u_positive prec) as U. pose proof (eta_positive emin) as E0.
  induction t as [| t IH w a | a IHa b IHb].
  - unfold exact_products, size_products, count, sum. simpl. rewrite Rminus_0_r, Rabs_R0. lra.
  - pose proof (size_nonnegative t) as X. unfold exact_products, size_products, count in *.
  cbn [computed products fused_depth].
    rewrite !sum_cons. cbn [fst snd length]. rewrite S_INR.
    set (e := sum (fun p => fst p * snd p) (products t)) in *.
    set (z := sum (fun p => Rabs (fst p) * Rabs (snd p)) (products t)) in *.
    set (k := fused_depth t) in *. set (n := INR (length (products t))) in *.
    pose proof (fl_error prec emin (w * a + computed t)) as R. pose proof (growth_nonnegative prec k) as G.
    pose proof (power_at_least_1 prec k) as P.
    replace (fl (w * a + computed t) - (w * a + e))
      with ((fl (w * a + computed t) - (w * a + computed t)) + (computed t - e)) by ring.
    pose proof (Rabs_triang (fl (w * a + computed t) - (w * a + computed t)) (computed t - e)).
    assert (V : Rabs (w * a + computed t) <= Rabs w * Rabs a + z + (growth k * z + n * (1 + u) ^ k * (eta / 2))).
    { replace (w * a + computed t) with (w * a + (e + (computed t - e))) by ring.
      pose proof (Rabs_triang (w * a) (e + (computed t - e))). pose proof (Rabs_triang e (computed t - e)).
      rewrite Rabs_mult in *. lra. }
    assert (u * Rabs (w * a + computed t) <= u * (Rabs w * Rabs a + z + (growth k * z + n * (1 + u) ^ k * (eta / 2))))
      by (apply Rmult_le_compat_l; lra).
    assert (WA : 0 <= Rabs w * Rabs a) by (apply Rmult_le_pos; apply Rabs_pos).
    assert (GW : 0 <= (1 + u) * growth k * (Rabs w * Rabs a))
      by (apply Rmult_le_pos; [apply Rmult_le_pos; lra | exact WA]).
    simpl ((1 + u) ^ S k). replace (growth (S k)) with ((1 + u) * growth k + u) by (unfold approximation.growth;
      simpl; ring).
    assert (1 * (eta / 2) <= (1 + u) * (1 + u) ^ k * (eta / 2)).
    { apply Rmult_le_compat_r; [lra |]. assert (0 <= u * (1 + u) ^ k) by (apply Rmult_le_pos; lra). lra. }
    lra.
  - pose proof (size_nonnegative a) as Xa. pose proof (size_nonnegative b) as Xb.
    unfold exact_products, size_products, count in *. cbn [computed products fused_depth].
    rewrite !sum_app, app_length, plus_INR.
    set (ea := sum (fun p => fst p * snd p) (products a)) in *.
    set (eb := sum (fun p => fst p * snd p) (products b)) in *.
    set (za := sum (fun p => Rabs (fst p) * Rabs (snd p)) (products a)) in *.
    set (zb := sum (fun p => Rabs (fst p) * Rabs (snd p)) (products b)) in *.
    set (k := Nat.max (fused_depth a) (fused_depth b)).
    pose proof (growth_le prec (fused_depth a) k (Nat.le_max_l _ _)) as Ga.
    pose proof (growth_le prec (fused_depth b) k (Nat.le_max_r _ _)) as Gb.
    assert (Pa : (1 + u) ^ fused_depth a <= (1 + u) ^ k) by (apply Rle_pow; [lra | apply Nat.le_max_l]).
    assert (Pb : (1 + u) ^ fused_depth b <= (1 + u) ^ k) by (apply Rle_pow; [lra | apply Nat.le_max_r]).
    set (na := INR (length (products a))) in *. set (nb := INR (length (products b))) in *.
    assert (Na : 0 <= na) by apply pos_INR. assert (Nb : 0 <= nb) by apply pos_INR.
    pose proof (Rabs_pos ea). pose proof (Rabs_pos eb).
    assert (growth (fused_depth a) * za <= growth k * za) by (apply Rmult_le_compat_r; lra).
    assert (growth (fused_depth b) * zb <= growth k * zb) by (apply Rmult_le_compat_r; lra).
    assert (na * (1 + u) ^ fused_depth a * (eta / 2) <= na * (1 + u) ^ k * (eta / 2))
      by (apply Rmult_le_compat_r; [lra |]; apply Rmult_le_compat_l; lra).
    assert (nb * (1 + u) ^ fused_depth b * (eta / 2) <= nb * (1 + u) ^ k * (eta / 2))
      by (apply Rmult_le_compat_r; [lra |]; apply Rmult_le_compat_l; lra).
    pose proof (fl_plus_error prec emin _ _ (computed_number a) (computed_number b)) as R.
    set (ca := computed a) in *. set (cb := computed b) in *.
    replace (fl (ca + cb) - (ea + eb)) with ((fl (ca + cb) - (ca + cb)) + ((ca - ea) + (cb - eb))) by ring.
    pose proof (Rabs_triang (fl (ca + cb) - (ca + cb)) ((ca - ea) + (cb - eb))).
    pose proof (Rabs_triang (ca - ea) (cb - eb)).
    assert (V : Rabs (ca + cb) <= za + zb + (growth k * (za + zb) + (na + nb) * (1 + u) ^ k * (eta / 2))).
    { replace (ca + cb) with ((ea + eb) + ((ca - ea) + (cb - eb))) by ring.
      pose proof (Rabs_triang (ea + eb) ((ca - ea) + (cb - eb))). pose proof (Rabs_triang ea eb). lra. }
    assert (u * Rabs (ca + cb) <= u * (za + zb + (growth k * (za + zb) + (na + nb) * (1 + u) ^ k * (eta / 2))))
      by (apply Rmult_le_compat_l; lra).
    simpl ((1 + u) ^ S k). replace (growth (S k)) with ((1 + u) * growth k + u) by (unfold approximation.growth;
      simpl; ring).
    lra.
Qed.

(* What lanes are filled up with has the weight 0 and changes nothing. *)
Lemma padding t a : computed (More t 0 a) = computed t.
Proof. cbn [computed]. rewrite Rmult_0_l, Rplus_0_l. apply (fl_id prec emin), computed_number. Qed.

(* The two sums of D: l times fl(b - lambda), r times the same where it is positive. *)
Definition pairs (weight : R * R * R -> R) (factor : R -> R) (lambda : R) (nodes : list (R * R * R)) : list (R * R) :=
  map (fun n => (weight n, factor (fl (snd n - lambda)))) nodes.
Definition low_of (n : R * R * R) : R := fst (fst n).
Definition range_of (n : R * R * R) : R := snd (fst n).

Theorem dual_sums_error lambda nodes lower upper m width :
  number lambda -> Forall (fun n => number (snd n) /\ 0 <= low_of n /\ 0 <= range_of n /\
                                    Rabs (fl (snd n - lambda)) <= width) nodes ->
  sum low_of nodes <= 1 -> INR m * u <= / 200 ->
  Permutation (products lower) (pairs low_of (fun a => a) lambda nodes) -> (fused_depth lower <= m)%nat ->
  Permutation (products upper) (pairs range_of (fun a => Rmax a 0) lambda nodes) -> (fused_depth upper <= m)%nat ->
  0 <= width -> 0 <= computed upper ->
  Rabs (computed lower + computed upper -
        sum (fun n => low_of n * (snd n - lambda) + range_of n * Rmax (snd n - lambda) 0) nodes) <=
  (1.02 * INR m + 2) * u * (width + computed upper) + 2 * INR (length nodes) * eta.
Proof.
  intros L F SL Sm PL DL PU DU W0 C0. pose proof (u_positive prec) as U. pose proof (u_small prec emin) as US.
  pose proof (eta_positive emin) as E0.
  pose proof (fused_error lower) as EL. pose proof (fused_error upper) as EU.
  unfold exact_products, size_products, count in EL, EU.
  rewrite !(sum_permutation _ _ _ PL), (Permutation_length PL) in EL.
  rewrite !(sum_permutation _ _ _ PU), (Permutation_length PU) in EU.
  unfold pairs in EL, EU. rewrite map_length, !sum_map in EL, EU. cbn [fst snd] in EL, EU.
  (* fl(b - lambda) against b - lambda *)
  assert (A : forall n, In n nodes -> Rabs (fl (snd n - lambda) - (snd n - lambda)) <= u * Rabs (fl (snd n - lambda))).
  { intros n In. rewrite Forall_forall in F. destruct (F n In) as (B & _).
    pose proof (fl_plus_error_result prec emin (snd n) (- lambda) B (number_opp prec emin _ L)) as E.
    now replace (snd n + - lambda) with (snd n - lambda) in E by ring. }
  set (xl := sum (fun n => low_of n * fl (snd n - lambda)) nodes) in *.
  set (xu := sum (fun n => range_of n * Rmax (fl (snd n - lambda)) 0) nodes) in *.
  assert (Rm : forall a b, Rabs (Rmax a 0 - Rmax b 0) <= Rabs (a - b)).
  { intros a b. unfold Rmax. destruct (Rle_dec a 0), (Rle_dec b 0); unfold Rabs; repeat destruct Rcase_abs; lra. }
  assert (HL : Rabs (xl - sum (fun n => low_of n * (snd n - lambda)) nodes) <= u * width).
  { apply Rle_trans with (sum (fun n => low_of n * (u * width)) nodes).
    - unfold xl. clear - F A format. induction nodes as [| n s IH].
      + unfold sum. simpl. rewrite Rminus_0_r, Rabs_R0. lra.
      + rewrite !sum_cons. inversion F as [| ? ? (B & P & Q & R) F']; subst.
        specialize (IH F' (fun k I => A k (or_intror I))). pose proof (A n (or_introl eq_refl)) as An.
        set (x := sum (fun n0 => low_of n0 * fl (snd n0 - lambda)) s) in *.
        set (y := sum (fun n0 => low_of n0 * (snd n0 - lambda)) s) in *.
        replace (low_of n * fl (snd n - lambda) + x - (low_of n * (snd n - lambda) + y))
          with (low_of n * (fl (snd n - lambda) - (snd n - lambda)) + (x - y)) by ring.
        pose proof (Rabs_triang (low_of n * (fl (snd n - lambda) - (snd n - lambda))) (x - y)) as T.
        rewrite Rabs_mult, (Rabs_pos_eq (low_of n)) in T by exact P. pose proof (u_positive prec).
        assert (low_of n * Rabs (fl (snd n - lambda) - (snd n - lambda)) <= low_of n * (u * width)).
        { apply Rmult_le_compat_l; [exact P |]. apply Rle_trans with (1 := An). apply Rmult_le_compat_l; lra. }
        lra.
    - replace (sum (fun n => low_of n * (u * width)) nodes) with (u * width * sum low_of nodes)
        by (rewrite <- sum_scale; apply sum_ext, Forall_forall; intros; ring).
      rewrite <- (Rmult_1_r (u * width)) at 2. apply Rmult_le_compat_l; [apply Rmult_le_pos; lra | exact SL]. }
  assert (HU : Rabs (xu - sum (fun n => range_of n * Rmax (snd n - lambda) 0) nodes) <= u * xu).
  { unfold xu. clear - F A Rm U format. induction nodes as [| n s IH].
    - unfold sum. simpl. rewrite Rminus_0_r, Rabs_R0. lra.
    - rewrite !sum_cons. inversion F as [| ? ? (B & P & Q & R) F']; subst.
      specialize (IH F' (fun k I => A k (or_intror I))). pose proof (A n (or_introl eq_refl)) as An.
      set (x := sum (fun n0 => range_of n0 * Rmax (fl (snd n0 - lambda)) 0) s) in *.
      set (y := sum (fun n0 => range_of n0 * Rmax (snd n0 - lambda) 0) s) in *.
      set (a := fl (snd n - lambda)) in *. set (d := snd n - lambda) in *.
      assert (S : Rabs (Rmax a 0 - Rmax d 0) <= u * Rmax a 0).
      { assert (Sg : (0 <= d -> 0 <= a) /\ (d <= 0 -> a <= 0)).
        { unfold a, d. rewrite <- (fl_0 prec emin).
        split; intros H; rewrite ?(fl_0 prec emin) in H; apply (fl_le prec emin); exact H. }
        destruct (Rle_or_lt 0 d) as [G | N].
        - destruct Sg as [Sg _]. specialize (Sg G). rewrite (Rabs_pos_eq a) in An by exact Sg.
        rewrite !Rmax_left by lra. exact An.
        - destruct Sg as [_ Sg]. specialize (Sg (Rlt_le _ _ N)). rewrite !Rmax_right by lra.
          replace (0 - 0) with 0 by ring. rewrite Rabs_R0. lra. }
      replace (range_of n * Rmax a 0 + x - (range_of n * Rmax d 0 + y))
        with (range_of n * (Rmax a 0 - Rmax d 0) + (x - y)) by ring.
      pose proof (Rabs_triang (range_of n * (Rmax a 0 - Rmax d 0)) (x - y)) as T.
      rewrite Rabs_mult, (Rabs_pos_eq (range_of n)) in T by exact Q.
      assert (range_of n * Rabs (Rmax a 0 - Rmax d 0) <= range_of n * (u * Rmax a 0)) by (apply Rmult_le_compat_l;
        assumption).
      lra. }
  (* sizes *)
  assert (ZL : sum (fun n => Rabs (low_of n) * Rabs (fl (snd n - lambda))) nodes <= width).
  { apply Rle_trans with (width * sum low_of nodes).
    - rewrite <- sum_scale. apply sum_le. apply Forall_impl with (2 := F). intros n (B & P & Q & R).
      rewrite (Rabs_pos_eq (low_of n)) by exact P. rewrite (Rmult_comm width). now apply Rmult_le_compat_l.
    - rewrite <- (Rmult_1_r width) at 2. now apply Rmult_le_compat_l. }
  assert (ZU : sum (fun n => Rabs (range_of n) * Rabs (Rmax (fl (snd n - lambda)) 0)) nodes = xu).
  { apply sum_ext. apply Forall_impl with (2 := F). intros n (B & P & Q & R).
    rewrite (Rabs_pos_eq (range_of n)) by exact Q. rewrite Rabs_pos_eq by apply Rmax_r. reflexivity. }
  rewrite ZU in EU. rewrite sum_plus.
  set (yl := sum (fun n => low_of n * (snd n - lambda)) nodes) in *.
  set (yu := sum (fun n => range_of n * Rmax (snd n - lambda) 0) nodes) in *.
  set (zl := sum (fun n => Rabs (low_of n) * Rabs (fl (snd n - lambda))) nodes) in *.
  set (N := INR (length nodes)) in *. assert (N0 : 0 <= N) by apply pos_INR.
  assert (XU : 0 <= xu).
  { apply sum_nonnegative. apply Forall_impl with (2 := F). intros n (B & P & Q & R).
    apply Rmult_le_pos; [exact Q | apply Rmax_r]. }
  assert (M0 : 0 <= INR m * u) by (apply Rmult_le_pos; [apply pos_INR | lra]).
  pose proof (growth_small prec m ltac:(lra)) as G. pose proof (growth_nonnegative prec m) as G0.
  assert (G1 : growth m <= 1.005 * (INR m * u)).
  { assert (INR m * u * (INR m * u) <= / 200 * (INR m * u)) by (apply Rmult_le_compat_r; lra). lra. }
  assert (G2 : growth m <= 0.00503) by lra.
  assert (PW : (1 + u) ^ m <= 1.00503) by (unfold approximation.growth in G2; lra).
  assert (EL2 : Rabs (computed lower - xl) <= growth m * width + 0.503 * (N * eta)).
  { apply Rle_trans with (1 := EL). apply Rplus_le_compat.
    - pose proof (growth_le prec _ _ DL). pose proof (growth_nonnegative prec (fused_depth lower)).
      apply Rle_trans with (growth m * zl); [apply Rmult_le_compat_r; [| assumption] | apply Rmult_le_compat_l;
        assumption].
      apply sum_nonnegative, Forall_forall. intros n _. apply Rmult_le_pos; apply Rabs_pos.
    - assert ((1 + u) ^ fused_depth lower <= (1 + u) ^ m) by (apply Rle_pow; [lra | exact DL]).
      assert (N * (1 + u) ^ fused_depth lower * (eta / 2) <= N * 1.006 * (eta / 2))
        by (apply Rmult_le_compat_r; [lra |]; apply Rmult_le_compat_l; lra). lra. }
  assert (EU2 : Rabs (computed upper - xu) <= growth m * xu + 0.503 * (N * eta)).
  { apply Rle_trans with (1 := EU). apply Rplus_le_compat.
    - apply Rmult_le_compat_r; [exact XU | now apply growth_le].
    - assert ((1 + u) ^ fused_depth upper <= (1 + u) ^ m) by (apply Rle_pow; [lra | exact DU]).
      assert (N * (1 + u) ^ fused_depth upper * (eta / 2) <= N * 1.006 * (eta / 2))
        by (apply Rmult_le_compat_r; [lra |]; apply Rmult_le_compat_l; lra). lra. }
  set (NE := N * eta) in *. assert (NE0 : 0 <= NE) by (apply Rmult_le_pos; lra).
  (* xu against what is computed of it *)
  assert (X1 : xu <= 1.0051 * computed upper + 0.506 * NE).
  { pose proof (Rabs_le_inv _ _ EU2) as Q. assert (growth m * xu <= 0.00503 * xu) by (apply Rmult_le_compat_r; lra).
  lra. }
  replace (computed lower + computed upper - (yl + yu))
    with ((computed lower - xl) + (xl - yl) + ((computed upper - xu) + (xu - yu))) by ring.
  pose proof (Rabs_triang ((computed lower - xl) + (xl - yl)) ((computed upper - xu) + (xu - yu))).
  pose proof (Rabs_triang (computed lower - xl) (xl - yl)). pose proof (Rabs_triang (computed upper - xu) (xu - yu)).
  set (g := growth m) in *. set (C := computed upper) in *.
  assert (Q1 : (g + u) * xu <= (g + u) * (1.0051 * C + 0.506 * NE)) by (apply Rmult_le_compat_l; lra).
  assert (Q2 : (g + u) * NE <= 0.006 * NE) by (apply Rmult_le_compat_r; lra).
  assert (Q3 : (g + u) * C <= (1.005 * (INR m * u) + u) * C) by (apply Rmult_le_compat_r; lra).
  assert (Q4 : (g + u) * width <= (1.005 * (INR m * u) + u) * width) by (apply Rmult_le_compat_r; lra).
  assert (MC : 0 <= INR m * u * C) by (apply Rmult_le_pos; lra). assert (UC : 0 <= u * C) by (apply Rmult_le_pos; lra).
  assert (MW : 0 <= INR m * u * width) by (apply Rmult_le_pos; lra).
  assert (UW : 0 <= u * width) by (apply Rmult_le_pos; lra).
  replace (2 * N * eta) with (2 * NE) by (unfold NE; ring). lra.
Qed.
End Kernel_sums.
