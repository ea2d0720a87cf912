(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* Tables by index, and lists that may be long: every function here that goes through one is a loop. *)
From Coq Require Import ZArith List FMapPositive.
From CinchChecker Require Import content.
Import ListNotations.
Open Scope Z_scope.

Definition table (A : Type) := PositiveMap.t A.
Definition empty {A : Type} : table A := PositiveMap.empty A.
Definition key (i : Z) : positive := Z.to_pos (i + 1).
Definition get {A : Type} (t : table A) (i : Z) : option A := if i <? 0 then None else PositiveMap.find (key i) t.
Definition put {A : Type} (i : Z) (x : A) (t : table A) : table A := PositiveMap.add (key i) x t.

Fixpoint fill {A : Type} (i : Z) (l : list A) (t : table A) : table A :=
  match l with
  | [] => t
  | x :: r => fill (i + 1) r (put i x t)
  end.
Definition table_of {A : Type} (l : list A) : table A := fill 0 l empty.

(* The other way round; `rev` of the standard library takes quadratic time. *)
Definition reversed {A : Type} (l : list A) : list A := rev_append l [].

(* flat_map, in another order *)
Definition gather {A B : Type} (f : A -> list B) (l : list A) : list B :=
  fold_left (fun out x => rev_append (f x) out) l [].

(* map, the other way round *)
Definition reversed_map {A B : Type} (f : A -> B) (l : list A) : list B := fold_left (fun out x => f x :: out) l [].

Fixpoint distinct_beside (seen : table unit) (l : list Z) : bool :=
  match l with
  | [] => true
  | x :: r =>
    match get seen x with
    | Some _ => false
    | None => distinct_beside (put x tt seen) r
    end
  end.

Definition size {A : Type} (l : list A) : Z := fold_left (fun n _ => n + 1) l 0.

(* All of first, ..., first + n - 1, each once *)
Definition each_once (first n : Z) (l : list Z) : bool :=
  forallb (fun x => (first <=? x) && (x <? first + n))%bool l && (size l =? n) && distinct_beside empty l.
