(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* What is collected along the tree concerns every vertex below; and the tree is one: every BV has one way to it. *)
From Coq Require Import ZArith List Bool Permutation Lia.
From CinchChecker Require Import content statement table tree table_proof.
Import ListNotations.
Open Scope Z_scope.

Section Climb.
  Context {A : Type} (join : A -> A -> A) (own : Z -> option A) (R : A -> Z -> Prop).
  Context (Hown : forall v a, own v = Some a -> R a v).
  Context (Hleft : forall a b v, R a v -> R (join a b) v).
  Context (Hright : forall a b v, R b v -> R (join a b) v).

  Lemma joined_acc others : forall s a, fold_left (fun s w => join_known join s (own w)) others s = Some a ->
    exists b, s = Some b /\ (forall v, R b v -> R a v) /\ forall v, In v others -> R a v.
  Proof.
    induction others as [| w others IH]; intros s a E; cbn in E.
    - exists a. repeat split; auto. intros v [].
    - apply IH in E as (b & J & Keep & Rest). destruct s as [c |], (own w) as [d |] eqn:O; try easy.
      injection J as <-. exists c. repeat split; auto.
      intros v [<- | I]; [| now apply Rest]. apply Keep, Hright, Hown, O.
  Qed.

  Lemma joined_sound vs a : joined join own vs = Some a -> forall v, In v vs -> R a v.
  Proof.
    destruct vs as [| w others]; [easy |]. cbn. intro E. apply joined_acc in E as (b & O & Keep & Rest).
    intros v [<- | I]; [| now apply Rest]. apply Keep, Hown, O.
  Qed.

  Context (bs : list bv) (ts : list triangle).

  Let sound_at (i : Z) (a : A) : Prop := forall v, below bs ts i v -> R a v.

  Lemma collected_sound done b i a : at_index bs i = Some b ->
    (forall j c, get done j = Some c -> sound_at j c) ->
    collected join own done (held_by (table_of ts) b) = Some a -> sound_at i a.
  Proof.
    intros B D C v W. destruct W as [i l t tri v L I T K | i x y v L W | i x y v L W];
      rewrite L in B; injection B as <-; cbn in C.
    - apply (joined_sound _ _ C). apply (Permutation_in _ (Permutation_sym (gather_flat_map _ _))).
      apply in_flat_map. exists t. split; [easy |]. unfold corners_of. rewrite get_table_of, T.
      destruct K as [-> | [-> | ->]]; cbn; auto.
    - destruct (get done x) as [p |] eqn:P, (get done y) as [q |] eqn:Q; try easy. injection C as <-.
      apply Hleft. now apply (D x).
    - destruct (get done x) as [p |] eqn:P, (get done y) as [q |] eqn:Q; try easy. injection C as <-.
      apply Hright. now apply (D y).
  Qed.

  Lemma climb_sound left : forall after i done out,
    map (held_by (table_of ts)) bs = rev left ++ after -> i = count left - 1 -> length out = length after ->
    (forall j c, get done j = Some c -> sound_at j c) ->
    (forall n a, nth_error out n = Some (Some a) -> sound_at (i + 1 + Z.of_nat n) a) ->
    let result := climb join own i left done out in
    length result = length bs /\ forall j a, at_index result j = Some (Some a) -> sound_at j a.
  Proof.
    induction left as [| h others IH]; intros after i done out H I L D O.
    - cbn in H, I |- *. split.
      + rewrite L, <- H. apply map_length.
      + intros j a. unfold at_index. destruct (Z.ltb_spec j 0); [easy |]. intro E. apply O in E.
        now replace (i + 1 + Z.of_nat (Z.to_nat j)) with j in E by lia.
    - cbn [rev] in H. rewrite <- app_assoc in H. cbn [app] in H. cbn [climb].
      unfold count in I. cbn [length] in I.
      assert (at_index (map (held_by (table_of ts)) bs) i = Some h) as E.
      { rewrite H. unfold at_index. destruct (Z.ltb_spec i 0); [lia |].
        replace (Z.to_nat i) with (length (rev others)) by (rewrite rev_length; lia).
        rewrite nth_error_app2, Nat.sub_diag by lia. reflexivity. }
      rewrite at_index_map in E. destruct (at_index bs i) as [b |] eqn:B; [| easy]. injection E as <-.
      assert (forall s, (forall a, s = Some a -> sound_at i a) ->
        forall n a, nth_error (s :: out) n = Some (Some a) -> sound_at (i - 1 + 1 + Z.of_nat n) a) as Next.
      { intros s Here [| n] a F; cbn in F.
        - injection F as ->. replace (i - 1 + 1 + Z.of_nat 0) with i by lia. now apply Here.
        - replace (i - 1 + 1 + Z.of_nat (S n)) with (i + 1 + Z.of_nat n) by lia. now apply O. }
      destruct (collected join own done (held_by (table_of ts) b)) as [a |] eqn:C.
      + assert (sound_at i a) as Here by now apply (collected_sound done b).
        apply (IH (held_by (table_of ts) b :: after)); try easy; cbn [length]; try (unfold count; lia).
        * intros j c G. destruct (Z.eq_dec i j) as [<- | N].
          -- rewrite get_put_same in G by lia. now injection G as <-.
          -- rewrite get_put_other in G by lia. now apply D.
        * apply Next. intros a' E. now injection E as <-.
      + apply (IH (held_by (table_of ts) b :: after)); try easy; cbn [length]; try (unfold count; lia).
        apply Next. easy.
  Qed.
End Climb.

(* ---- One way to every BV ---- *)

Lemma NoDup_after {A : Type} (l m : list A) : NoDup (l ++ m) -> NoDup m.
Proof. induction l as [| x l IH]; cbn; [easy |]. intro N. inversion N. now apply IH. Qed.

Lemma owner_unique {A B : Type} (f : A -> list B) (l : list A) c : NoDup (flat_map f l) -> forall n m x y,
  nth_error l n = Some x -> nth_error l m = Some y -> In c (f x) -> In c (f y) -> n = m.
Proof.
  induction l as [| a l IH]; intros N n m x y X Y CX CY; [now destruct n |]. cbn in N.
  assert (forall k z, nth_error l k = Some z -> In c (f z) -> ~ In c (f a)) as Apart.
  { intros k z Z CZ CA. apply in_split in CA as (p & q & E). rewrite E in N.
    rewrite <- app_assoc in N. cbn in N. apply NoDup_remove_2 in N. apply N. rewrite app_assoc. apply in_or_app.
    right.
    apply in_flat_map. exists z. split; [now apply nth_error_In with k | easy]. }
  destruct n as [| n], m as [| m]; cbn in X, Y.
  - easy.
  - injection X as <-. destruct (Apart m y Y CY CX).
  - injection Y as <-. destruct (Apart n x X CX CY).
  - f_equal. apply NoDup_after in N. now apply (IH N n m x y).
Qed.

Section OneTree.
  Context (bs : list bv).
  Context (Hbv : forall i b, at_index bs i = Some b -> is_bv (count bs) i b = true).
  Context (Hnodup : NoDup (flat_map children bs)).
  Context (Hcount : count (flat_map children bs) = count bs - 1).
  Context (Hrange : forall c, In c (flat_map children bs) -> 1 <= c < count bs).

  Lemma child_later i a b : at_index bs i = Some (Inner a b) -> i < a /\ i < b /\ 0 <= i.
  Proof.
    intro E. pose proof (at_index_range _ _ _ E). apply Hbv in E. cbn in E.
    rewrite !andb_true_iff, !Z.ltb_lt in E. lia.
  Qed.

  Lemma same_parent c i j x y : at_index bs i = Some x -> at_index bs j = Some y -> In c (children x) ->
    In c (children y) -> i = j.
  Proof.
    intros I J X Y. pose proof (at_index_range _ _ _ I). pose proof (at_index_range _ _ _ J).
    unfold at_index in I, J. destruct (Z.ltb_spec i 0); [easy |]. destruct (Z.ltb_spec j 0); [easy |].
    assert (Z.to_nat i = Z.to_nat j) by now apply (owner_unique children bs c Hnodup _ _ x y). lia.
  Qed.

  Lemma children_differ i a b : at_index bs i = Some (Inner a b) -> a <> b.
  Proof.
    intros E ->. apply at_index_In in E. apply in_split in E as (p & q & ->). rewrite flat_map_app in Hnodup.
    cbn in Hnodup.
    apply NoDup_after in Hnodup. inversion Hnodup as [| h t N D]. apply N. now left.
  Qed.

  Lemma parent_exists c : 1 <= c < count bs -> exists i a b, at_index bs i = Some (Inner a b) /\ (c = a \/ c = b).
  Proof.
    intro C. assert (In c (flat_map children bs)) as I.
    { apply (NoDup_length_incl Hnodup (l' := map Z.of_nat (seq 1 (length bs - 1)))).
      - rewrite map_length, seq_length. unfold count in *. lia.
      - intros x X. apply Hrange in X. apply in_map_iff. exists (Z.to_nat x). split; [lia |]. apply in_seq.
        unfold count in X. lia.
      - apply in_map_iff. exists (Z.to_nat c). split; [lia |]. apply in_seq. unfold count in C. lia. }
    apply in_flat_map in I as (b & B & I). apply In_at_index in B as (i & E). destruct b as [l | x y]; [easy |].
    exists i, x, y. split; [easy |]. cbn in I. intuition congruence.
  Qed.

  Lemma some_path i : 0 <= i < count bs -> exists p, path bs p i.
  Proof.
    intros [L U]. assert (forall n k, 0 <= k < count bs -> k < Z.of_nat n -> exists p, path bs p k) as All.
    { induction n as [| n IH]; intros k K N; [lia |].
      destruct (Z.eq_dec k 0) as [-> | NZ]; [exists []; constructor |].
      destruct (parent_exists k) as (j & a & b & E & C); [lia |]. pose proof (child_later _ _ _ E).
      destruct (IH j) as (p & W); [lia | lia |].
      destruct C as [-> | ->]; [exists (p ++ [false]); now apply (path_left bs p j a b) |].
      exists (p ++ [true]). now apply (path_right bs p j a b). }
    apply (All (S (Z.to_nat i))); lia.
  Qed.

  Lemma one_path p i : path bs p i -> forall q, path bs q i -> p = q.
  Proof.
    induction 1 as [| p i a b W IH E | p i a b W IH E]; intros q Q.
    - inversion Q as [| r j a b V F X Y | r j a b V F X Y]; subst; [easy | |];
        apply child_later in F; lia.
    - inversion Q as [X Y | r j a' b' V F X Y | r j a' b' V F X Y]; subst.
      + apply child_later in E. lia.
      + assert (i = j) as -> by (apply (same_parent a i j _ _ E F); cbn; auto). now rewrite (IH r V).
      + assert (i = j) as -> by (apply (same_parent a i j _ _ E F); cbn; auto). rewrite E in F. injection F as <- ->.
        now apply children_differ in E.
    - inversion Q as [X Y | r j a' b' V F X Y | r j a' b' V F X Y]; subst.
      + apply child_later in E. lia.
      + assert (i = j) as -> by (apply (same_parent b i j _ _ E F); cbn; auto). rewrite E in F. injection F as -> <-.
        now apply children_differ in E.
      + assert (i = j) as -> by (apply (same_parent b i j _ _ E F); cbn; auto). now rewrite (IH r V).
  Qed.

  Theorem unique_path i : 0 <= i < count bs -> exists! p, path bs p i.
  Proof.
    intro L. destruct (some_path i L) as [p W]. exists p. split; [easy |]. now apply (one_path p i).
  Qed.
End OneTree.
