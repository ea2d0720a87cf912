(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* Computes what tie/cases.cpp printed by the functions that the theorems are about, and compares bits. Doubles in the
   machine's own arithmetic, and every SOFT-th case also in Flocq's; floats in Flocq's. Exits 1 if any case differs, or
   if there are fewer cases of a function than MINIMUM. Arguments: SOFT, MINIMUM. *)
open Extracted

let rec positive n = if n = 1 then XH else if n land 1 = 1 then XI (positive (n asr 1)) else XO (positive (n asr 1))
let z n = if n = 0 then Z0 else if n > 0 then Zpos (positive n) else Zneg (positive (-n))
let rec int_of_positive = function XH -> 1 | XO p -> 2 * int_of_positive p | XI p -> (2 * int_of_positive p) + 1
let int_of_z = function Z0 -> 0 | Zpos p -> int_of_positive p | Zneg p -> -int_of_positive p

(* An arithmetic with its numbers as bits. *)
type 'n arithmetic = { ops : 'n ops; read : string -> 'n; same : 'n -> 'n -> bool; print : 'n -> string }

let machine =
  { ops = make_ops (z 53) (z (-1074))
      (fun m e -> ldexp (float_of_int (int_of_z m)) (int_of_z e))
      infinity ( +. ) ( -. ) ( *. ) abs_float
      (fun (x : float) y -> x < y)
      (fun (x : float) y -> x <= y)
      ( /. );
    read = (fun s -> Int64.float_of_bits (Int64.of_string ("0x" ^ s)));
    same = (fun x y -> Int64.bits_of_float x = Int64.bits_of_float y || (x <> x && y <> y));
    print = (fun x -> Printf.sprintf "%016Lx" (Int64.bits_of_float x)) }

(* Flocq's: bits to sign, significand and exponent. *)
let flocq ops width_of_significand width_of_exponent =
  let fraction = width_of_significand - 1 in
  let bias = (1 lsl (width_of_exponent - 1)) - 1 in
  let read s =
    let b = Int64.of_string ("0x" ^ s) in
    let field low width =
      Int64.to_int (Int64.logand (Int64.shift_right_logical b low) (Int64.of_int ((1 lsl width) - 1))) in
    let sign = field (fraction + width_of_exponent) 1 = 1 in
    let e = field fraction width_of_exponent and m = field 0 fraction in
    if e = (1 lsl width_of_exponent) - 1 then if m = 0 then B754_infinity sign else B754_nan
    else if e = 0 then
      if m = 0 then B754_zero sign else B754_finite (sign, positive m, z (1 - bias - fraction))
    else B754_finite (sign, positive (m lor (1 lsl fraction)), z (e - bias - fraction)) in
  let print = function
    | B754_zero s -> if s then "-0" else "0"
    | B754_infinity s -> if s then "-inf" else "inf"
    | B754_nan -> "nan"
    | B754_finite (s, m, e) -> Printf.sprintf "%s%d*2^%d" (if s then "-" else "") (int_of_positive m) (int_of_z e) in
  { ops; read; same = ( = ); print }

let double = flocq binary64_ops 53 11
let single = flocq binary32_ops 24 8

exception Bad of string

(* Words of a line, one after the other. *)
let reader words =
  let rest = ref words in
  fun () -> match !rest with [] -> raise (Bad "a line ends early") | w :: r -> rest := r; w

let triple f = let at0 = f () in let at1 = f () in let at2 = f () in { at0; at1; at2 }
let many n f = List.init n (fun _ -> f ())

(* A verdict as a number, so that it can be compared as the others are. *)
let range = z 320
let decided a verdict sign =
  let number = match verdict with Negative -> -1 | Zero -> 0 | Positive -> 1 | Undecided -> 2 in
  [ (a.ops.constant (z number) (z 0), a.ops.constant (z sign) (z 0)) ]

(* What the model makes of a line and what the compiled function made of it. *)
let results a words =
  let word = reader words in
  let name = word () in
  let num () = a.read (word ()) and int () = int_of_string (word ()) in
  (* 'succ32 and the counts of error terms are numbers too *)
  let count () = z (int_of_float (Int64.float_of_bits (Int64.of_string ("0x" ^ word ())))) in
  let row () = let column = triple num in { column; offset = num () } in
  let map () = triple row in
  match name with
  | "succ" | "succ32" -> let x = num () in [ (succ_of a.ops x, num ()) ]
  | "smallest_times32" ->
    let n = z (int_of_float (Int32.float_of_bits (Int32.of_string ("0x" ^ word ())))) in
    [ (smallest_times a.ops n, num ()) ]
  | "extremum_error" -> let m = num () in [ (extremum_error a.ops m, num ()) ]
  | "evaluation_error" -> let n = count () in let m = num () in [ (evaluation_error a.ops n m, num ()) ]
  | "sum_error" -> let n = count () in let m = num () in [ (sum_error a.ops n m, num ()) ]
  | "second_largest" ->
    let b = many (int ()) num in
    [ (second_largest a.ops (List.hd b) (List.tl b), num ()) ]
  | "dual_bound" ->
    let n = int () in
    let lambda = num () in
    let nodes = many n (fun () ->
      let entry_l = num () in let entry_h = num () in { entry_l; entry_h; entry_b = num () }) in
    [ (dual_bound a.ops lambda nodes, num ()) ]
  | "greatest_mean" ->
    let n = int () in
    let nodes = many n (fun () ->
      let entry_l = num () in let entry_h = num () in { entry_l; entry_h; entry_b = num () }) in
    [ (greatest_mean a.ops nodes, num ()) ]
  | "greatest_between" ->
    let first = num () in let last = num () in let bump = num () in let path = num () in
    [ (greatest_between a.ops first last bump path, num ()) ]
  | "bound_box" ->
    let how = int () in
    let along = int () = 0 in
    let axis = triple (fun () -> z (int ())) in
    let influences = int () in
    let n = int () in
    let lambda = num () in
    let centre = triple num in
    let box = { centre; half = triple num } in
    let nodes = many n (fun () ->
      let influence_l = num () in let influence_h = num () in { influence_l; influence_h; influence_map = map () }) in
    let b = many n num in
    let computed = int () = 1 in
    let how = match how with 0 -> Convex | 1 -> Eq12 | 2 -> Limited lambda | _ -> Corners in
    let support = num () in
    (bound_box a.ops how along axis box (z influences) nodes, support)
    :: (if computed then List.map2 (fun n b -> (extremum_of a.ops along axis box n.influence_map, b)) nodes b else [])
  | "evaluate_vertex" ->
    let n = int () in
    let x = triple num in
    let nodes = many n (fun () -> let w = num () in (w, map ())) in
    let v = evaluate_vertex a.ops x nodes in
    let c = triple num in
    [ (v.at0, c.at0); (v.at1, c.at1); (v.at2, c.at2) ]
  | "bound_vertex" ->
    let along = int () = 0 in
    let axis = triple (fun () -> z (int ())) in
    let n = int () in
    let x = triple num in
    let nodes = many n (fun () -> let w = num () in (w, map ())) in
    [ (bound_vertex a.ops along axis x nodes, num ()) ]
  | "filter3" ->
    let p = triple num in let q = triple num in let r = triple num in let s = triple num in
    decided a (filter3 a.ops range p q r s) (int ())
  | "filter2" ->
    let p = num () in let p' = num () in let q = num () in let q' = num () in let r = num () in let r' = num () in
    decided a (filter2 a.ops range p p' q q' r r') (int ())
  | _ -> raise (Bad ("no function " ^ name))

let differing = ref 0
let seen : (string, int * int) Hashtbl.t = Hashtbl.create 16

let compare a line words =
  let all = results a words in
  List.iter (fun (model, compiled) ->
    if not (a.same model compiled) then begin
      incr differing;
      if !differing <= 10 then
        Printf.printf "differs: model %s, compiled %s: %s\n" (a.print model) (a.print compiled) line
    end) all

let () =
  let soft = int_of_string Sys.argv.(1) and minimum = int_of_string Sys.argv.(2) in
  (try
     while true do
       let line = input_line stdin in
       let words = String.split_on_char ' ' line in
       let name = List.hd words in
       let n, s = try Hashtbl.find seen name with Not_found -> (0, 0) in
       let is_single = name = "succ32" || name = "smallest_times32" in
       let in_flocq = is_single || n mod soft = 0 in
       if not is_single then compare machine line words;
       if in_flocq then if is_single then compare single line words else compare double line words;
       Hashtbl.replace seen name (n + 1, if in_flocq then s + 1 else s)
     done
   with End_of_file -> ());
  let functions = [ "succ"; "succ32"; "smallest_times32"; "extremum_error"; "evaluation_error"; "sum_error";
                    "second_largest"; "dual_bound"; "greatest_mean"; "greatest_between"; "bound_box";
                    "evaluate_vertex"; "bound_vertex"; "filter3"; "filter2" ] in
  let short = List.filter (fun name ->
    let n, s = try Hashtbl.find seen name with Not_found -> (0, 0) in
    Printf.printf "%-18s %7d cases, %6d of them in Flocq's arithmetic\n" name n s;
    n < minimum) functions in
  Printf.printf "%d results differ\n" !differing;
  if !differing > 0 || short <> [] then exit 1
