(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* Checked frames: what their bounds enclose. *)
From Coq Require Import ZArith List Bool Reals Lia Lra.
From Flocq Require Import Core.
From CinchChecker Require Import content statement table numbers evaluation tree duality checker numbers_proof
  table_proof
  evaluation_proof tree_proof duality_proof run_proof surface_proof.
Import ListNotations.
Open Scope Z_scope.

Lemma encloses_more g ms v a b : encloses g ms v a -> (a <= b)%R -> encloses g ms v b.
Proof. intros [E (s & S & L)] B. split; [lra |]. exists s. split; [easy | lra]. Qed.

Lemma greater_supports_nth a : forall b d n, nth_error (greater_supports a b) d = Some (Some n) ->
  exists p q, nth_error a d = Some (Some p) /\ nth_error b d = Some (Some q) /\ n = Z.max p q.
Proof.
  induction a as [| x a IH]; intros [| y b] d n E; try now destruct d. destruct d as [| d]; cbn in E |- *.
  - destruct x as [p |], y as [q |]; try easy. injection E as <-. now exists p, q.
  - now apply IH.
Qed.

Lemma above_supports_nth k bs : forall ss d b, above_supports k bs ss = true -> nth_error bs d = Some (Some b) ->
  exists s, nth_error ss d = Some (Some s) /\ at_least b k s = true.
Proof.
  induction bs as [| [c |] bs IH]; intros [| [s |] ss] [| d] b E N; cbn in E, N |- *; try easy;
    try (apply andb_true_iff in E as [A E]); try now apply IH.
  injection N as <-. now exists s.
Qed.

Lemma after_claims_parts n a : bits (after_claims n a) = bits a /\ columns (after_claims n a) = columns a /\
  (forall m, nth_error (supports_left (after_claims n a)) m = nth_error (supports_left a) (n + m)) /\
  (forall m, nth_error (spaces_left (after_claims n a)) m = nth_error (spaces_left a) (n + m)).
Proof.
  assert (forall {A : Type} (l : list A) m, nth_error (tl l) m = nth_error l (S m)) as Tail
    by (intros A [| x l] m; cbn; [now destruct m | easy]).
  induction n as [| n (B & C & S & P)]; cbn [after_claims without_first bits columns supports_left spaces_left];
    repeat split; try easy; intro m; rewrite Tail; [rewrite S | rewrite P]; f_equal; lia.
Qed.

Lemma fine_more j k l : fine j l -> j <= k -> fine k l.
Proof. intros F L d I. apply F in I. lia. Qed.

Section Finest.
  Context {A : Type} (numbers : A -> list dyadic) (f : Z -> A -> Z).
  Context (Hf : forall k x, f k x = finest k (numbers x)).

  Lemma folded_start l : forall k, k <= fold_left f l k.
  Proof.
    induction l as [| x l IH]; intro k; cbn [fold_left]; [apply Z.le_refl |].
    apply Z.le_trans with (f k x); [| apply IH]. rewrite Hf. apply finest_start.
  Qed.

  Lemma folded_fine l : forall k x, In x l -> fine (fold_left f l k) (numbers x).
  Proof.
    induction l as [| y l IH]; intros k x I; [easy |]. destruct I as [<- | I]; cbn [fold_left]; [| now apply IH].
    apply fine_more with (f k y); [| apply folded_start]. rewrite Hf. intro d. apply finest_enough.
  Qed.
End Finest.

Section Frames.
  Context (h : header) (vs : list vertex) (ts : list triangle) (bs : list bv) (C : checked_surface h vs ts bs).

  Let s := shared h vs ts bs.
  Let gs := directions (kdop h).
  Let k0 := finest_rest (rev vs).
  Let hs := map (held_by (table_of ts)) bs.

  Lemma k0_nonnegative : 0 <= k0.
  Proof. now apply (folded_start (fun v => coordinates (rest v))). Qed.

  Lemma rest_fine v : In v vs -> fine k0 (coordinates (rest v)).
  Proof. intro I. apply (folded_fine (fun v => coordinates (rest v))); [easy |]. now apply in_rev in I. Qed.

  Lemma weights_fine v : In v vs -> forall j w, In (j, w) (influences v) -> is_weight w = true.
  Proof. intro I. apply C in I. now apply is_vertex_weights with h. Qed.

  Lemma unit_vertices_shared : unit_vertices s = rev (map (vertex_in_units k0) vs).
  Proof.
    unfold s, shared, surface_of. cbn [unit_vertices]. fold k0.
    now rewrite reversed_rev, rev_involutive, reversed_map_map.
  Qed.

  Lemma tree_shared : tree s = rev hs.
  Proof.
    unfold s, shared, surface_of. cbn [tree]. now rewrite !reversed_rev, !rev_involutive, reversed_map_map.
  Qed.

  Lemma spaces_shared : by_duality h = true -> spaces s =
    map (option_map listed)
      (climb join_space (fun v => option_map space_of (at_index (map (vertex_in_units k0) vs) v)) (bv_count h - 1)
      (rev hs) empty []).
  Proof.
    intro D. unfold s, shared, surface_of. cbn [spaces]. rewrite D. unfold spaces_of. fold k0.
    rewrite !reversed_rev, !rev_involutive, !reversed_map_map, !rev_involutive. f_equal.
    assert (forall own own', (forall v, own v = own' v) -> forall l i done out,
      climb join_space own i l done out = climb join_space own' i l done out) as Same;
      [| apply Same; intro v; now rewrite get_table_of].
    intros own own' E. assert (forall vs', joined join_space own vs' = joined join_space own' vs') as J.
    { intros [| v vs']; [easy |]. cbn. rewrite E. generalize (own' v). induction vs' as [| w vs' IH]; intro o;
        [easy |].
      cbn. now rewrite E, IH. }
    induction l as [| e l IH]; intros i done out; [easy |]. cbn.
    assert (collected join_space own done e = collected join_space own' done e) as -> by (destruct e; cbn; auto).
    now destruct (collected join_space own' done e).
  Qed.

  (* Boxes and weight intervals *)
  Lemma spaces_hold i sp : by_duality h = true -> nth_error (spaces s) (Z.to_nat i) = Some (Some sp) -> 0 <= i ->
    exists s0, sp = listed s0 /\
      forall k v, below bs ts i k -> at_index vs k = Some v -> holds s0 (vertex_in_units k0 v).
  Proof.
    intros D N L. rewrite spaces_shared in N by easy. rewrite nth_error_map in N.
    set (out := climb _ _ _ _ _ _) in N.
    destruct (nth_error out (Z.to_nat i)) as [[s0 |] |] eqn:E; try easy. cbn in N. injection N as <-. exists s0.
    split; [easy |].
    destruct (climb_sound join_space (fun v => option_map space_of (at_index (map (vertex_in_units k0) vs) v))
      (fun a w => forall v, at_index vs w = Some v -> holds a (vertex_in_units k0 v))) with
      (bs := bs) (ts := ts) (left := rev hs) (after := @nil held) (i := bv_count h - 1) (done := @empty space)
      (out := @nil (option space)) as [_ S].
    - intros w a O v V. rewrite at_index_map, V in O. cbn in O. injection O as <-. apply space_of_holds.
      intros j u I. cbn in I. apply in_map_iff in I as ([j' w'] & J & I). injection J as <- <-.
      assert (In v vs) as Iv by now apply at_index_In in V. apply C in Iv.
      pose proof (is_vertex_nodes h v Iv j' w' I). cbn. lia.
    - intros a b v A w W. exact (join_holds_left a b _ (A w W)).
    - intros a b v B w W. exact (join_holds_right a b _ (B w W)).
    - now rewrite rev_involutive, app_nil_r.
    - rewrite count_rev. unfold hs, count. rewrite map_length. pose proof (bvs_counted _ _ _ _ C) as B.
      unfold count in B. lia.
    - easy.
    - intros j c. now rewrite get_empty.
    - intros [| n] a; easy.
    - intros w v W V. refine (S i s0 _ w W v V). unfold at_index. destruct (Z.ltb_spec i 0); [lia | easy].
  Qed.

  Section Frame.
    Context (f : frame) (F : checked_frame s f) (Hclaims : count (claims f) = bv_count h).

    Let ms := maps f.
    Let mb := finest_map ms.
    Let a := aims_of s ms.
    Let us := map (map_in_units mb k0) ms.

    Lemma mb_nonnegative : 0 <= mb.
    Proof. now apply (folded_start entries). Qed.

    Lemma maps_fine m : In m ms -> fine mb (entries m).
    Proof. now apply (folded_fine entries). Qed.

    Lemma bits_of_aims : bits a = mb + k0.
    Proof. reflexivity. Qed.

    Lemma maps_table j : get (table_of us) j = option_map (map_in_units mb k0) (at_index ms j).
    Proof. rewrite get_table_of. apply at_index_map. Qed.

    Lemma supports_of_aims : supports_left a =
      climb greater_supports (get (table_of (map (supports_of_vertex gs (mb + k0) (table_of us))
        (map (vertex_in_units k0) vs)))) (bv_count h - 1) (rev hs) empty [].
    Proof.
      unfold a, aims_of. cbv zeta. cbn [supports_left]. rewrite tree_shared, unit_vertices_shared.
      rewrite !reversed_map_map, reversed_rev, rev_involutive, <- map_rev, rev_involutive. reflexivity.
    Qed.

    Lemma columns_of_aims : by_duality h = true ->
      columns a = map (fun g => table_of (map (column_of g) us)) (axes (kdop h)).
    Proof.
      intro D. unfold a, aims_of. cbv zeta. cbn [columns]. change (about s) with h. rewrite D. apply map_ext.
      intro g. now rewrite !reversed_map_map, !reversed_rev, !rev_involutive.
    Qed.

    Lemma claim_at i cl : at_index (claims f) i = Some cl ->
      0 <= i /\ is_claim s cl = true /\ holds_vertices (after_claims (Z.to_nat i) a) cl = true /\
      holds_space (after_claims (Z.to_nat i) a) cl = true.
    Proof.
      intro E. pose proof (at_index_range _ _ _ E). split; [lia |]. unfold at_index in E.
      destruct (Z.ltb_spec i 0); [lia |]. now apply F.
    Qed.

    Theorem frame_encloses i d g bound w v : states f i d bound -> nth_error gs d = Some g -> below bs ts i w ->
      at_index vs w = Some v -> encloses g ms v (value bound).
    Proof.
      intros (cl & L & N) G W V. apply claim_at in L as (I & _ & H & _).
      destruct (after_claims_parts (Z.to_nat i) a) as (B & _ & S & _).
      unfold holds_vertices in H. specialize (S O). rewrite Nat.add_0_r in S.
      destruct (supports_left (after_claims (Z.to_nat i) a)) as [| [l |] others]; try easy.
      change (Some (Some l) = nth_error (supports_left a) (Z.to_nat i)) in S. symmetry in S.
      rewrite B, bits_of_aims in H.
      destruct (above_supports_nth _ _ _ _ _ H N) as (n & Nn & A). apply at_least_sound in A.
      apply encloses_more with (2 := A).
      rewrite supports_of_aims in S.
      destruct (climb_sound greater_supports (get (table_of (map (supports_of_vertex gs (mb + k0) (table_of us))
          (map (vertex_in_units k0) vs))))
        (fun a w => forall v d g n, at_index vs w = Some v -> nth_error gs d = Some g ->
          nth_error a d = Some (Some n) -> encloses g ms v (in_units (mb + k0 + weight_bits) n))) with
        (bs := bs) (ts := ts) (left := rev hs) (after := @nil held) (i := bv_count h - 1)
        (done := @empty (list (option Z))) (out := @nil (option (list (option Z)))) as [_ Sound].
      - intros j b O x e y m X Y M. rewrite get_table_of, !at_index_map, X in O. cbn [option_map] in O.
        injection O as <-. assert (In x vs) as Ix by now apply at_index_In in X.
        apply (supports_enclose ms mb k0 (table_of us) mb_nonnegative k0_nonnegative maps_fine maps_table x
          (rest_fine x Ix) (weights_fine x Ix) gs e y m Y M).
      - intros b c j K x e y m X Y M. apply greater_supports_nth in M as (p & q & P & Q & ->).
        apply encloses_more with (in_units (mb + k0 + weight_bits) p); [now apply (K x e y p) |
          apply in_units_le; lia].
      - intros b c j K x e y m X Y M. apply greater_supports_nth in M as (p & q & P & Q & ->).
        apply encloses_more with (in_units (mb + k0 + weight_bits) q); [now apply (K x e y q) |
          apply in_units_le; lia].
      - now rewrite rev_involutive, app_nil_r.
      - rewrite count_rev. unfold hs, count. rewrite map_length. pose proof (bvs_counted _ _ _ _ C) as Bc.
        unfold count in Bc. lia.
      - easy.
      - intros j c. now rewrite get_empty.
      - intros [| m] c; easy.
      - refine (Sound i l _ w W v d g n V G Nn). unfold at_index. destruct (Z.ltb_spec i 0); [lia | easy].
    Qed.

    (* Of BV i, the space that its bounds hold for *)
    Lemma claimed_space i : by_duality h = true -> 0 <= i < bv_count h ->
      exists sp, nth_error (spaces s) (Z.to_nat i) = Some (Some sp).
    Proof.
      intros D I. rewrite <- Hclaims in I. apply at_index_some in I as (cl & L).
      apply claim_at in L as (_ & K & _ & H). unfold holds_space in H. unfold is_claim in K.
      apply andb_true_iff in K as [_ K].
      change (about s) with h in K. rewrite D in K. destruct (lambdas cl) as [ls |]; [| easy].
      destruct (after_claims_parts (Z.to_nat i) a) as (_ & _ & _ & S). specialize (S O). rewrite Nat.add_0_r in S.
      destruct (spaces_left (after_claims (Z.to_nat i) a)) as [| [sp |] others]; try easy. cbn in S.
      exists sp. symmetry. exact S.
    Qed.

    Theorem frame_blends i d g bound s0 : by_duality h = true -> states f i d bound -> nth_error gs d = Some g ->
      nth_error (spaces s) (Z.to_nat i) = Some (Some (listed s0)) ->
      blends_enclosed g ms (box_of k0 s0) (intervals_of s0) (value bound).
    Proof.
      intros D (cl & L & N) G S0. apply claim_at in L as (_ & K & _ & H). unfold is_claim in K.
      apply andb_true_iff in K as [_ K]. change (about s) with h in K. rewrite D in K.
      unfold holds_space in H. destruct (lambdas cl) as [ls |]; [| easy].
      destruct (after_claims_parts (Z.to_nat i) a) as (B & Co & _ & S). specialize (S O). rewrite Nat.add_0_r in S.
      change (spaces_left a) with (spaces s) in S. rewrite S0 in S.
      destruct (spaces_left (after_claims (Z.to_nat i) a)) as [| [sp |] others]; try easy. cbn in S.
      injection S as ->.
      rewrite B, bits_of_aims, Co, columns_of_aims in H by easy.
      apply (above_duals_sound ms mb k0 mb_nonnegative k0_nonnegative maps_fine s0
        (fun g => table_of (map (column_of g) us))) with (2 := H) (d := d); [| exact G | exact N].
      intros e j. rewrite get_table_of. unfold us. rewrite map_map. apply at_index_map.
    Qed.

    Lemma length_directions : Z.of_nat (length gs) = kdop h.
    Proof.
      destruct (header_parts _ _ _ _ C) as (K & _). unfold gs. cbn in K.
      destruct K as [<- | [<- | [<- | [<- | []]]]]; reflexivity.
    Qed.

    Lemma is_map_doubles m : is_map m = true -> binary64_map m.
    Proof.
      unfold is_map. rewrite forallb_forall. intro D.
      assert (forall d, In d (entries m) -> binary64 d) as E by (intros d I; now apply is_double_sound, D).
      split; [| split]; (split; [| split; [| split]]); apply E; cbn; auto 13.
    Qed.
  End Frame.
End Frames.

Theorem checked_proves c : checked c -> proves c.
Proof.
  intro H. pose proof H as [C F N Ef Ep Ei Ev]. split.
  - now apply checked_surface_whole.
  - intros f I. apply F in I as [[K Cl] L]. unfold is_frame in K. rewrite !andb_true_iff in K.
    destruct K as [[_ M] D].
    apply Z.eqb_eq in M. rewrite size_count in M. split; try easy.
    + intros cl J. apply In_nth_error in J as [n J]. apply Cl in J as [J _]. unfold is_claim in J.
      rewrite !andb_true_iff in J. destruct J as [[J _] _]. apply Z.eqb_eq in J. rewrite size_count in J.
      pose proof (length_directions _ _ _ _ C) as G. unfold count in J. cbn [about shared surface_of] in J. lia.
    + intros m J. rewrite forallb_forall in D. apply is_map_doubles. now apply D.
    + intros cl b J B. apply In_nth_error in J as [n J]. apply Cl in J as [J _]. unfold is_claim in J.
      rewrite !andb_true_iff in J. destruct J as [[_ J] _]. rewrite forallb_forall in J. apply J in B.
      now apply is_double_sound.
  - intros f i d g bound k v I S G W V. apply F in I as [K _].
    apply (frame_encloses _ _ _ _ C f K i d g bound k v S G W V).
  - intros D i R.
    assert (exists f0, In f0 (frames c)) as [f0 I0].
    { destruct (header_parts _ _ _ _ C) as (_ & _ & _ & P). rewrite <- N in P. unfold count in P.
      destruct (frames c) as [| f0 fs]; [cbn in P; lia |]. exists f0. now left. }
    pose proof (F f0 I0) as [K0 L0].
    destruct (claimed_space _ _ _ _ f0 K0 L0 i D R) as [sp Sp].
    destruct (spaces_hold _ _ _ _ C i sp D Sp) as (s0 & -> & Holds); [lia |].
    exists (box_of (finest_rest (rev (vertices c))) s0), (intervals_of s0). split; [apply intervals_NoDup |]. split.
    + intros k v W V. specialize (Holds k v W V). assert (In v (vertices c)) as Iv by now apply at_index_In in V.
      split.
      * apply holds_box; [| easy]. now apply (rest_fine (vertices c) v).
      * apply (holds_intervals (finest_rest (rev (vertices c)))); [| easy]. now apply (weights_fine _ _ _ _ C v Iv).
    + intros f d g bound I S G. apply F in I as [K _].
      now apply (frame_blends (head c) (vertices c) (triangles_of c) (bvs c) f K i d g bound s0).
  - split; try easy.
Qed.
