(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* A run that ends in Done has read the lines of a content, and has checked all of it. *)
From Coq Require Import ZArith List Bool Lia.
From CinchChecker Require Import content statement table numbers evaluation tree duality checker table_proof.
Import ListNotations.
Open Scope Z_scope.

Fixpoint after_claims (n : nat) (a : aims) : aims :=
  match n with O => a | S m => without_first (after_claims m a) end.

Record checked_surface (h : header) (vs : list vertex) (ts : list triangle) (bs : list bv) : Prop := {
  header_checked : is_header h = true;
  vertices_counted : count vs = vertex_count h;
  triangles_counted : count ts = triangle_count h;
  bvs_counted : count bs = bv_count h;
  vertices_checked : forall v, In v vs -> is_vertex h v = true;
  triangles_checked : forall t, In t ts -> is_triangle h t = true;
  bvs_checked : forall i b, at_index bs i = Some b -> is_bv (bv_count h) i b = true;
  tree_checked : is_tree (bv_count h) (triangle_count h) (rev bs) = true
}.

Record checked_frame (s : surface) (f : frame) : Prop := {
  frame_checked : is_frame (about s) (time f) (maps f) = true;
  claims_checked : forall n c, nth_error (claims f) n = Some c ->
    is_claim s c = true /\ holds_vertices (after_claims n (aims_of s (maps f))) c = true /\
    holds_space (after_claims n (aims_of s (maps f))) c = true
}.

Definition shared (h : header) (vs : list vertex) (ts : list triangle) (bs : list bv) : surface :=
  surface_of h (rev vs) (rev ts) (rev bs).

Definition bounds_of (fs : list frame) : list (option dyadic) := flat_map (fun f => flat_map bounds (claims f)) fs.
Definition proven_in (fs : list frame) : Z := count (filter finite_bound (bounds_of fs)).
Definition infinite_in (fs : list frame) : Z := count (filter (fun b => negb (finite_bound b)) (bounds_of fs)).

Definition surface_lines (h : header) (vs : list vertex) (ts : list triangle) (bs : list bv) : list line :=
  LHeader h :: numbered LVertex 0 vs ++ numbered LTriangle 0 ts ++ numbered LBv 0 bs.

Record checked (c : content) : Prop := {
  surface_checked : checked_surface (head c) (vertices c) (triangles_of c) (bvs c);
  frames_checked : forall f, In f (frames c) ->
    checked_frame (shared (head c) (vertices c) (triangles_of c) (bvs c)) f /\ count (claims f) = bv_count (head c);
  frames_counted : count (frames c) = frame_count (head c);
  end_frames : frames_said (last_line c) = count (frames c);
  end_proven : proven_said (last_line c) = proven_in (frames c);
  end_infinite : infinite_said (last_line c) = infinite_in (frames c);
  end_violated : violated_said (last_line c) = 0
}.

(* What has been read when a state is reached *)
Inductive read : list line -> state -> Prop :=
| read_start : read [] Start
| read_surface h vs ts bs :
    is_header h = true -> (forall v, In v vs -> is_vertex h v = true) ->
    (forall t, In t ts -> is_triangle h t = true) ->
    (forall i b, at_index (rev bs) i = Some b -> is_bv (bv_count h) i b = true) ->
    read (surface_lines h (rev vs) (rev ts) (rev bs)) (Reading h (count vs) (count ts) (count bs) vs ts bs)
| read_frames h vs ts bs fs f :
    checked_surface h vs ts bs ->
    (forall g, In g fs -> checked_frame (shared h vs ts bs) g /\ count (claims g) = bv_count h) ->
    checked_frame (shared h vs ts bs) f ->
    read (surface_lines h vs ts bs ++ lines_of_frames 0 (fs ++ [f]))
      (Framing (shared h vs ts bs) (count fs + 1) (count (claims f))
        (after_claims (length (claims f)) (aims_of (shared h vs ts bs) (maps f)))
        (proven_in (fs ++ [f])) (infinite_in (fs ++ [f])))
| read_all c : checked c -> read (lines c) Done.

Lemma numbered_snoc {A : Type} (f : Z -> A -> line) (l : list A) x : forall i,
  numbered f i (l ++ [x]) = numbered f i l ++ [f (i + count l) x].
Proof.
  unfold count. induction l as [| y l IH]; intro i; cbn [app numbered length].
  - now rewrite Z.add_0_r.
  - rewrite IH. replace (i + 1 + Z.of_nat (length l)) with (i + Z.of_nat (S (length l))) by lia. reflexivity.
Qed.

Lemma lines_of_frames_snoc fs f : forall i,
  lines_of_frames i (fs ++ [f]) = lines_of_frames i fs ++ lines_of_frame (i + count fs) f.
Proof.
  unfold count. induction fs as [| g fs IH]; intro i; cbn [app lines_of_frames length].
  - now rewrite Z.add_0_r, app_nil_r.
  - rewrite IH, app_assoc. replace (i + 1 + Z.of_nat (length fs)) with (i + Z.of_nat (S (length fs))) by lia.
    reflexivity.
Qed.

Lemma count_snoc {A : Type} (l : list A) x : count (l ++ [x]) = count l + 1.
Proof. unfold count. rewrite app_length. cbn. lia. Qed.

Lemma count_rev {A : Type} (l : list A) : count (rev l) = count l.
Proof. unfold count. now rewrite rev_length. Qed.

Lemma count_app {A : Type} (l m : list A) : count (l ++ m) = count l + count m.
Proof. unfold count. rewrite app_length. lia. Qed.

Lemma count_0 {A : Type} (l : list A) : count l = 0 -> l = [].
Proof. destruct l; [easy |]. unfold count. cbn. lia. Qed.

Lemma count_filter {A : Type} (f : A -> bool) l : count (filter f l) + count (filter (fun x => negb (f x)) l) = count
  l.
Proof.
  unfold count. induction l as [| x l IH]; [reflexivity |]. cbn. destruct (f x); cbn [negb length]; lia.
Qed.

Lemma bounds_of_claim fs t m cs c :
  bounds_of (fs ++ [Frame t m (cs ++ [c])]) = bounds_of (fs ++ [Frame t m cs]) ++ bounds c.
Proof.
  unfold bounds_of. rewrite !flat_map_app. cbn [flat_map claims]. rewrite flat_map_app. cbn [flat_map].
  now rewrite !app_nil_r, app_assoc.
Qed.

Lemma bounds_of_new fs t m : bounds_of (fs ++ [Frame t m []]) = bounds_of fs.
Proof. unfold bounds_of. rewrite flat_map_app. cbn. now rewrite !app_nil_r. Qed.

Lemma about_shared h vs ts bs : about (shared h vs ts bs) = h.
Proof. reflexivity. Qed.

Lemma new_frame_checked s t m : is_frame (about s) t m = true -> checked_frame s (Frame t m []).
Proof. intro F. split; [easy |]. intros [| n] c N; easy. Qed.

Ltac split_checks E :=
  repeat match type of E with (if ?b then _ else _) = _ =>
    let B := fresh "B" in destruct b eqn:B; [| discriminate E] end;
  injection E as <-;
  repeat match goal with H : (_ && _)%bool = true |- _ => apply andb_true_iff in H as [? ?] end;
  repeat match goal with H : (_ =? _) = true |- _ => apply Z.eqb_eq in H end.

Lemma step_read pre now l next : read pre now -> step now l = Next next -> read (pre ++ [l]) next.
Proof.
  intros R E. destruct R as [| h vs ts bs H V T B | h vs ts bs fs f S F C | c _].
  - destruct l as [h | | | | | |]; try discriminate E. cbn [step] in E. split_checks E.
    exact (read_surface h [] [] [] B (fun v I => match I with end) (fun t I => match I with end)
      ltac:(intros [| p | p] b; cbn; try easy; unfold at_index; cbn; now destruct (Pos.to_nat p))).
  - destruct l as [| i v | i t | i b | i t m | |]; try discriminate E; cbn [step] in E.
    + split_checks E. subst i. assert (ts = []) as -> by now apply count_0.
      assert (bs = []) as -> by now apply count_0.
      replace (surface_lines h (rev vs) (rev []) (rev []) ++ [LVertex (count vs) v])
        with (surface_lines h (rev (v :: vs)) (rev []) (rev [])).
      2: { unfold surface_lines. cbn [rev numbered app]. rewrite !app_nil_r, numbered_snoc, count_rev. reflexivity. }
      replace (count vs + 1) with (count (v :: vs)) by (unfold count; cbn [length]; lia).
      apply (read_surface h (v :: vs) [] []); try easy. intros w [<- | I]; auto.
    + split_checks E. subst i. assert (bs = []) as -> by now apply count_0.
      replace (surface_lines h (rev vs) (rev ts) (rev []) ++ [LTriangle (count ts) t])
        with (surface_lines h (rev vs) (rev (t :: ts)) (rev [])).
      2: { unfold surface_lines. cbn [rev numbered app]. rewrite !app_nil_r, numbered_snoc, count_rev.
           cbn [app]. now rewrite !app_assoc. }
      replace (count ts + 1) with (count (t :: ts)) by (unfold count; cbn [length]; lia).
      apply (read_surface h vs (t :: ts) []); try easy. intros w [<- | I]; auto.
    + split_checks E. subst i.
      replace (surface_lines h (rev vs) (rev ts) (rev bs) ++ [LBv (count bs) b])
        with (surface_lines h (rev vs) (rev ts) (rev (b :: bs))).
      2: { unfold surface_lines. cbn [rev numbered app]. rewrite numbered_snoc, count_rev.
           cbn [app]. now rewrite !app_assoc. }
      replace (count bs + 1) with (count (b :: bs)) by (unfold count; cbn [length]; lia).
      apply (read_surface h vs ts (b :: bs)); try easy. intros j d J. cbn [rev] in J.
      destruct (Z.eq_dec j (count bs)) as [-> | N].
      * unfold at_index in J. destruct (Z.ltb_spec (count bs) 0); [easy |].
        rewrite nth_error_app2 in J by (rewrite rev_length; unfold count; lia).
        replace (Z.to_nat (count bs) - length (rev bs))%nat with O in J by (rewrite rev_length; unfold count; lia).
        cbn in J. now injection J as <-.
      * apply B. pose proof (at_index_range _ _ _ J) as L. rewrite count_snoc, count_rev in L.
        unfold at_index in J |- *. destruct (Z.ltb_spec j 0); [easy |].
        rewrite nth_error_app1 in J; [easy |]. rewrite rev_length. unfold count in *. lia.
    + split_checks E. subst i.
      pose (s := shared h (rev vs) (rev ts) (rev bs)).
      assert (surface_of h vs ts bs = s) as -> by (unfold s, shared; now rewrite !rev_involutive).
      replace (surface_lines h (rev vs) (rev ts) (rev bs) ++ [LFrame 0 t m])
        with (surface_lines h (rev vs) (rev ts) (rev bs) ++ lines_of_frames 0 ([] ++ [Frame t m []])) by reflexivity.
      apply (read_frames h (rev vs) (rev ts) (rev bs) [] (Frame t m [])).
      * split; rewrite ?count_rev, ?rev_involutive; auto; intros x I; apply in_rev in I; auto.
      * intros g [].
      * now apply new_frame_checked.
  - destruct l as [| | | | i t m | i j c | e]; try discriminate E; cbn [step] in E.
    + split_checks E. subst i. change (about (shared h vs ts bs)) with h in *.
      replace ((surface_lines h vs ts bs ++ lines_of_frames 0 (fs ++ [f])) ++ [LFrame (count fs + 1) t m])
        with (surface_lines h vs ts bs ++ lines_of_frames 0 ((fs ++ [f]) ++ [Frame t m []])).
      2: { rewrite (lines_of_frames_snoc (fs ++ [f])), count_snoc, app_assoc. reflexivity. }
      replace (proven_in (fs ++ [f])) with (proven_in ((fs ++ [f]) ++ [Frame t m []]))
        by (unfold proven_in; now rewrite bounds_of_new).
      replace (infinite_in (fs ++ [f])) with (infinite_in ((fs ++ [f]) ++ [Frame t m []]))
        by (unfold infinite_in; now rewrite bounds_of_new).
      replace (count fs + 1 + 1) with (count (fs ++ [f]) + 1) by (rewrite count_snoc; ring).
      apply (read_frames h vs ts bs (fs ++ [f]) (Frame t m [])); [easy | | now apply new_frame_checked].
      intros g I. apply in_app_or in I as [I | [<- | []]]; [now apply F | now split].
    + split_checks E. change (about (shared h vs ts bs)) with h in *.
      destruct f as [t m cs]. cbn [claims maps] in *. subst i j.
      replace ((surface_lines h vs ts bs ++ lines_of_frames 0 (fs ++ [Frame t m cs])) ++
          [LClaim (count fs + 1 - 1) (count cs) c])
        with (surface_lines h vs ts bs ++ lines_of_frames 0 (fs ++ [Frame t m (cs ++ [c])])).
      2: { rewrite !lines_of_frames_snoc, <- !app_assoc. do 2 f_equal. unfold lines_of_frame. cbn [time maps claims].
           rewrite numbered_snoc. cbn [app]. do 3 f_equal. replace (count fs + 1 - 1) with (0 + count fs) by ring.
           reflexivity. }
      assert (finite_count (bounds c) = count (filter finite_bound (bounds c))) as N
        by (unfold finite_count; apply size_count).
      assert (count (bounds c) = kdop h) as K.
      { match goal with H : is_claim _ _ = true |- _ => unfold is_claim in H; apply andb_true_iff in H as [H _];
          apply andb_true_iff in H as [H _]; apply Z.eqb_eq in H; now rewrite size_count in H end. }
      replace (proven_in (fs ++ [Frame t m cs]) + finite_count (bounds c))
        with (proven_in (fs ++ [Frame t m (cs ++ [c])])).
      2: { unfold proven_in. rewrite bounds_of_claim, filter_app, count_app, N. reflexivity. }
      replace (infinite_in (fs ++ [Frame t m cs]) + (kdop h - finite_count (bounds c)))
        with (infinite_in (fs ++ [Frame t m (cs ++ [c])])).
      2: { unfold infinite_in. rewrite bounds_of_claim, filter_app, count_app. f_equal.
           pose proof (count_filter finite_bound (bounds c)). lia. }
      replace (count cs + 1) with (count (claims (Frame t m (cs ++ [c])))) by (cbn [claims]; apply count_snoc).
      replace (without_first (after_claims (length cs) (aims_of (shared h vs ts bs) m)))
        with (after_claims (length (claims (Frame t m (cs ++ [c])))) (aims_of (shared h vs ts bs) m))
        by (cbn [claims]; rewrite app_length, Nat.add_comm; reflexivity).
      apply (read_frames h vs ts bs fs (Frame t m (cs ++ [c]))); [easy | easy |].
      destruct C as [C D]. cbn [claims maps time] in C, D. split; [easy |]. cbn [claims maps time]. intros n d J.
      destruct (Nat.lt_ge_cases n (length cs)) as [L | L].
      * rewrite nth_error_app1 in J by easy. now apply D.
      * assert (n = length cs) as ->.
        { assert (n < length (cs ++ [c]))%nat as L' by (apply nth_error_Some; congruence).
          rewrite app_length in L'. cbn in L'. lia. }
        rewrite nth_error_app2, Nat.sub_diag in J by easy. cbn in J. injection J as <-. easy.
    + split_checks E. change (about (shared h vs ts bs)) with h in *.
      replace ((surface_lines h vs ts bs ++ lines_of_frames 0 (fs ++ [f])) ++ [LEnd e])
        with (lines (Content h vs ts bs (fs ++ [f]) e)).
      2: { unfold lines, surface_lines. cbn [head vertices triangles_of bvs frames last_line app].
           now rewrite <- !app_assoc. }
      apply read_all. split; cbn [head vertices triangles_of bvs frames last_line]; rewrite ?count_snoc; try easy.
      intros g I. apply in_app_or in I as [I | [<- | []]]; [now apply F | now split].
  - destruct l; discriminate E.
Qed.

Lemma run_read ls : forall pre now next, read pre now -> run now ls = Next next -> read (pre ++ ls) next.
Proof.
  induction ls as [| l ls IH]; intros pre now next R E; cbn [run] in E.
  - injection E as <-. now rewrite app_nil_r.
  - destruct (step now l) as [middle |] eqn:S; [| discriminate E].
    replace (pre ++ l :: ls) with ((pre ++ [l]) ++ ls) by now rewrite <- app_assoc.
    apply (IH _ middle); [| easy]. now apply step_read with now.
Qed.

Theorem accepted_is_checked ls : accepts ls = true -> exists c, ls = lines c /\ checked c.
Proof.
  unfold accepts. destruct (run Start ls) as [[| | |] |] eqn:E; try easy. intros _.
  apply run_read with (pre := []) in E; [| constructor]. cbn [app] in E. inversion E as [| | | c C L]. now exists c.
Qed.
