(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* Tables hold what their lists hold. *)
From Coq Require Import ZArith List Bool FMapPositive Permutation Lia.
From CinchChecker Require Import content statement table.
Import ListNotations.
Open Scope Z_scope.

Lemma get_empty {A : Type} i : get (@empty A) i = None.
Proof. unfold get, empty. rewrite PositiveMap.gempty. now destruct (i <? 0). Qed.

Lemma get_negative {A : Type} (t : table A) i : i < 0 -> get t i = None.
Proof. intro L. unfold get. apply Z.ltb_lt in L. now rewrite L. Qed.

Lemma get_put_same {A : Type} i (x : A) t : 0 <= i -> get (put i x t) i = Some x.
Proof.
  intro L. unfold get, put. apply Z.ltb_ge in L. rewrite L. apply PositiveMap.gss.
Qed.

Lemma get_put_other {A : Type} i j (x : A) t : 0 <= i -> i <> j -> get (put i x t) j = get t j.
Proof.
  intros L N. unfold get, put, key. destruct (Z.ltb_spec j 0); [easy |]. apply PositiveMap.gso. intro E. apply N.
  assert (Z.pos (Z.to_pos (j + 1)) = Z.pos (Z.to_pos (i + 1))) as F by now rewrite E.
  rewrite !Z2Pos.id in F by lia. lia.
Qed.

Lemma get_fill {A : Type} (l : list A) : forall i t j, 0 <= i ->
  get (fill i l t) j = if j <? i then get t j else
    match nth_error l (Z.to_nat (j - i)) with Some x => Some x | None => get t j end.
Proof.
  induction l as [| x l IH]; intros i t j I; cbn [fill].
  - destruct (j <? i); [easy |]. now destruct (Z.to_nat (j - i)).
  - rewrite IH by lia. destruct (Z.ltb_spec j i) as [L | L].
    + destruct (Z.ltb_spec j (i + 1)); [| lia]. apply get_put_other; lia.
    + destruct (Z.eq_dec i j) as [-> | N].
      * destruct (Z.ltb_spec j (j + 1)); [| lia]. rewrite get_put_same by easy. now rewrite Z.sub_diag.
      * destruct (Z.ltb_spec j (i + 1)); [lia |]. replace (Z.to_nat (j - i)) with (S (Z.to_nat (j - (i + 1)))) by lia.
        cbn [nth_error]. rewrite get_put_other by lia. reflexivity.
Qed.

Lemma get_table_of {A : Type} (l : list A) i : get (table_of l) i = at_index l i.
Proof.
  unfold table_of, at_index. rewrite get_fill by lia. destruct (Z.ltb_spec i 0) as [L | L].
  - now apply get_negative.
  - rewrite Z.sub_0_r, get_empty. now destruct (nth_error l (Z.to_nat i)).
Qed.

Lemma at_index_range {A : Type} (l : list A) i x : at_index l i = Some x -> 0 <= i < count l.
Proof.
  unfold at_index, count. destruct (Z.ltb_spec i 0) as [L | L]; [easy |]. intro E.
  assert (Z.to_nat i < length l)%nat by (apply nth_error_Some; congruence). lia.
Qed.

Lemma at_index_some {A : Type} (l : list A) i : 0 <= i < count l -> exists x, at_index l i = Some x.
Proof.
  unfold at_index, count. intros [L U]. destruct (Z.ltb_spec i 0); [lia |].
  destruct (nth_error l (Z.to_nat i)) as [x |] eqn:E; [now exists x |]. apply nth_error_None in E. lia.
Qed.

Lemma at_index_In {A : Type} (l : list A) i x : at_index l i = Some x -> In x l.
Proof. unfold at_index. destruct (i <? 0); [easy |]. apply nth_error_In. Qed.

Lemma In_at_index {A : Type} (l : list A) x : In x l -> exists i, at_index l i = Some x.
Proof.
  intro I. apply In_nth_error in I as [n E]. exists (Z.of_nat n). unfold at_index.
  destruct (Z.ltb_spec (Z.of_nat n) 0); [lia |]. now rewrite Nat2Z.id.
Qed.

Lemma at_index_map {A B : Type} (f : A -> B) l i : at_index (map f l) i = option_map f (at_index l i).
Proof. unfold at_index. destruct (i <? 0); [easy |]. apply nth_error_map. Qed.

Lemma reversed_map_acc {A B : Type} (f : A -> B) l : forall out,
  fold_left (fun out x => f x :: out) l out = rev (map f l) ++ out.
Proof. induction l as [| x l IH]; intro out; cbn; [easy |]. now rewrite IH, <- app_assoc. Qed.

Lemma reversed_map_map {A B : Type} (f : A -> B) l : reversed_map f l = rev (map f l).
Proof. unfold reversed_map. now rewrite reversed_map_acc, app_nil_r. Qed.

Lemma reversed_rev {A : Type} (l : list A) : reversed l = rev l.
Proof. unfold reversed. now rewrite rev_append_rev, app_nil_r. Qed.

Lemma gather_acc {A B : Type} (f : A -> list B) l : forall out,
  Permutation (fold_left (fun out x => rev_append (f x) out) l out) (flat_map f l ++ out).
Proof.
  induction l as [| x l IH]; intro out; cbn; [easy |]. rewrite IH, rev_append_rev, <- app_assoc.
  rewrite <- (Permutation_rev (f x)). rewrite !app_assoc. apply Permutation_app_tail. apply Permutation_app_comm.
Qed.

Lemma gather_flat_map {A B : Type} (f : A -> list B) l : Permutation (gather f l) (flat_map f l).
Proof. unfold gather. now rewrite gather_acc, app_nil_r. Qed.

Lemma size_acc {A : Type} (l : list A) : forall n, fold_left (fun n _ => n + 1) l n = n + count l.
Proof. unfold count. induction l as [| x l IH]; intro n; cbn [fold_left length]; [lia |]. rewrite IH. lia. Qed.

Lemma size_count {A : Type} (l : list A) : size l = count l.
Proof. unfold size. now rewrite size_acc. Qed.

Lemma distinct_NoDup l : forall seen, (forall x, In x l -> 0 <= x) -> distinct_beside seen l = true ->
  NoDup l /\ forall x, In x l -> get seen x = None.
Proof.
  induction l as [| x l IH]; intros seen P D; [split; [constructor | easy] |]. cbn in D.
  destruct (get seen x) eqn:G; [easy |].
  destruct (IH (put x tt seen)) as [N S]; [intros y I; apply P; now right | easy |].
  assert (0 <= x) by (apply P; now left).
  split.
  - constructor; [| easy]. intro I. specialize (S x I). rewrite get_put_same in S by easy. easy.
  - intros y [<- | I]; [easy |]. destruct (Z.eq_dec x y) as [<- | E]; [easy |].
    rewrite <- (S y I). symmetry. now apply get_put_other.
Qed.

Lemma each_once_sound first n l : 0 <= first -> each_once first n l = true ->
  NoDup l /\ count l = n /\ forall x, In x l -> first <= x < first + n.
Proof.
  unfold each_once. rewrite !andb_true_iff, forallb_forall, size_count, Z.eqb_eq. intros F [[R C] D].
  assert (forall x, In x l -> first <= x < first + n) as Range.
  { intros x I. apply R in I. rewrite andb_true_iff, Z.leb_le, Z.ltb_lt in I. easy. }
  apply distinct_NoDup in D as [N _]; [easy |]. intros x I. apply Range in I. lia.
Qed.

Lemma indices_In n x : In x (indices n) <-> 0 <= x < n.
Proof.
  unfold indices. rewrite in_map_iff. split.
  - intros (k & <- & I). apply in_seq in I. lia.
  - intro L. exists (Z.to_nat x). split; [lia |]. apply in_seq. lia.
Qed.

Lemma each_once_indices n l : 0 <= n -> each_once 0 n l = true -> Permutation l (indices n).
Proof.
  intros P E. apply each_once_sound in E as (N & C & R); [| lia].
  apply NoDup_Permutation_bis; [easy | |].
  - unfold indices, count in *. rewrite map_length, seq_length. lia.
  - intros x I. apply indices_In. apply R in I. lia.
Qed.
