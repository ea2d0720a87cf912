(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* Supports of a vertex enclose it, in real arithmetic and in doubles. *)
From Coq Require Import ZArith List Bool Reals Lia Lra.
From Flocq Require Import Core.
From CinchChecker Require Import content statement table numbers evaluation numbers_proof table_proof.
Import ListNotations.
Open Scope R_scope.

Definition fine (k : Z) (l : list dyadic) : Prop := forall d, In d l -> (0 <= exn d + k)%Z.

Lemma fl_in_units k n x : (0 <= k)%Z -> in_units k n = x -> option_map (in_units k) (rounded k n) = fl x.
Proof. intros K <-. now apply rounded_is_fl. Qed.

Lemma rounded_add_fadd k a b : (0 <= k)%Z ->
  option_map (in_units k) (rounded_add k a b) = fadd (option_map (in_units k) a) (option_map (in_units k) b).
Proof.
  intro K. destruct a as [a |], b as [b |]; try reflexivity. cbn. apply fl_in_units; [easy |]. apply in_units_add.
Qed.

Lemma rounded_mul_fmul k u b : (0 <= k)%Z ->
  option_map (in_units (k + weight_bits)) (rounded_op Z.mul (k + weight_bits) (Some u) b) =
  fmul (Some (in_units weight_bits u)) (option_map (in_units k) b).
Proof.
  intro K. destruct b as [b |]; try reflexivity. cbn. apply fl_in_units; [unfold weight_bits; lia |].
  rewrite Z.add_comm. apply in_units_mul.
Qed.

Section Frame.
  Context (ms : list affine) (map_bits rest_bits : Z) (t : table unit_map).
  Context (Hm : (0 <= map_bits)%Z) (Hr : (0 <= rest_bits)%Z).
  Context (Hfine : forall m, In m ms -> fine map_bits (entries m)).
  Context (Ht : forall j, get t j = option_map (map_in_units map_bits rest_bits) (at_index ms j)).

  Let k := (map_bits + rest_bits)%Z.

  Section Vertex.
    Context (v : vertex) (Hrest : fine rest_bits (coordinates (rest v))).
    Context (Hweights : forall j w, In (j, w) (influences v) -> is_weight w = true).

    Let u := vertex_in_units rest_bits v.
    Let x := value (px (rest v)).
    Let y := value (py (rest v)).
    Let z := value (pz (rest v)).

    Lemma rest_x : in_units rest_bits (ux u) = x.
    Proof. apply units_value. apply Hrest. now left. Qed.
    Lemma rest_y : in_units rest_bits (uy u) = y.
    Proof. apply units_value. apply Hrest. now right; left. Qed.
    Lemma rest_z : in_units rest_bits (uz u) = z.
    Proof. apply units_value. apply Hrest. now right; right; left. Qed.

    Section Coordinate.
      Context (pick : affine -> row) (unit_pick : unit_map -> unit_row).
      Context (Hpick : forall m, unit_pick (map_in_units map_bits rest_bits m) =
        row_in_units map_bits rest_bits (pick m)).
      Context (Hno : unit_pick no_unit_map = no_unit_row).
      Context (Hentries : forall m, incl (entries_of_row (pick m)) (entries m)).

      Lemma row_fine j : fine map_bits (entries_of_row (row_of pick ms j)).
      Proof.
        unfold row_of. destruct (at_index ms j) as [m |] eqn:E.
        - apply at_index_In in E. intros d I. apply (Hfine m E). now apply Hentries.
        - intros d I. cbn in I. destruct I as [<- | [<- | [<- | [<- | []]]]]; cbn; lia.
      Qed.

      Lemma resolved_row j :
        unit_pick (match get t j with Some m => m | None => no_unit_map end) =
        row_in_units map_bits rest_bits (row_of pick ms j).
      Proof.
        rewrite Ht. unfold row_of. destruct (at_index ms j) as [m |]; cbn [option_map]; [apply Hpick |].
        rewrite Hno. unfold row_in_units, no_row, no_unit_row, units. cbn. now rewrite !Z.shiftl_0_l.
      Qed.

      Lemma entries_value (r : row) (q := row_in_units map_bits rest_bits r) : fine map_bits (entries_of_row r) ->
        in_units map_bits (ua q) = value (ra r) /\ in_units map_bits (ub q) = value (rb r) /\
        in_units map_bits (uc q) = value (rc r) /\ in_units k (ut q) = value (rt r).
      Proof.
        intro F. unfold q; cbn. repeat split; apply units_value.
        - apply F. now left.
        - apply F. now right; left.
        - apply F. now right; right; left.
        - assert (0 <= exn (rt r) + map_bits)%Z by (apply F; now right; right; right; left). unfold k. lia.
      Qed.

      Lemma image_value (r : row) (q := row_in_units map_bits rest_bits r) : fine map_bits (entries_of_row r) ->
        in_units k (ua q * ux u + ub q * uy u + uc q * uz u + ut q) = image r x y z.
      Proof.
        intro F. destruct (entries_value r F) as (A & B & C & T). fold q in A, B, C, T.
        rewrite !in_units_add. unfold k. rewrite !in_units_mul, rest_x, rest_y, rest_z, A, B, C. fold k.
        now rewrite T.
      Qed.

      Lemma computed_image_value (r : row) (q := row_in_units map_bits rest_bits r) :
        fine map_bits (entries_of_row r) ->
        option_map (in_units k) (rounded_image k q u) = computed_image r x y z.
      Proof.
        intro F. destruct (entries_value r F) as (A & B & C & T). fold q in A, B, C, T.
        assert (0 <= k)%Z as K by (unfold k; lia).
        unfold rounded_image, computed_image. rewrite !rounded_add_fadd by easy. cbn [option_map]. rewrite T.
        do 2 f_equal; [f_equal |]; apply fl_in_units; try easy; unfold k; rewrite in_units_mul;
          rewrite ?rest_x, ?rest_y, ?rest_z, ?A, ?B, ?C; reflexivity.
      Qed.

      Lemma sum_value l : (forall j w, In (j, w) l -> is_weight w = true) ->
        in_units (k + weight_bits)
          (unit_sum unit_pick u (resolved t (map (fun jw => (fst jw, units weight_bits (snd jw))) l))) =
        exact_sum pick ms x y z l.
      Proof.
        induction l as [| [j w] l IH]; intro W; [apply in_units_0 |].
        cbn [map resolved unit_sum fst snd exact_sum]. rewrite resolved_row.
        rewrite in_units_add. f_equal; [| apply IH; intros i w' I; apply (W i w'); now right].
        rewrite Z.add_comm, in_units_mul, image_value by apply row_fine. f_equal.
        assert (is_weight w = true) as D by (apply (W j w); now left). apply is_weight_sound in D. symmetry. apply D.
      Qed.

      Lemma computed_sum_value l : (forall j w, In (j, w) l -> is_weight w = true) -> forall s,
        option_map (in_units (k + weight_bits))
          (rounded_sum unit_pick k u (resolved t (map (fun jw => (fst jw, units weight_bits (snd jw))) l)) s) =
        computed_sum pick ms x y z l (option_map (in_units (k + weight_bits)) s).
      Proof.
        assert (0 <= k)%Z as K by (unfold k; lia).
        induction l as [| [j w] l IH]; intros W s; [reflexivity |].
        cbn [map resolved fst snd]. unfold rounded_sum, computed_sum. cbn [fold_left fst snd].
        fold (computed_sum pick ms x y z). fold (rounded_sum unit_pick k u).
        assert (is_weight w = true) as D by (apply (W j w); now left). apply is_weight_sound in D as (_ & D & _).
        fold (resolved t (map (fun jw : Z * dyadic => (fst jw, units weight_bits (snd jw))) l)).
        rewrite IH by (intros i w' I; apply (W i w'); now right). f_equal.
        rewrite rounded_add_fadd by (unfold weight_bits; lia). f_equal. rewrite rounded_mul_fmul by easy.
        rewrite <- D. f_equal. rewrite resolved_row. apply computed_image_value. apply row_fine.
      Qed.
    End Coordinate.

    Let l := resolved t (unit_weights u).

    Lemma exact_x : in_units (k + weight_bits) (unit_sum unit_x u l) = exact_coordinate row_x ms v.
    Proof. apply sum_value; auto. intros m d I. apply in_or_app. now left. Qed.
    Lemma exact_y : in_units (k + weight_bits) (unit_sum unit_y u l) = exact_coordinate row_y ms v.
    Proof. apply sum_value; auto. intros m d I. apply in_or_app. right. apply in_or_app. now left. Qed.
    Lemma exact_z : in_units (k + weight_bits) (unit_sum unit_z u l) = exact_coordinate row_z ms v.
    Proof. apply sum_value; auto. intros m d I. apply in_or_app. right. apply in_or_app. now right. Qed.

    Lemma computed_x : option_map (in_units (k + weight_bits)) (rounded_sum unit_x k u l (Some 0%Z)) =
      computed_coordinate row_x ms v.
    Proof.
      unfold l, computed_coordinate. unfold u at 2. cbn [unit_weights vertex_in_units].
      rewrite (computed_sum_value row_x); auto; [cbn; now rewrite in_units_0 |]. intros m d I. apply in_or_app.
      now left.
    Qed.
    Lemma computed_y : option_map (in_units (k + weight_bits)) (rounded_sum unit_y k u l (Some 0%Z)) =
      computed_coordinate row_y ms v.
    Proof.
      unfold l, computed_coordinate. unfold u at 2. cbn [unit_weights vertex_in_units].
      rewrite (computed_sum_value row_y); auto; [cbn; now rewrite in_units_0 |].
      intros m d I. apply in_or_app. right. apply in_or_app. now left.
    Qed.
    Lemma computed_z : option_map (in_units (k + weight_bits)) (rounded_sum unit_z k u l (Some 0%Z)) =
      computed_coordinate row_z ms v.
    Proof.
      unfold l, computed_coordinate. unfold u at 2. cbn [unit_weights vertex_in_units].
      rewrite (computed_sum_value row_z); auto; [cbn; now rewrite in_units_0 |].
      intros m d I. apply in_or_app. right. apply in_or_app. now right.
    Qed.

    Lemma along_value j g a b c :
      in_units j (unit_along g a b c) = along g (in_units j a) (in_units j b) (in_units j c).
    Proof. destruct g as [[p q] r]. cbn. now rewrite !in_units_add, !in_units_scale. Qed.

    Lemma part_value j a b : option_map (in_units j) (unit_part a b) = part a (option_map (in_units j) b).
    Proof.
      unfold unit_part, part. destruct (a =? 0)%Z; cbn; [now rewrite in_units_0 |]. destruct b; cbn; [| easy].
      now rewrite in_units_scale.
    Qed.

    Lemma rounded_along_value j g a b c :
      option_map (in_units j) (rounded_along g a b c) =
      along_computed g (option_map (in_units j) a) (option_map (in_units j) b) (option_map (in_units j) c).
    Proof.
      destruct g as [[p q] r]. cbn. rewrite <- !part_value.
      destruct (unit_part p a), (unit_part q b), (unit_part r c); try reflexivity. cbn. now rewrite !in_units_add.
    Qed.

    Lemma supports_enclose gs d g s :
      nth_error gs d = Some g -> nth_error (supports_of_vertex gs k t u) d = Some (Some s) ->
      encloses g ms v (in_units (k + weight_bits) s).
    Proof.
      intros G. unfold supports_of_vertex. cbv zeta. fold l. rewrite nth_error_map, G. cbn [option_map].
      set (e := unit_along _ _ _ _). destruct (rounded_along g _ _ _) as [c |] eqn:C; [| easy]. cbn. intro S.
      injection S as <-. rewrite in_units_max. split.
      - apply Rle_trans with (in_units (k + weight_bits) e); [| apply Rmax_l]. unfold e. rewrite along_value.
        rewrite exact_x, exact_y, exact_z. apply Rle_refl.
      - exists (in_units (k + weight_bits) c). split; [| apply Rmax_r].
        unfold computed_along. rewrite <- computed_x, <- computed_y, <- computed_z, <- rounded_along_value.
        now rewrite C.
    Qed.
  End Vertex.
End Frame.
