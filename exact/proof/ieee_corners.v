(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* best_corner over IEEE values: where the largest |b| is below 2^1020 (in double) nothing overflows, so that a finite
   result is at least every mean of W'. *)
From Coq Require Import Reals Lra Lia ZArith List Bool.
From Flocq Require Import Core.
From CinchProof Require Import duality rounding successor approximation model real_model dual_bound corners ieee
  ieee_forward ieee_dual.
Import ListNotations.
Open Scope R_scope.

Section Ieee_corners.
Variables prec emin : Z.
Context {format : Format prec emin}.
Notation fl := (fl prec emin).
Notation number := (number prec emin).
Notation u := (u prec).
Notation eta := (eta emin).
Notation real_ops := (real_ops prec emin).
Notation approximates := (approximates prec emin).
Notation growth := (growth prec).
Notation lost := (lost prec).
Notation dyadic := (dyadic prec).
Context {num : Type} {o : ops num} {view : num -> value}.
Variable I : ieee prec emin o view.
Notation finite := (finite (view := view)).
Notation val := (val (view := view)).
Notation entry := (entry (num := num)).
Notation entry_value := (entry_value (view := view)).
Notation safe := (safe prec emin).

(* Weight intervals in units of u. *)
Definition unit_interval (l h : num) : Prop :=
  finite l /\ finite h /\ dyadic (val l) /\ dyadic (val h) /\ 0 <= val l <= val h /\ val h <= 1.
Definition entry_below (most : R) (e : entry) : Prop :=
  unit_interval (entry_l e) (entry_h e) /\ finite (entry_b e) /\ Rabs (val (entry_b e)) <= most.

Lemma entry_below_corner most e : entry_below most e -> corner_entry prec emin (entry_value e).
Proof.
  intros ((_ & _ & L & H & O & P) & _ & _).
  split; [exact L |]. split; [exact H |]. split; [exact O |]. split; [exact P |]. apply (val_number prec emin I).
Qed.

(* Few nodes lose little. *)
Lemma lost_small n : INR n * u <= / 16 -> lost n * eta <= / 16 * safe.
Proof.
  intros S. pose proof (u_positive prec). pose proof (pos_INR n). pose proof (eta_positive emin).
  assert (N0 : 0 <= INR n * u) by (apply Rmult_le_pos; lra).
  pose proof (growth_small prec n ltac:(lra)) as G. unfold approximation.growth in G.
  assert (INR n * u * (INR n * u) <= / 16 * / 16) by (apply Rmult_le_compat; lra).
  pose proof (power_at_least_1 prec n).
  assert (L : lost n <= INR n).
  { unfold corners.lost. assert (/ 2 * INR n * (1 + u) ^ n <= / 2 * INR n * 2) by (apply Rmult_le_compat_l; lra). lra. }
  pose proof (eta_below_safe prec emin) as E. pose proof (safe_at_least_1 prec emin).
  apply Rle_trans with (INR n * (u * safe)); [apply Rmult_le_compat; try lra |].
  - unfold corners.lost. apply Rmult_le_pos; lra.
  - rewrite <- Rmult_assoc. apply Rmult_le_compat_r; lra.
Qed.
Lemma approximates_below n c x X : INR n * u <= / 16 -> approximates n c x X (lost n) -> X <= safe ->
  Rabs c <= 3 / 2 * safe.
Proof.
  intros S (_ & B & E) L. pose proof (lost_small n S). pose proof (Rabs_pos x).
  pose proof (u_positive prec). pose proof (pos_INR n).
  assert (N0 : 0 <= INR n * u) by (apply Rmult_le_pos; lra).
  pose proof (growth_small prec n ltac:(lra)) as G. pose proof (growth_nonnegative prec n).
  assert (INR n * u * (INR n * u) <= / 16 * / 16) by (apply Rmult_le_compat; lra).
  assert (growth n * X <= / 8 * safe) by (apply Rmult_le_compat; lra).
  replace c with (x + (c - x)) by ring. pose proof (Rabs_triang x (c - x)). lra.
Qed.

Definition base_step (s : num) (m : entry) : num := add o s (mul o (entry_l m) (entry_b m)).
Definition real_base_step (s : R) (m : model.entry (num := R)) : R := fl (s + fl (entry_l m * entry_b m)).
Notation exact_base := (sum (fun m => entry_l m * entry_b m)).
Notation base_size := (sum (fun m => entry_l m * Rabs (entry_b m))).

Lemma size_nonnegative nodes : Forall (corner_entry prec emin) nodes -> 0 <= base_size nodes.
Proof.
  intros F. apply sum_nonnegative. apply Forall_impl with (2 := F). intros m (_ & _ & (P & _) & _).
  apply Rmult_le_pos; [exact P | apply Rabs_pos].
Qed.

Lemma product_forward most m : entry_below most m ->
  finite (mul o (entry_l m) (entry_b m)) /\
  val (mul o (entry_l m) (entry_b m)) = fl (val (entry_l m) * val (entry_b m)) /\
  Rabs (val (mul o (entry_l m) (entry_b m))) <= most.
Proof.
  intros ((L & _ & _ & _ & O & P) & B & M).
  destruct (mul_shrinks prec emin I (entry_l m) (entry_b m) L B) as (F & V & S); [rewrite Rabs_pos_eq; lra |].
  split; [exact F |]. split; [exact V |]. lra.
Qed.

Lemma base_forward most nodes : most <= safe -> Forall (entry_below most) nodes ->
  forall n s e X, (1 <= n)%nat -> finite s -> approximates n (val s) e X (lost n) ->
  INR (n + length nodes) * u <= / 16 -> X + base_size (map entry_value nodes) <= safe ->
  let r := fold_left base_step nodes s in
  finite r /\ val r = fold_left real_base_step (map entry_value nodes) (val s) /\ Rabs (val r) <= 3 / 2 * safe.
Proof.
  intros M. pose proof (safe_at_least_1 prec emin) as S1.
  induction 1 as [| m nodes B F IH]; intros n s e X N Fs A S L; cbn [fold_left map].
  - split; [exact Fs |]. split; [reflexivity |]. cbn [length] in S. rewrite Nat.add_0_r in S.
    apply (approximates_below n _ e X S A). unfold sum in L. simpl in L. lra.
  - pose proof (entry_below_corner most m B) as C. pose proof (u_positive prec) as U.
    assert (R : Forall (corner_entry prec emin) (map entry_value nodes)).
    { apply Forall_map. apply Forall_impl with (2 := F). intros a. apply entry_below_corner. }
    pose proof (size_nonnegative _ R) as R0. pose proof (size_nonnegative [entry_value m] (Forall_cons _ C
      (Forall_nil _)))
      as C0. rewrite sum_cons in C0. unfold sum at 1 in C0. cbn [fold_right] in C0.
    cbn [map] in L. rewrite sum_cons in L. cbn [length] in S.
    assert (Sn : INR n * u <= / 16).
    { apply Rle_trans with (2 := S). apply Rmult_le_compat_r; [lra |]. apply le_INR. lia. }
    pose proof (approximates_below n _ e X Sn A ltac:(lra)) as Bs.
    destruct (product_forward most m B) as (Fp & Vp & Bp).
    destruct (add_forward prec emin I s _ Fs Fp) as [Fa Va].
    { pose proof (Rabs_triang (val s) (val (mul o (entry_l m) (entry_b m)))). lra. }
    assert (V : val (base_step s m) = real_base_step (val s) (entry_value m)).
    { unfold base_step, real_base_step. rewrite Va, Vp. reflexivity. }
    pose proof (base_from prec emin [entry_value m] (Forall_cons _ C (Forall_nil _)) n (val s) e X N A) as A'.
    cbn [fold_left length] in A'. rewrite !sum_cons in A'. unfold sum in A'. cbn [fold_right] in A'.
    rewrite !Rplus_0_r in A'. fold (real_base_step (val s) (entry_value m)) in A'. rewrite <- V in A' |- *.
    apply (IH (n + 1)%nat _ _ _ ltac:(lia) Fa A'); [| lra].
    replace (n + 1 + length nodes)%nat with (n + Datatypes.S (length nodes))%nat by lia. exact S.
Qed.

Lemma corner_base_forward most nodes : most <= safe -> nodes <> [] -> Forall (entry_below most) nodes ->
  INR (length nodes) * u <= / 16 -> sum entry_l (map entry_value nodes) <= 1 ->
  finite (corner_base o nodes) /\ val (corner_base o nodes) = corner_base real_ops (map entry_value nodes) /\
  Rabs (val (corner_base o nodes)) <= 3 / 2 * safe.
Proof.
  intros M Ne F S SL. destruct nodes as [| m nodes]; [congruence |]. clear Ne.
  assert (Size : base_size (map entry_value (m :: nodes)) <= safe).
  { apply Rle_trans with (most * sum entry_l (map entry_value (m :: nodes))).
    - rewrite <- sum_scale. apply sum_le. apply Forall_map. apply Forall_impl with (2 := F).
      intros a ((_ & _ & _ & _ & O & _) & _ & B). cbn [entry_value entry_l entry_b]. rewrite (Rmult_comm most).
      apply Rmult_le_compat_l; [lra | exact B].
    - inversion F as [| ? ? (_ & _ & B) _]; subst. pose proof (Rabs_pos (val (entry_b m))).
      assert (most * sum entry_l (map entry_value (m :: nodes)) <= most * 1) by (apply Rmult_le_compat_l; lra). lra. }
  inversion F as [| ? ? B F']; subst. pose proof (entry_below_corner most m B) as C.
  destruct (product_forward most m B) as (Fp & Vp & Bp). destruct (zero_value prec emin I) as [FZ VZ].
  destruct (add_forward prec emin I (zero o) _ FZ Fp) as [Fa Va].
  { rewrite VZ, Rplus_0_l. pose proof (safe_at_least_1 prec emin). lra. }
  pose proof (base_approximates prec emin (entry_value m) [] (Forall_cons _ C (Forall_nil _))) as A.
  unfold corner_base in A |- *. rewrite model_zero in A |- *. cbn [fold_left map length] in A |- *.
  assert (V : val (base_step (zero o) m) = real_base_step 0 (entry_value m)).
  { unfold base_step, real_base_step. rewrite Va, Vp, VZ. reflexivity. }
  change (add real_ops 0 (mul real_ops (entry_l (entry_value m)) (entry_b (entry_value m))))
    with (real_base_step 0 (entry_value m)) in A |- *. rewrite <- V in A |- *.
  change (add o (zero o) (mul o (entry_l m) (entry_b m))) with (base_step (zero o) m).
  apply (base_forward most nodes M F' 1 _ _ _ (le_n 1) Fa A S).
  rewrite sum_cons. unfold sum at 1. cbn [fold_right]. cbn [map] in Size. rewrite sum_cons in Size. lra.
Qed.

Lemma slack_forward most nodes : Forall (entry_below most) nodes -> forall s, finite s -> dyadic (val s) -> val s <=
  1 ->
  0 <= val s - sum entry_l (map entry_value nodes) ->
  let r := fold_left (fun s n => sub o s (entry_l n)) nodes s in
  finite r /\ val r = val s - sum entry_l (map entry_value nodes).
Proof.
  induction 1 as [| e nodes ((L & _ & D & _ & P & Q) & _ & _) F IH]; intros s Fs Ds S R; cbn [fold_left map].
  - split; [exact Fs |]. unfold sum. simpl. now rewrite Rminus_0_r.
  - cbn [map] in R. rewrite sum_cons in *. cbn [entry_value entry_l] in R |- *.
    assert (0 <= sum entry_l (map entry_value nodes)).
    { apply sum_nonnegative. apply Forall_map. apply Forall_impl with (2 := F). intros a ((_ & _ & _ & _ & Pa & _) & _).
      exact (proj1 Pa). }
    pose proof (safe_at_least_1 prec emin).
    destruct (sub_forward prec emin I s _ Fs L) as [Fd Vd]; [apply Rabs_le; lra |].
    rewrite (fl_id prec emin) in Vd by (apply (dyadic_number prec emin); [now apply dyadic_sub | apply Rabs_le; lra]).
    specialize (IH _ Fd). rewrite Vd in IH. destruct IH as [Fr Vr]; [now apply dyadic_sub | lra | lra |].
    split; [exact Fr |]. cbv zeta. rewrite Vr. ring.
Qed.

Lemma one_value : finite (constant o 1 0) /\ val (constant o 1 0) = 1.
Proof.
  pose proof (two_power_large prec emin). destruct (exponents prec emin) as (E & _).
  destruct (constant_value prec emin I 1 0) as [F V]; [change (Z.abs 1) with 1%Z; lia | lia |].
  split; [exact F |]. rewrite V. simpl. ring.
Qed.

Lemma corner_forward most nodes i j : most <= safe -> nodes <> [] -> Forall (entry_below most) nodes ->
  INR (length nodes) * u <= / 16 -> sum entry_l (map entry_value nodes) <= 1 -> In i nodes -> In j nodes ->
  let c := corner_value o (corner_base o nodes) (corner_slack o nodes) i j in
  finite c /\ val c = corner_value real_ops (corner_base real_ops (map entry_value nodes))
                        (corner_slack real_ops (map entry_value nodes)) (entry_value i) (entry_value j).
Proof.
  intros M Ne F S SL Ii Ij c. pose proof (safe_at_least_1 prec emin) as S1.
  destruct (corner_base_forward most nodes M Ne F S SL) as (FB & VB & BB).
  assert (C : Forall (corner_entry prec emin) (map entry_value nodes)).
  { apply Forall_map. apply Forall_impl with (2 := F). intros a. apply entry_below_corner. }
  assert (P : 0 <= sum entry_l (map entry_value nodes)).
  { apply sum_nonnegative. apply Forall_impl with (2 := C). intros a (_ & _ & (Q & _) & _). exact Q. }
  destruct one_value as [F1 V1]. pose proof (dyadic_1 prec emin) as D1.
  destruct (slack_forward most nodes F (constant o 1 0) F1) as [FS VS]; try (rewrite V1; first [exact D1 | lra]).
  fold (corner_slack o nodes) in FS, VS. rewrite V1 in VS.
  destruct (slack_exact prec emin _ C 1 D1 (Rle_refl 1)) as [ES DS]; [lra |].
  assert (CS : corner_slack real_ops (map entry_value nodes) = 1 - sum entry_l (map entry_value nodes)).
  { unfold corner_slack. cbn [sub constant real_model.real_ops]. simpl (bpow radix2 0). rewrite Rmult_1_r. exact ES. }
  rewrite <- VS in CS, DS. rewrite Forall_forall in F.
  destruct (F i Ii) as ((Li & Hi & Dl & Dh & Oi & Pi) & Bi & Mi). destruct (F j Ij) as (_ & Bj & Mj).
  destruct (sub_forward prec emin I _ _ Hi Li) as [FR VR]; [apply Rabs_le; lra |].
  set (range := sub o (entry_h i) (entry_l i)) in *.
  assert (ER : val range = val (entry_h i) - val (entry_l i)).
  { rewrite VR. apply (fl_id prec emin), (dyadic_number prec emin); [now apply dyadic_sub | apply Rabs_le; lra]. }
  assert (DR : dyadic (val range)) by (rewrite ER; now apply dyadic_sub).
  destruct (sub_forward prec emin I _ _ FS FR) as [FD VD]; [apply Rabs_le; lra |].
  assert (ED : val (sub o (corner_slack o nodes) range) = val (corner_slack o nodes) - val range).
  { rewrite VD. apply (fl_id prec emin), (dyadic_number prec emin); [now apply dyadic_sub | apply Rabs_le; lra]. }
  destruct (mul_shrinks prec emin I range (entry_b i) FR Bi) as (FI & VI & SI); [apply Rabs_le; lra |].
  destruct (mul_shrinks prec emin I _ (entry_b j) FD Bj) as (FJ & VJ & SJ); [rewrite ED; apply Rabs_le; lra |].
  destruct (add_forward prec emin I _ _ FB FI) as [FA VA].
  { pose proof (Rabs_triang (val (corner_base o nodes)) (val (mul o range (entry_b i)))). lra. }
  assert (BA : Rabs (val (add o (corner_base o nodes) (mul o range (entry_b i)))) <= 4 * safe).
  { rewrite VA, <- (fl_abs prec emin). apply (fl_below prec emin).
    - pose proof (Rabs_triang (val (corner_base o nodes)) (val (mul o range (entry_b i)))). lra.
    - exact (safe_number prec emin 2 ltac:(lia)). }
  destruct (add_forward prec emin I _ _ FA FJ) as [FC VC].
  { pose proof (Rabs_triang (val (add o (corner_base o nodes) (mul o range (entry_b i))))
                  (val (mul o (sub o (corner_slack o nodes) range) (entry_b j)))). lra. }
  split; [exact FC |]. unfold c, corner_value. fold range. rewrite VC, VA, VI, VJ, VD, VB, VR.
  cbn [add sub mul real_model.real_ops entry_value entry_l entry_h entry_b]. rewrite CS. reflexivity.
Qed.

(* The largest magnitude. *)
Lemma magnitude_finite nodes : Forall (fun e => finite (entry_b e) \/ view (entry_b e) = Plus) nodes ->
  less o (corner_magnitude o nodes) (most_safe o) = true ->
  finite (corner_magnitude o nodes) /\ val (corner_magnitude o nodes) <= safe /\
  Forall (fun e => finite (entry_b e) /\ Rabs (val (entry_b e)) <= val (corner_magnitude o nodes)) nodes.
Proof.
  intros F L. destruct (most_safe_value prec emin I) as [FS VS].
  assert (E : corner_magnitude o nodes = greatest o (zero o) (map (fun e => absolute o (entry_b e)) nodes)).
  { unfold corner_magnitude, greatest. generalize (zero o). clear. induction nodes as [| e nodes IH]; intros s;
      [reflexivity |]. cbn [fold_left map]. apply IH. }
  assert (FA : Forall (fun b => finite b \/ view b = Plus)
                 (zero o :: map (fun e => absolute o (entry_b e)) nodes)).
  { constructor; [left; apply (zero_value prec emin I) |]. apply Forall_map. apply Forall_impl with (2 := F).
    intros e [H | H]; [left; apply (absolute_forward prec emin I _ H) |]. right. now rewrite (law_absolute _ _ _ _
      I), H. }
  assert (FM : finite (corner_magnitude o nodes)).
  { assert (G : forall s t, Forall (fun b => finite b \/ view b = Plus) (s :: t) ->
                  finite (greatest o s t) \/ view (greatest o s t) = Plus).
    { intros s t. revert s. induction t as [| a t IH]; intros s H; unfold greatest; cbn [fold_left];
        inversion H as [| ? ? Hs H']; subst; [exact Hs |]. apply IH. inversion H' as [| ? ? Ha Ht]; subst.
      constructor; [unfold max; destruct (less o s a); assumption | exact Ht]. }
    destruct (G _ _ FA) as [H | H]; rewrite <- E in H; [exact H |].
    rewrite (law_less _ _ _ _ I), H, (view_val _ FS) in L. discriminate. }
  split; [exact FM |]. split.
  - rewrite (less_finite prec emin I _ _ FM FS), VS in L. revert L. case Rlt_bool_spec; [intros; lra | discriminate].
  - rewrite E in FM. pose proof (greatest_finite prec emin I _ _ FA FM) as H. rewrite <- E in H.
    apply Forall_inv_tail in H. rewrite Forall_map in H. rewrite Forall_forall in F, H |- *. intros e Ie.
    destruct (H e Ie) as [Fa La]. apply (absolute_backward prec emin I) in Fa. destruct Fa as [Fb Vb].
    split; [exact Fb |]. now rewrite <- Vb.
Qed.

Lemma magnitude_value nodes : Forall (fun e => finite (entry_b e)) nodes ->
  val (corner_magnitude o nodes) = corner_magnitude real_ops (map entry_value nodes).
Proof.
  intros F. unfold corner_magnitude.
  assert (H : forall s, finite s -> let r := fold_left (fun s n => max o s (absolute o (entry_b n))) nodes s in
    val r = fold_left (fun s n => max real_ops s (absolute real_ops (entry_b n))) (map entry_value nodes) (val s)).
  { induction F as [| e nodes B _ IH]; intros s Fs; cbn [fold_left map]; [reflexivity |].
    destruct (absolute_forward prec emin I _ B) as [Fa Va].
    destruct (max_finite prec emin I s _ Fs Fa) as [Fm _]. rewrite (IH _ Fm), (max_value prec emin I s _ Fs Fa), Va.
    reflexivity. }
  destruct (zero_value prec emin I) as [FZ VZ]. rewrite (H _ FZ), VZ, model_zero. reflexivity.
Qed.

Lemma corner_error_backward nodes : (8 * length_of nodes + 64 < 2 ^ prec)%Z ->
  Forall (fun e => finite (entry_b e)) nodes -> finite (corner_error o nodes) ->
  val (corner_error o nodes) = corner_error real_ops (map entry_value nodes).
Proof.
  intros N B F. pose proof (Zle_0_nat (length nodes)). fold (length_of nodes) in H.
  destruct (exponents prec emin) as (E & _).
  assert (C : forall k, (0 <= k < 2 ^ prec)%Z -> val (constant o k 0) = constant real_ops k 0).
  { intros k K. apply (constant_value prec emin I); lia. }
  unfold corner_error in *. apply (succ_backward prec emin I) in F. destruct F as (F & ->).
  apply (add_backward prec emin I) in F. destruct F as (F & G & ->).
  apply (mul_backward prec emin I) in F, G. destruct F as (F & _ & ->). destruct G as (G & _ & ->).
  apply (mul_backward prec emin I) in F, G. destruct F as (F & _ & ->). destruct G as (_ & _ & ->).
  apply (mul_backward prec emin I) in F. destruct F as (_ & F & ->).
  apply (add_backward prec emin I) in F. destruct F as (_ & _ & ->).
  rewrite !C by lia. rewrite (magnitude_value nodes B), (proj2 (unit_value prec emin I)).
  rewrite (proj2 (smallest_value prec emin I 1 ltac:(change (Z.abs 1) with 1%Z; lia))).
  unfold length_of. rewrite map_length. reflexivity.
Qed.

Lemma best_finite base slack ps : forall r,
  (forall i others j, In (i, others) ps -> In j others -> finite (corner_value o base slack i j)) ->
  let top := fold_left (fun best p => fold_left (fun best j => max o best (corner_value o base slack (fst p) j))
                                                (snd p) best) ps r in
  finite top -> (finite r \/ view r = Minus) /\ (finite r -> val r <= val top) /\
  forall i others j, In (i, others) ps -> In j others -> val (corner_value o base slack i j) <= val top.
Proof.
  induction ps as [| [i others] ps IH]; intros r F top T; unfold top in *; cbn [fold_left fst snd] in *.
  - split; [now left |]. split; [intros _; apply Rle_refl |]. contradiction.
  - destruct (IH _ (fun i t j Ip Ij => F i t j (or_intror Ip) Ij) T) as (R & L & G). clear IH.
    assert (Fi : Forall (fun j => finite (corner_value o base slack i j)) others).
    { apply Forall_forall. intros j J. exact (F i others j (or_introl eq_refl) J). }
    destruct R as [R | R].
    + destruct (fold_max_finite prec emin I (fun j => corner_value o base slack i j) others r Fi R) as (R1 & R2 & R3).
      specialize (L R). split; [exact R1 |]. split; [intros Fr; specialize (R2 Fr); lra |].
      intros i' t j [Eq | In'] J; [| now apply G with t]. injection Eq as <- <-. rewrite Forall_forall in R3.
      specialize (R3 j J). lra.
    + (* it stays -infinity only where there are no others *)
      destruct others as [| j others].
      { cbn [fold_left] in R. split; [now right |]. split; [intros [q Q]; congruence |].
        intros i' t j [Eq | In'] J; [injection Eq as <- <-; contradiction | now apply G with t]. }
      exfalso. assert (Up : forall s q, finite q \/ view q = Plus \/ view q = Nan -> Forall (fun j =>
        finite (corner_value o base slack i j)) s ->
        view (fold_left (fun best j => max o best (corner_value o base slack i j)) s q) <> Minus).
      { induction s as [| a s IHs]; intros q Q Fs; cbn [fold_left].
        - destruct Q as [[v Q] | [Q | Q]]; rewrite Q; discriminate.
        - inversion Fs as [| ? ? Fa Fs']; subst. apply IHs; [| exact Fs'].
          unfold max. destruct less; [now left | exact Q]. }
      cbn [fold_left] in R. inversion Fi as [| ? ? Fj Ft]; subst.
      apply Up in R; [exact R | | exact Ft]. unfold max. rewrite (law_less _ _ _ _ I), (view_val _ Fj).
      destruct (view r) eqn:E; cbn [less_value]; [| | now left |].
      * destruct Rlt_bool; left; [exact Fj | now exists r0].
      * right; now left.
      * right; now right.
Qed.

Lemma best_corner_finite nodes : nodes <> [] ->
  Forall (fun e => finite (entry_b e) \/ view (entry_b e) = Plus) nodes -> finite (best_corner o nodes) ->
  Forall (fun e => finite (entry_b e)) nodes.
Proof.
  intros Ne P F. destruct nodes as [| a [| b nodes]]; [congruence | now repeat constructor |].
  unfold best_corner in F. destruct (less o (corner_magnitude o (a :: b :: nodes)) (most_safe o)) eqn:L;
    [| now apply (infinity_not_finite prec emin I) in F].
  destruct (magnitude_finite _ P L) as (_ & _ & B). apply Forall_impl with (2 := B). intros e [Q _]. exact Q.
Qed.

Theorem best_corner_sound nodes weights : nodes <> [] ->
  Forall (fun e => unit_interval (entry_l e) (entry_h e) /\ (finite (entry_b e) \/ view (entry_b e) = Plus)) nodes ->
  INR (length nodes + 8) * u <= / 16 ->
  map fst weights = map (fun e => node_of_entry (entry_value e)) nodes -> in_space weights ->
  finite (best_corner o nodes) -> mean weights <= val (best_corner o nodes).
Proof.
  intros Ne H Sm E W F. rewrite <- (map_map entry_value node_of_entry) in E. destruct nodes as [| a [| b nodes]];
    [congruence | |].
  { exact (only_node (entry_value a) weights E W). }
  set (all := a :: b :: nodes) in *.
  change (best_corner o all) with (if less o (corner_magnitude o all) (most_safe o) then corner_bound o all
                                   else infinity o) in *.
  destruct (less o (corner_magnitude o all) (most_safe o)) eqn:L;
    [| now apply (infinity_not_finite prec emin I) in F].
  destruct (magnitude_finite all) as (FM & SM & B); [| exact L |].
  { apply Forall_impl with (2 := H). intros e [_ P]. exact P. }
  set (most := val (corner_magnitude o all)) in *.
  assert (EB : Forall (entry_below most) all).
  { rewrite Forall_forall in H, B |- *. intros e Ie. split; [exact (proj1 (H e Ie)) | exact (B e Ie)]. }
  assert (Bf : Forall (fun e => finite (entry_b e)) all) by (apply Forall_impl with (2 := B); intros e [P _]; exact P).
  assert (C : Forall (corner_entry prec emin) (map entry_value all)).
  { apply Forall_map. apply Forall_impl with (2 := EB). intros e. apply entry_below_corner. }
  assert (SL : sum entry_l (map entry_value all) <= 1).
  { destruct W as [Win Wsum]. rewrite <- Wsum.
    assert (Q : sum entry_l (map entry_value all) = sum (fun p => low (fst p)) weights).
    { transitivity (sum low (map node_of_entry (map entry_value all)));
        [symmetry; exact (sum_map node_of_entry low (map entry_value all)) |].
      rewrite <- E. now rewrite sum_map. }
    rewrite Q. apply sum_le. apply Forall_impl with (2 := Win). intros p [P _]. exact P. }
  pose proof (u_positive prec) as U.
  assert (Sm' : INR (length all) * u <= / 16).
  { apply Rle_trans with (2 := Sm). apply Rmult_le_compat_r; [lra |]. apply le_INR. lia. }
  assert (Len : length (map entry_value all) = length all) by apply map_length.
  assert (Big : (8 * length_of all + 64 < 2 ^ prec)%Z).
  { pose proof (@prec_large prec emin format). apply lt_IZR. unfold length_of.
    rewrite IZR_power, plus_IZR, mult_IZR, <- INR_IZR_INZ by lia.
    assert (HU : u * bpow radix2 prec = 1)
      by (unfold u, rounding.u; rewrite <- bpow_plus, Z.add_opp_diag_l; reflexivity).
    pose proof (bpow_gt_0 radix2 prec). rewrite plus_INR in Sm. replace (INR 8) with 8 in Sm by (simpl; ring).
    assert ((INR (length all) + 8) * (u * bpow radix2 prec) <= / 16 * bpow radix2 prec)
      by (rewrite <- Rmult_assoc; apply Rmult_le_compat_r; lra). rewrite HU in *. lra. }
  rewrite <- Len in Sm. destruct (some_corner prec emin (map entry_value all) weights) as (i & t & j & Ip & Ij & M);
    [rewrite Len; unfold all; simpl; lia | exact C | exact Sm | exact E | exact W |].
  unfold corner_bound in *. apply (succ_backward prec emin I) in F. destruct F as (F & ->).
  apply (add_backward prec emin I) in F. destruct F as (FB & FE & ->).
  pose proof (corner_error_backward all Big Bf FE) as VE.
  assert (Inside : forall i t j, In (i, t) (picks [] all) -> In j t -> In i all /\ In j all).
  { intros i' t' j' P J. destruct (picks_within all [] i' t' P) as [Q R]. split; [exact Q | exact (R j' J)]. }
  destruct (best_finite (corner_base o all) (corner_slack o all) (picks [] all) (lowest o)) as (_ & _ & G);
    [| exact FB |].
  { intros i' t' j' P J. destruct (Inside i' t' j' P J) as [Q R]. apply (corner_forward most all i' j' SM Ne EB Sm'
    SL Q R). }
  change ([] : list (model.entry (num := R))) with (map entry_value []) in Ip. rewrite picks_map in Ip.
  apply in_map_iff in Ip. destruct Ip as ([i' t'] & Eq & Ip). cbn [fst snd] in Eq. injection Eq as <- <-.
  apply in_map_iff in Ij. destruct Ij as (j' & <- & Ij). specialize (G i' t' j' Ip Ij).
  destruct (Inside i' t' j' Ip Ij) as [Q R]. destruct (corner_forward most all i' j' SM Ne EB Sm' SL Q R) as [_ V].
  rewrite V in G. fold (best_of_corners o all) in G. rewrite (model_succ prec emin). cbn [add real_model.real_ops].
  pose proof (below_succ_fl prec emin (val (best_of_corners o all) + val (corner_error o all))) as S1.
  rewrite VE in S1 at 1. lra.
Qed.
End Ieee_corners.
