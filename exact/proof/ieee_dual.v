(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* dual_bound over IEEE values: a finite result means that nothing overflowed and no NaN came up on the way, and is at
   least the exact D(lambda); it is never NaN and never -infinity. The error terms, likewise. *)
From Coq Require Import Reals Lra Lia ZArith List Bool.
From Flocq Require Import Core.
From CinchProof Require Import duality rounding successor model real_model dual_bound ieee.
Import ListNotations.
Open Scope R_scope.

Section Ieee_dual.
Variables prec emin : Z.
Context {format : Format prec emin}.
Notation u := (u prec).
Notation real_ops := (real_ops prec emin).
Context {num : Type} {o : ops num} {view : num -> value}.
Variable I : ieee prec emin o view.
Notation finite := (finite (view := view)).
Notation val := (val (view := view)).

(* fl(fl(k u) M) + n eta as the error terms compute it. *)
Lemma term_backward k0 k1 n M :
  (0 <= k0)%Z -> (0 <= k1)%Z -> (k0 + k1 < 2 ^ prec)%Z -> (Z.abs n < 2 ^ prec)%Z ->
  let e (p : ops num) (m : num) := model.succ p (add p (mul p (mul p
             (add p (constant p k0 0) (constant p k1 0)) (unit_roundoff p)) m) (smallest_times p n)) in
  finite (e o M) ->
  finite M /\ val (e o M) = model.succ real_ops (add real_ops (mul real_ops (mul real_ops
             (add real_ops (constant real_ops k0 0) (constant real_ops k1 0)) (unit_roundoff real_ops)) (val M))
             (smallest_times real_ops n)).
Proof.
  intros K0 K1 K N e F. unfold e in *. apply (succ_backward prec emin I) in F. destruct F as (F & ->).
  apply (add_backward prec emin I) in F. destruct F as (F & _ & ->).
  apply (mul_backward prec emin I) in F. destruct F as (F & FM & ->).
  apply (mul_backward prec emin I) in F. destruct F as (F & _ & ->).
  apply (add_backward prec emin I) in F. destruct F as (_ & _ & ->).
  split; [exact FM |]. destruct (exponents prec emin) as (E & _).
  rewrite (proj2 (smallest_value prec emin I n N)), (proj2 (unit_value prec emin I)).
  rewrite (proj2 (constant_value prec emin I k0 0 ltac:(lia) ltac:(lia))).
  rewrite (proj2 (constant_value prec emin I k1 0 ltac:(lia) ltac:(lia))). reflexivity.
Qed.

Lemma sum_error_backward n A : (0 <= n)%Z -> (n + 4 < 2 ^ prec)%Z -> finite (sum_error o n A) ->
  finite A /\ val (sum_error o n A) = sum_error real_ops n (val A).
Proof. intros N B. apply (term_backward n 4 n A); lia. Qed.

Lemma evaluation_error_backward k M : (0 <= k)%Z -> (8 * (k + 8) < 2 ^ prec)%Z -> finite (evaluation_error o k M) ->
  finite M /\ val (evaluation_error o k M) = evaluation_error real_ops k (val M).
Proof. intros N B. apply (term_backward k 8 (8 * k) M); lia. Qed.

Lemma extremum_error_backward M : finite (extremum_error o M) ->
  finite M /\ val (extremum_error o M) = extremum_error real_ops (val M).
Proof.
  unfold extremum_error. intros F. pose proof (two_power_large prec emin). destruct (exponents prec emin) as (E & _).
  apply (succ_backward prec emin I) in F. destruct F as (F & ->).
  apply (add_backward prec emin I) in F. destruct F as (F & G & ->).
  apply (mul_backward prec emin I) in F, G. destruct F as (F & FM & ->). destruct G as (_ & _ & ->).
  apply (mul_backward prec emin I) in F. destruct F as (_ & _ & ->).
  split; [exact FM |].
  rewrite (proj2 (smallest_value prec emin I 1 ltac:(lia))), (proj2 (unit_value prec emin I)).
  rewrite (proj2 (constant_value prec emin I 10 0 ltac:(lia) ltac:(lia))).
  rewrite (proj2 (constant_value prec emin I 16 0 ltac:(lia) ltac:(lia))). reflexivity.
Qed.

(* The sums of dual_bound. *)
Notation entry := (entry (num := num)).
Definition entry_value (e : entry) : model.entry (num := R) :=
  Entry (val (entry_l e)) (val (entry_h e)) (val (entry_b e)).

Lemma product_backward lambda e : finite (dual_product o lambda e) ->
  finite lambda /\ finite (entry_b e) /\
  val (dual_product o lambda e) = dual_product real_ops (val lambda) (entry_value e).
Proof.
  unfold dual_product. intros F. apply (mul_backward prec emin I) in F. destruct F as (_ & F & ->).
  pose proof F as FS. apply (sub_backward prec emin I) in F. destruct F as (B & L & V).
  split; [exact L |]. split; [exact B |]. destruct (zero_value prec emin I) as [FZ VZ].
  rewrite (law_less_equal _ _ _ _ I), (view_val _ FZ), (view_val _ FS). cbn [less_equal_value].
  rewrite VZ, V. rewrite model_zero. cbn [mul sub less_equal real_model.real_ops entry_value entry_b entry_h entry_l].
  destruct Rle_bool; reflexivity.
Qed.

Lemma sums_backward lambda nodes : forall s A,
  finite (fst (fold_left (dual_step o lambda) nodes (s, A))) ->
  finite (snd (fold_left (dual_step o lambda) nodes (s, A))) ->
  finite s /\ finite A /\ (nodes <> [] -> finite lambda) /\ Forall (fun e => finite (entry_b e)) nodes /\
  let r := fold_left (dual_step o lambda) nodes (s, A) in
  (val (fst r), val (snd r)) = fold_left (dual_step real_ops (val lambda)) (map entry_value nodes) (val s, val A).
Proof.
  induction nodes as [| e nodes IH]; intros s A F G; cbn [fold_left] in *.
  - cbn [fst snd] in *. split; [exact F |]. split; [exact G |]. split; [congruence |].
  split; [constructor | reflexivity].
  - unfold dual_step at 2 in F. unfold dual_step at 2 in G. cbn [fst snd] in F, G.
    destruct (IH _ _ F G) as (S & B & _ & Fb & V).
    apply (add_backward prec emin I) in S, B. destruct S as (S & P & VS). destruct B as (B & Q & VB).
    apply (absolute_backward prec emin I) in Q. destruct Q as (_ & VQ).
    destruct (product_backward lambda e P) as (L & Be & VP).
    split; [exact S |]. split; [exact B |]. split; [trivial |]. split; [now constructor |]. cbn [map fold_left].
    unfold dual_step at 2.
    cbv zeta in V |- *. unfold dual_step at 3. cbn [fst snd]. rewrite V, VS, VB, VQ, VP. reflexivity.
Qed.

Lemma value_backward lambda nodes : (length_of nodes + 4 < 2 ^ prec)%Z ->
  finite (dual_value o lambda nodes) ->
  finite lambda /\ Forall (fun e => finite (entry_b e)) nodes /\
  val (dual_value o lambda nodes) = dual_value real_ops (val lambda) (map entry_value nodes).
Proof.
  intros N F. unfold dual_value, dual_sums in *.
  destruct (fold_left (dual_step o lambda) nodes (zero o, zero o)) as [s A] eqn:E.
  apply (succ_backward prec emin I) in F. destruct F as (F & ->).
  apply (add_backward prec emin I) in F. destruct F as (L & F & ->).
  apply (succ_backward prec emin I) in F. destruct F as (F & ->).
  apply (add_backward prec emin I) in F. destruct F as (S & F & ->).
  apply sum_error_backward in F; [| apply Zle_0_nat | exact N]. destruct F as (FA & ->).
  pose proof (sums_backward lambda nodes (zero o) (zero o)) as B. rewrite E in B. cbn [fst snd] in B.
  destruct (B S FA) as (_ & _ & _ & Fb & V). split; [exact L |]. split; [exact Fb |].
  destruct (zero_value prec emin I) as [_ VZ]. rewrite VZ in V. rewrite model_zero, <- V.
  unfold length_of. rewrite map_length. reflexivity.
Qed.

Lemma bound_is_value lambda nodes : finite (dual_bound o lambda nodes) ->
  dual_bound o lambda nodes = dual_value o lambda nodes.
Proof.
  unfold dual_bound. intros F. destruct (_ || _); [now apply (infinity_not_finite prec emin I) in F |].
  destruct less; [reflexivity | now apply (infinity_not_finite prec emin I) in F].
Qed.

(* The theorem about the function as it is: +infinity where anything overflows or is no number, else proven. *)
Theorem dual_bound_finite lambda nodes :
  IZR (length_of nodes) * u <= / 8 ->
  finite (dual_bound o lambda nodes) ->
  finite lambda /\ Forall (fun e => finite (entry_b e)) nodes /\
  dual (val lambda) (map (fun e => node_of_entry (entry_value e)) nodes) <= val (dual_bound o lambda nodes).
Proof.
  intros N F. pose proof (bound_is_value lambda nodes F) as E. rewrite E in *.
  destruct (value_backward lambda nodes (small_count prec emin _ N) F) as (L & B & ->).
  split; [exact L |]. split; [exact B |]. rewrite <- map_map.
  apply (dual_bound_at_least_exact prec emin).
  - apply (val_number prec emin I).
  - apply Forall_map, Forall_forall. intros e _. repeat split; apply (val_number prec emin I).
  - unfold length_of in *. now rewrite map_length.
Qed.

Theorem dual_bound_value_or_infinity lambda nodes :
  finite (dual_bound o lambda nodes) \/ view (dual_bound o lambda nodes) = Plus.
Proof.
  unfold dual_bound. destruct (_ || _); [right; apply (law_infinity _ _ _ _ I) |].
  destruct less eqn:L; [left | right; apply (law_infinity _ _ _ _ I)].
  unfold dual_value in *. destruct (dual_sums o lambda nodes). now apply (succ_below_infinity prec emin I).
Qed.
End Ieee_dual.
