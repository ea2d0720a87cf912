(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* Weak duality: a bound above D(lambda), for whatever lambda, holds for all that box and weight intervals allow. *)
From Coq Require Import ZArith List Bool Reals FMapPositive SetoidList Lia Lra.
From Flocq Require Import Core.
From CinchChecker Require Import content statement table numbers evaluation duality numbers_proof table_proof
  evaluation_proof.
Import ListNotations.
Open Scope R_scope.

(* ---- Boxes and intervals hold the vertices that they come from ---- *)

Definition unit_weight (l : list (Z * Z)) (j : Z) : Z :=
  match find (fun ju => (fst ju =? j)%Z) l with Some (_, u) => u | None => 0%Z end.

Record holds (s : space) (u : unit_vertex) : Prop := {
  holds_x : (x0 s <= ux u <= x1 s)%Z;
  holds_y : (y0 s <= uy u <= y1 s)%Z;
  holds_z : (z0 s <= uz u <= z1 s)%Z;
  holds_weights : forall j, match get (weights s) j with
    | Some (l, h) => (l <= unit_weight (unit_weights u) j <= h)%Z
    | None => unit_weight (unit_weights u) j = 0%Z
    end
}.

Lemma space_of_holds u : (forall j w, In (j, w) (unit_weights u) -> (0 <= j)%Z) -> holds (space_of u) u.
Proof.
  intro P. split; cbn; try lia. intro j. unfold unit_weight. revert P. induction (unit_weights u) as [| [i w] l IH];
    intro P; cbn [fold_right fst snd find].
  - now rewrite get_empty.
  - assert (0 <= i)%Z by (apply (P i w); now left). destruct (Z.eqb_spec i j) as [-> | N].
    + rewrite get_put_same by easy. lia.
    + rewrite get_put_other by easy. apply IH. intros i' w' I. apply (P i' w'). now right.
Qed.

Lemma get_map2 a b j : get (PositiveMap.map2 join_interval a b) j = join_interval (get a j) (get b j).
Proof.
  unfold get. destruct (j <? 0)%Z; [reflexivity |]. unfold PositiveMap.map2. rewrite PositiveMap.gmap2 by reflexivity.
  now destruct (PositiveMap.find (key j) a), (PositiveMap.find (key j) b).
Qed.

Lemma join_holds_left a b u : holds a u -> holds (join_space a b) u.
Proof.
  intros [X Y Z W]. split; cbn; try lia. intro j. rewrite get_map2. specialize (W j).
  destruct (get (weights a) j) as [[l h] |], (get (weights b) j) as [[l' h'] |]; cbn; lia.
Qed.

Lemma join_holds_right a b u : holds b u -> holds (join_space a b) u.
Proof.
  intros [X Y Z W]. split; cbn; try lia. intro j. rewrite get_map2. specialize (W j).
  destruct (get (weights a) j) as [[l h] |], (get (weights b) j) as [[l' h'] |]; cbn; lia.
Qed.

Lemma interval_list_In t j e : In (j, e) (interval_list t) <-> get t j = Some e.
Proof.
  unfold interval_list, get. rewrite in_map_iff. split.
  - intros ([p f] & E & I). cbn [fst snd] in E. assert (Z.pos p - 1 = j /\ f = e)%Z as [<- ->] by (split; congruence).
    apply PositiveMap.elements_complete in I.
    destruct (Z.ltb_spec (Z.pos p - 1) 0); [lia |]. unfold key. now rewrite Z.sub_add.
  - destruct (Z.ltb_spec j 0) as [L | L]; [easy |]. intro F. exists (key j, e). split.
    + cbn [fst snd]. f_equal. unfold key. rewrite Z2Pos.id by lia. ring.
    + now apply PositiveMap.elements_correct.
Qed.

Lemma interval_list_NoDup t : NoDup (map fst (interval_list t)).
Proof.
  unfold interval_list. rewrite map_map. cbn [fst]. pose proof (PositiveMap.elements_3w t) as N.
  induction N as [| [p e] l A N IH]; cbn [map]; constructor; [| easy].
  intro I. apply A. apply in_map_iff in I as ([q f] & E & I). cbn [fst snd] in E. apply InA_alt.
  exists (q, f). split; [| easy]. assert (q = p) as -> by lia. reflexivity.
Qed.

Definition corner_point (k a b c : Z) : point := Point (Dyadic a (- k)) (Dyadic b (- k)) (Dyadic c (- k)).
Definition box_of (k : Z) (s : space) : box :=
  Box (corner_point k (x0 s) (y0 s) (z0 s)) (corner_point k (x1 s) (y1 s) (z1 s)).
Definition intervals_of (s : space) : list interval :=
  map (fun e => (fst e, (Dyadic (fst (snd e)) (- weight_bits), Dyadic (snd (snd e)) (- weight_bits))))
    (interval_list (weights s)).

Lemma intervals_In s j a b : In (j, (a, b)) (intervals_of s) <->
  exists l h, get (weights s) j = Some (l, h) /\ a = Dyadic l (- weight_bits) /\ b = Dyadic h (- weight_bits).
Proof.
  unfold intervals_of. rewrite in_map_iff. split.
  - intros ([i [l h]] & E & I). cbn in E. injection E as -> <- <-. apply interval_list_In in I. now exists l, h.
  - intros (l & h & G & -> & ->). exists (j, (l, h)). split; [reflexivity |]. now apply interval_list_In.
Qed.

Lemma intervals_NoDup s : NoDup (map fst (intervals_of s)).
Proof. unfold intervals_of. rewrite map_map. apply interval_list_NoDup. Qed.

Lemma holds_box rest_bits s v : fine rest_bits (coordinates (rest v)) -> holds s (vertex_in_units rest_bits v) ->
  in_box (box_of rest_bits s) (value (px (rest v))) (value (py (rest v))) (value (pz (rest v))).
Proof.
  intros F [X Y Z _]. unfold in_box, within, box_of. cbn [low high px py pz corner_point].
  rewrite <- (units_value rest_bits (px (rest v))) by (apply F; now left).
  rewrite <- (units_value rest_bits (py (rest v))) by (apply F; now right; left).
  rewrite <- (units_value rest_bits (pz (rest v))) by (apply F; now right; right; left).
  cbn in X, Y, Z. repeat split; apply in_units_le; easy.
Qed.

Lemma weight_of_units rest_bits v : (forall j w, In (j, w) (influences v) -> is_weight w = true) -> forall j,
  weight_of v j = in_units weight_bits (unit_weight (unit_weights (vertex_in_units rest_bits v)) j).
Proof.
  intros W j. unfold weight_of, unit_weight. cbn [unit_weights vertex_in_units].
  induction (influences v) as [| [i w] l IH]; cbn [map find fst snd]; [now rewrite in_units_0 |].
  destruct (Z.eqb i j).
  - assert (is_weight w = true) as D by (apply (W i w); now left). now apply is_weight_sound in D.
  - apply IH. intros i' w' I. apply (W i' w'). now right.
Qed.

Lemma holds_intervals rest_bits s v : (forall j w, In (j, w) (influences v) -> is_weight w = true) ->
  holds s (vertex_in_units rest_bits v) -> weights_within (intervals_of s) v.
Proof.
  intros W [_ _ _ H]. split.
  - intros j a b I. apply intervals_In in I as (l & h & G & -> & ->). specialize (H j). rewrite G in H.
    rewrite (weight_of_units rest_bits) by easy. unfold within. split; apply in_units_le; easy.
  - intros j N. rewrite (weight_of_units rest_bits) by easy. specialize (H j).
    destruct (get (weights s) j) as [[l h] |] eqn:G; [| rewrite H; apply in_units_0].
    exfalso. apply N. apply in_map_iff. exists (j, (Dyadic l (- weight_bits), Dyadic h (- weight_bits))).
    split; [reflexivity |]. apply intervals_In. now exists l, h.
Qed.

(* ---- The extremum of a moved box ---- *)

Lemma side_extremum g a b x : a <= x <= b -> g * x <= (g * (a + b) + Rabs g * (b - a)) / 2.
Proof. intro H. unfold Rabs. destruct (Rcase_abs g); nra. Qed.

Lemma in_units_abs k n : in_units k (Z.abs n) = Rabs (in_units k n).
Proof. unfold in_units. rewrite Rabs_mult, abs_IZR, (Rabs_pos_eq (bpow _ _)) by apply bpow_ge_0. reflexivity. Qed.

Lemma in_units_half k n : in_units (k + 1) n = in_units k n / 2.
Proof.
  unfold in_units. rewrite Z.opp_add_distr, bpow_plus. change (bpow radix2 (- (1))) with (/ 2). unfold Rdiv. ring.
Qed.

Lemma in_units_sub k m n : in_units k (m - n) = in_units k m - in_units k n.
Proof. unfold in_units. rewrite minus_IZR. ring. Qed.

Definition moved (g : direction) (m : affine) (p : R * R * R) : R :=
  let '(x, y, z) := p in along g (image (row_x m) x y z) (image (row_y m) x y z) (image (row_z m) x y z).

(* Of the moved box *)
Definition extremum (s : space) (m : unit_map) (g : direction) : Z :=
  radius (listed s) (column_of g m) + middle (listed s) (column_of g m).

Lemma extremum_opposite s m g :
  extremum s m (opposite g) = (radius (listed s) (column_of g m) - middle (listed s) (column_of g m))%Z.
Proof.
  assert (forall a b c, unit_along (opposite g) a b c = (- unit_along g a b c)%Z) as O
    by (intros a b c; destruct g as [[p q] r]; cbn; ring).
  unfold extremum, radius, middle, column_of. cbn [ga gb gc twice_t]. rewrite !O, !Z.abs_opp. ring.
Qed.

Lemma extremum_sound map_bits rest_bits g m s x y z :
  (0 <= map_bits)%Z -> (0 <= rest_bits)%Z -> fine map_bits (entries m) -> in_box (box_of rest_bits s) x y z ->
  moved g m (x, y, z) <=
  in_units (map_bits + rest_bits + 1) (extremum s (map_in_units map_bits rest_bits m) g).
Proof.
  intros M R F [X [Y Z]]. unfold within, box_of in X, Y, Z. cbn [low high px py pz corner_point] in X, Y, Z.
  change (value (Dyadic (x0 s) (- rest_bits))) with (in_units rest_bits (x0 s)) in X.
  change (value (Dyadic (x1 s) (- rest_bits))) with (in_units rest_bits (x1 s)) in X.
  change (value (Dyadic (y0 s) (- rest_bits))) with (in_units rest_bits (y0 s)) in Y.
  change (value (Dyadic (y1 s) (- rest_bits))) with (in_units rest_bits (y1 s)) in Y.
  change (value (Dyadic (z0 s) (- rest_bits))) with (in_units rest_bits (z0 s)) in Z.
  change (value (Dyadic (z1 s) (- rest_bits))) with (in_units rest_bits (z1 s)) in Z.
  assert (fine map_bits (entries_of_row (row_x m))) as Fx by (intros d I; apply F, in_or_app; now left).
  assert (fine map_bits (entries_of_row (row_y m))) as Fy
    by (intros d I; apply F, in_or_app; right; apply in_or_app; now left).
  assert (fine map_bits (entries_of_row (row_z m))) as Fz
    by (intros d I; apply F, in_or_app; right; apply in_or_app; now right).
  destruct (entries_value map_bits rest_bits R _ Fx) as (Xa & Xb & Xc & Xt).
  destruct (entries_value map_bits rest_bits R _ Fy) as (Ya & Yb & Yc & Yt).
  destruct (entries_value map_bits rest_bits R _ Fz) as (Za & Zb & Zc & Zt).
  unfold extremum, radius, middle, listed, column_of.
  cbn [ga gb gc twice_t sum_x sum_y sum_z extent_x extent_y extent_z unit_x unit_y unit_z map_in_units].
  rewrite in_units_half, !in_units_add, (in_units_scale _ 2), !in_units_mul, !in_units_abs, !along_value,
    !in_units_add,
    !in_units_sub.
  rewrite Xa, Xb, Xc, Xt, Ya, Yb, Yc, Yt, Za, Zb, Zc, Zt.
  unfold moved.
  set (a := along g (value (ra (row_x m))) (value (ra (row_y m))) (value (ra (row_z m)))).
  set (b := along g (value (rb (row_x m))) (value (rb (row_y m))) (value (rb (row_z m)))).
  set (c := along g (value (rc (row_x m))) (value (rc (row_y m))) (value (rc (row_z m)))).
  set (t := along g (value (rt (row_x m))) (value (rt (row_y m))) (value (rt (row_z m)))).
  assert (along g (image (row_x m) x y z) (image (row_y m) x y z) (image (row_z m) x y z) = a * x + b * y + c * z + t)
    as ->.
  { unfold a, b, c, t, along, image. destruct g as [[p q] r]. ring. }
  pose proof (side_extremum a _ _ x X). pose proof (side_extremum b _ _ y Y). pose proof (side_extremum c _ _ z Z).
  lra.
Qed.

(* ---- Duality ---- *)

Section Dual.
  Context (ms : list affine) (map_bits rest_bits : Z).
  Context (Hm : (0 <= map_bits)%Z) (Hr : (0 <= rest_bits)%Z).
  Context (Hfine : forall m, In m ms -> fine map_bits (entries m)).

  Let k := (map_bits + rest_bits)%Z.

  Definition image_of (g : direction) (j : Z) (p : R * R * R) : R :=
    let '(a, b, c) := p in
    along g (image (row_of row_x ms j) a b c) (image (row_of row_y ms j) a b c) (image (row_of row_z ms j) a b c).

  (* Terms belong to intervals, and b of each is the extremum along g. *)
  Definition matches (s : space) (g : direction) (b : term -> Z) (iv : Z * (Z * Z)) (e : term) : Prop :=
    least e = fst (snd iv) /\ most e = snd (snd iv) /\
    exists m, at_index ms (fst iv) = Some m /\ b e = extremum s (map_in_units map_bits rest_bits m) g.

  Lemma terms_match s g t : (forall j, get t j =
      option_map (fun m => column_of g (map_in_units map_bits rest_bits m)) (at_index ms j)) -> forall l es,
    terms (listed s) t l = Some es ->
    Forall2 (matches s g along_it) l es /\ Forall2 (matches s (opposite g) against_it) l es.
  Proof.
    intro Ht. induction l as [| [j [lo hi]] l IH]; intros es E; cbn [terms] in E.
    - injection E as <-. split; constructor.
    - rewrite Ht in E. destruct (at_index ms j) as [m |] eqn:A; [| easy]. cbn [option_map] in E.
      destruct (terms (listed s) t l) as [es' |]; [| easy]. destruct (IH es' eq_refl) as [P Q].
      injection E as <-. split; constructor; try easy; (split; [easy |]; split; [easy |]); exists m; (split;
        [easy |]).
      + reflexivity.
      + symmetry. apply extremum_opposite.
  Qed.

  Lemma times_mul q n : times q n = (q * n)%Z.
  Proof. unfold times. destruct (Z.eqb_spec q 1) as [-> |]; ring. Qed.

  Lemma dual_sound (s : space) (g : direction) (b : term -> Z) (p q : Z) (w : Z -> R) (x : Z -> R * R * R) :
    (0 < q)%Z -> (forall j, let '(a, b, c) := x j in in_box (box_of rest_bits s) a b c) -> forall l es n,
    Forall2 (matches s g b) l es ->
    (forall j lo hi, In (j, (lo, hi)) l -> 0 <= w j /\ in_units weight_bits lo <= w j <= in_units weight_bits hi) ->
    in_units (k + 1 + weight_bits) n +
      IZR q * fold_right (fun e sum => w (fst e) * image_of g (fst e) (x (fst e)) + sum) 0 l -
      in_units (k + 1) p * fold_right (fun e sum => w (fst e) + sum) 0 l <=
    in_units (k + 1 + weight_bits) (dual_sum b p q es n).
  Proof.
    intros Q B. induction l as [| [j [lo hi]] l IH]; intros es n F W; inversion F as [| iv e l' es' M F']; subst.
    - cbn. lra.
    - destruct M as (Lo & Hi & m & A & Be). cbn [fst snd] in Lo, Hi, A.
      unfold dual_sum. cbn [fold_left]. fold (dual_sum b p q). rewrite times_mul, Lo, Hi, Be.
      set (u := extremum s (map_in_units map_bits rest_bits m) g) in *.
      set (d := (q * u - p)%Z).
      set (v := if (0 <? d)%Z then hi else lo).
      assert (forall i a c, In (i, (a, c)) l -> 0 <= w i /\ in_units weight_bits a <= w i <= in_units weight_bits c)
        as W'
        by (intros i a c I; apply (W i a c); now right).
      pose proof (IH es' (n + v * d)%Z F' W') as G.
      cbn [fold_right fst]. rewrite in_units_add in G.
      replace (k + 1 + weight_bits)%Z with (weight_bits + (k + 1))%Z in G at 2 by ring. rewrite in_units_mul in G.
      destruct (W j lo hi) as [W0 [Wl Wh]]; [now left |].
      assert (w j * in_units (k + 1) d <= in_units weight_bits v * in_units (k + 1) d) as T.
      { unfold v. destruct (Z.ltb_spec 0 d) as [L | L].
        - apply Rmult_le_compat_r; [| easy]. rewrite <- (in_units_0 (k + 1)). apply in_units_le. lia.
        - assert (in_units (k + 1) d <= 0) by (rewrite <- (in_units_0 (k + 1)); apply in_units_le; lia). nra. }
      assert (in_units (k + 1) d = IZR q * in_units (k + 1) u - in_units (k + 1) p) as D.
      { unfold d. now rewrite in_units_sub, in_units_scale. }
      assert (image_of g j (x j) <= in_units (k + 1) u) as E.
      { unfold image_of, row_of. rewrite A. specialize (B j). destruct (x j) as [[x' y'] z'].
        apply (extremum_sound map_bits rest_bits g m s x' y' z'); try easy. apply Hfine. now apply at_index_In in A. }
      assert (0 < IZR q) as Q' by now apply IZR_lt.
      assert (w j * image_of g j (x j) <= w j * in_units (k + 1) u) as E' by now apply Rmult_le_compat_l.
      rewrite D in T. nra.
  Qed.

  Lemma multiplier_positive m : is_multiplier m = true -> (0 < snd (multiplier_in_units (k + 1) m))%Z.
  Proof.
    destruct m as [d | p q]; cbn [is_multiplier multiplier_in_units].
    - intros _. destruct (Z.leb_spec 0 (exn d + (k + 1))) as [L | L]; cbn [snd]; [lia |].
      assert (0 <= k)%Z by (unfold k; lia). rewrite Z.shiftl_mul_pow2, Z.mul_1_l by lia. apply Z.pow_pos_nonneg; lia.
    - cbn [snd]. apply Z.ltb_lt.
  Qed.

  Lemma above_dual_sound s g b es bound lambda : Forall2 (matches s g b) (interval_list (weights s)) es ->
    above_dual k b es (Some bound) lambda = true ->
    blends_enclosed g ms (box_of rest_bits s) (intervals_of s) (value bound).
  Proof.
    intro F. unfold above_dual. rewrite andb_true_iff. intros [M E]. apply multiplier_positive in M.
    destruct (multiplier_in_units (k + 1) lambda) as [p q]. cbn [snd] in M.
    apply at_least_sound in E. intros w x W One B.
    assert (value (Dyadic (man bound * q) (exn bound)) = IZR q * value bound) as V.
    { unfold value. cbn [man exn]. rewrite mult_IZR. ring. }
    rewrite V in E.
    assert (in_units (k + 1 + weight_bits) (Z.shiftl p weight_bits) = in_units (k + 1) p) as P.
    { unfold in_units. rewrite IZR_shiftl by easy. rewrite Rmult_assoc, <- bpow_plus. do 2 f_equal. ring. }
    pose proof (dual_sound s g b p q w x M B (interval_list (weights s)) es (Z.shiftl p weight_bits) F) as D.
    rewrite P in D.
    assert (forall f : Z -> R, fold_right (fun e sum => f (fst e) + sum) 0 (intervals_of s) =
      fold_right (fun e sum => f (fst e) + sum) 0 (interval_list (weights s))) as Same.
    { intro f. unfold intervals_of. clear. induction (interval_list (weights s)) as [| e l IH]; [easy |].
      cbn [map fold_right fst]. f_equal. exact IH. }
    rewrite (Same w) in One.
    assert (blend g ms w x (intervals_of s) =
      fold_right (fun e sum => w (fst e) * image_of g (fst e) (x (fst e)) + sum) 0 (interval_list (weights s))) as ->.
    { rewrite <- (Same (fun j => w j * image_of g j (x j))). unfold blend.
      unfold image_of. clear. generalize (intervals_of s). intro l. induction l as [| e l IH]; [easy |].
      cbn [fold_right]. rewrite IH. now destruct (x (fst e)) as [[a c] d]. }
    rewrite One in D.
    assert (0 < IZR q) as Q by now apply IZR_lt.
    assert (forall j lo hi, In (j, (lo, hi)) (interval_list (weights s)) ->
      0 <= w j /\ in_units weight_bits lo <= w j <= in_units weight_bits hi) as Inside.
    { intros j lo hi I. apply interval_list_In in I.
      apply (W j (Dyadic lo (- weight_bits)) (Dyadic hi (- weight_bits))). apply intervals_In. now exists lo, hi. }
    specialize (D Inside). nra.
  Qed.

  Theorem above_duals_sound s (table_for : direction -> table column) :
    (forall g j, get (table_for g) j =
      option_map (fun m => column_of g (map_in_units map_bits rest_bits m)) (at_index ms j)) ->
    forall gs bs ls, above_duals k (listed s) (map table_for gs) bs ls = true -> forall d g b,
    nth_error (flat_map (fun g => [g; opposite g]) gs) d = Some g -> nth_error bs d = Some (Some b) ->
    blends_enclosed g ms (box_of rest_bits s) (intervals_of s) (value b).
  Proof.
    intro Ht. induction gs as [| g gs IH]; intros bs ls E d g' b G N; [now destruct d |].
    cbn [map above_duals] in E. destruct bs as [| b0 [| b1 bs]]; try easy. destruct ls as [| l0 [| l1 ls]]; try easy.
    destruct (terms (listed s) (table_for g) (intervals (listed s))) as [es |] eqn:T; [| easy].
    apply (terms_match s g (table_for g) (Ht g)) in T as [P Q].
    rewrite !andb_true_iff in E. destruct E as [[A C] E].
    cbn [flat_map app] in G. destruct d as [| [| d]]; cbn [nth_error] in G, N.
    - injection G as <-. injection N as ->. now apply (above_dual_sound s g along_it es b l0).
    - injection G as <-. injection N as ->. now apply (above_dual_sound s (opposite g) against_it es b l1).
    - now apply (IH bs ls E d).
  Qed.
End Dual.
