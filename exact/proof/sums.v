(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* Sums in any order, as binary trees: left to right, in lanes that are added at the end, or pairwise. *)
From Coq Require Import Reals Lra Lia ZArith List.
From Flocq Require Import Core.
From CinchProof Require Import duality rounding approximation.
Import ListNotations.
Open Scope R_scope.

Inductive tree := Leaf (computed exact : R) | Fork (a b : tree).

Fixpoint leaves (t : tree) : list (R * R) :=
  match t with Leaf c x => [(c, x)] | Fork a b => leaves a ++ leaves b end.
Fixpoint depth (t : tree) : nat := match t with Leaf _ _ => 0 | Fork a b => S (Nat.max (depth a) (depth b)) end.

Section Sums.
Variables prec emin : Z.
Context {format : Format prec emin}.
Notation fl := (fl prec emin).
Notation number := (number prec emin).
Notation u := (u prec).

(* The computed sum, and the computed sum of the absolute values in the same order. *)
Fixpoint computed_sum (t : tree) : R :=
  match t with Leaf c _ => c | Fork a b => fl (computed_sum a + computed_sum b) end.
Fixpoint computed_absolute (t : tree) : R :=
  match t with Leaf c _ => Rabs c | Fork a b => fl (computed_absolute a + computed_absolute b) end.
Definition exact_sum (t : tree) : R := sum snd (leaves t).
Definition leaf_errors (t : tree) : R := sum (fun p => Rabs (fst p - snd p)) (leaves t).
Definition leaf_absolutes (t : tree) : R := sum (fun p => Rabs (fst p)) (leaves t).
Definition numbers (t : tree) : Prop := Forall (fun p => number (fst p)) (leaves t).

Lemma computed_numbers t : numbers t -> number (computed_sum t) /\ number (computed_absolute t).
Proof.
  unfold numbers. destruct t as [c x | a b]; intros F.
  - apply Forall_inv in F. simpl in *. split; [exact F | now apply (number_abs prec emin)].
  - simpl. split; apply (fl_number prec emin).
Qed.

Lemma computed_below t : numbers t -> Rabs (computed_sum t) <= computed_absolute t.
Proof.
  unfold numbers. induction t as [c x | a IHa b IHb]; simpl; intros F; [apply Rle_refl |].
  apply Forall_app in F. destruct F as [Fa Fb]. specialize (IHa Fa). specialize (IHb Fb).
  rewrite <- (fl_abs prec emin). apply (fl_le prec emin).
  pose proof (Rabs_triang (computed_sum a) (computed_sum b)). lra.
Qed.

Lemma leaves_positive t : (1 <= length (leaves t))%nat.
Proof. induction t; simpl; [lia |]. rewrite app_length. lia. Qed.

(* m leaves: m - 1 roundings, each of at most u times the computed sum of absolute values, whatever the order and
   however many they are. *)
Theorem sum_error_by_count t :
  numbers t ->
  Rabs (computed_sum t - exact_sum t) <= INR (length (leaves t) - 1) * u * computed_absolute t + leaf_errors t.
Proof.
  pose proof (u_positive prec) as U.
  induction t as [c x | a IHa b IHb]; intros F; pose proof F as F0; unfold numbers in F; simpl in F.
  - unfold exact_sum, leaf_errors, sum. simpl. rewrite !Rplus_0_r. lra.
  - apply Forall_app in F. destruct F as [Fa Fb]. specialize (IHa Fa). specialize (IHb Fb).
    pose proof (leaves_positive a). pose proof (leaves_positive b).
    unfold exact_sum, leaf_errors in *. simpl. rewrite !sum_app, app_length.
    replace (length (leaves a) + length (leaves b) - 1)%nat
      with ((length (leaves a) - 1) + (length (leaves b) - 1) + 1)%nat by lia.
    rewrite !plus_INR. change (INR 1) with 1.
    destruct (computed_numbers a Fa) as [Na Aa]. destruct (computed_numbers b Fb) as [Nb Ab].
    pose proof (fl_plus_error_result prec emin _ _ Na Nb) as E.
    pose proof (computed_below _ F0) as B. simpl in B.
    pose proof (computed_below a Fa) as Ba. pose proof (computed_below b Fb) as Bb.
    pose proof (Rabs_pos (computed_sum a)). pose proof (Rabs_pos (computed_sum b)).
    set (A := fl (computed_absolute a + computed_absolute b)) in *.
    assert (GA : computed_absolute a <= A) by (apply (fl_above prec emin); [lra | exact Aa]).
    assert (GB : computed_absolute b <= A) by (apply (fl_above prec emin); [lra | exact Ab]).
    pose proof (pos_INR (length (leaves a) - 1)) as IA. pose proof (pos_INR (length (leaves b) - 1)) as IB.
    set (ka := INR (length (leaves a) - 1)) in *. set (kb := INR (length (leaves b) - 1)) in *.
    set (ea := sum snd (leaves a)) in *. set (eb := sum snd (leaves b)) in *.
    assert (ka * u * computed_absolute a <= ka * u * A) by (apply Rmult_le_compat_l; [apply Rmult_le_pos |]; lra).
    assert (kb * u * computed_absolute b <= kb * u * A) by (apply Rmult_le_compat_l; [apply Rmult_le_pos |]; lra).
    set (s := fl (computed_sum a + computed_sum b)) in *.
    assert (u * Rabs s <= u * A) by (apply Rmult_le_compat_l; lra).
    replace (s - (ea + eb)) with
      ((s - (computed_sum a + computed_sum b)) + ((computed_sum a - ea) + (computed_sum b - eb))) by ring.
    pose proof (Rabs_triang (s - (computed_sum a + computed_sum b)) ((computed_sum a - ea) + (computed_sum b - eb))).
    pose proof (Rabs_triang (computed_sum a - ea) (computed_sum b - eb)). lra.
Qed.

(* Depth d: (1 + u)^d - 1 times the exact sum of absolute values. Eight lanes that are added in a tree of three levels
   have the depth ceil(n / 8) + 2. *)
Theorem sum_error_by_depth t :
  numbers t -> Forall (fun p => fst p = snd p) (leaves t) ->
  Rabs (computed_sum t - exact_sum t) <= growth prec (depth t) * leaf_absolutes t.
Proof.
  intros F E.
  assert (H : approximates prec emin (depth t) (computed_sum t) (exact_sum t) (leaf_absolutes t) 0).
  { induction t as [c x | a IHa b IHb]; unfold numbers in F; simpl in F, E.
    - apply Forall_inv in F, E. simpl in *. subst x. unfold exact_sum, leaf_absolutes, sum. simpl.
      rewrite !Rplus_0_r. now apply (approximates_exact prec emin).
    - apply Forall_app in F, E. destruct F as [Fa Fb]. destruct E as [Ea Eb].
      unfold exact_sum, leaf_absolutes in *. simpl. rewrite !sum_app.
      replace 0 with ((1 + u) * (0 + 0)) by ring.
      apply (approximates_add prec emin);
        eapply (approximates_weaken prec emin); [| | now apply IHa | | | now apply IHb]; lia || lra. }
  destruct H as (_ & _ & H). lra.
Qed.
End Sums.

(* Left to right. *)
Fixpoint chain (t : tree) (s : list (R * R)) : tree :=
  match s with [] => t | (c, x) :: r => chain (Fork t (Leaf c x)) r end.
Lemma computed_chain prec emin s : forall t,
  computed_sum prec emin (chain t s) =
  fold_left (fun r p => fl prec emin (r + fst p)) s (computed_sum prec emin t).
Proof. induction s as [| [c x] s IH]; intros t; [reflexivity |]. simpl. now rewrite IH. Qed.
Lemma depth_chain s : forall t, depth (chain t s) = (depth t + length s)%nat.
Proof. induction s as [| [c x] s IH]; intros t; simpl; [lia |]. rewrite IH. simpl. lia. Qed.
