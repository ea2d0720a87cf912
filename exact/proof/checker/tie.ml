(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* cinch-check-tie rounding COUNT: the extracted rounding gives this machine's products and sums of doubles, bit by bit.
   cinch-check-tie whole: what whole.ml computes, as claims that Coq is to check by its own arithmetic. *)

let random_z bits = Z.of_bits (String.init ((bits + 7) / 8) (fun _ -> Char.chr (Random.int 256)))

(* ---- Rounding ---- *)

let random_double () =
  let bits = Random.int64 Int64.max_int in
  let sign = if Random.bool () then Int64.min_int else 0L in
  let significand = Int64.logand bits 0xfffffffffffffL in
  let short = Int64.shift_left (Int64.shift_right_logical significand (20 + Random.int 30)) (20 + Random.int 30) in
  let significand = Int64.logand (if Random.int 3 = 0 then short else significand) 0xfffffffffffffL in
  let exponent =
    match Random.int 5 with
    | 0 -> Random.int 3 (* subnormal, or nearly *)
    | 1 -> 2046 - Random.int 3 (* near overflow *)
    | 2 -> 400 + Random.int 200 (* products about the least double *)
    | 3 -> 1023 + Random.int 60
    | _ -> Random.int 2047
  in
  Int64.float_of_bits (Int64.logor sign (Int64.logor (Int64.shift_left (Int64.of_int exponent) 52) significand))

(* x = fst * 2^snd *)
let parts x =
  let m, e = Float.frexp x in
  (Z.of_float (Float.ldexp m 53), e - 53)

let agree k exact machine =
  match Checker.rounded (Z.of_int k) exact with
  | None -> Float.abs machine = infinity
  | Some n ->
    Float.is_finite machine
    &&
    let m, e = parts machine in
    if e + k >= 0 then Z.equal n (Z.shift_left m (e + k)) else Z.equal (Z.shift_left n (-(e + k))) m

let check_rounding count =
  for i = 1 to count do
    let x = random_double () in
    let y = if Random.int 4 = 0 then Float.ldexp x (Random.int 110 - 55) else random_double () in
    let y = if Float.is_finite y then y else 1.0 in
    let (m, e), (n, f) = (parts x, parts y) in
    let k = max 0 (-(e + f)) in
    if not (agree k (Z.shift_left (Z.mul m n) (e + f + k)) (x *. y)) then
      (Printf.printf "product %d: %h * %h\n" i x y; exit 1);
    let k = max 0 (max (-e) (-f)) in
    if not (agree k (Z.add (Z.shift_left m (e + k)) (Z.shift_left n (f + k))) (x +. y)) then
      (Printf.printf "sum %d: %h + %h\n" i x y; exit 1)
  done;
  Printf.printf "%d products and sums agree\n" count

(* ---- Whole numbers ---- *)

let edges =
  let near n = [ Z.pred n; n; Z.succ n ] in
  let exponents = [ 1; 5; 30; 31; 52; 53; 61; 62; 63; 64; 127; 128 ] in
  let powers = List.concat_map (fun s -> near (Z.shift_left Z.one s)) exponents in
  let positive = (Z.zero :: powers) @ List.init 12 (fun i -> random_z (20 * (i + 1))) in
  List.sort_uniq Z.compare (positive @ List.map Z.neg positive)

let few = List.filteri (fun i _ -> i mod 10 = 0) edges
let shifts = List.map Z.of_int [ -200; -128; -64; -63; -62; -53; -2; -1; 0; 1; 2; 53; 61; 62; 63; 64; 65; 128; 200 ]
let literal z = Printf.sprintf "(%s)" (Z.to_string z)
let truth b = if b then "true" else "false"
let order c = if c = 0 then "Eq" else if c < 0 then "Lt" else "Gt"

let claim_all name statement claims =
  Printf.printf "Goal forallb (fun c => %s) [\n%s] = true.\nProof. (* %s *) vm_compute. reflexivity. Qed.\n\n" statement
    (String.concat ";\n" claims) name

let unary name statement result =
  claim_all name ("let '(a, r) := c in " ^ statement)
    (List.map (fun a -> Printf.sprintf "(%s, %s)" (literal a) (result a)) edges)

let binary name statement others result =
  claim_all name ("let '(a, b, r) := c in " ^ statement)
    (List.concat_map
       (fun a -> List.map (fun b -> Printf.sprintf "(%s, %s, %s)" (literal a) (literal b) (result a b)) others)
       few)

let print_claims () =
  print_string "From Coq Require Import ZArith List Bool.\nImport ListNotations.\nOpen Scope Z_scope.\n\n";
  let whole f a = literal (f a) and whole_2 f a b = literal (f a b) in
  List.iter (fun (name, f) -> binary name ("Z." ^ name ^ " a b =? r") few (whole_2 f))
    [ ("add", Whole.add); ("sub", Whole.sub); ("mul", Whole.mul); ("min", Whole.min); ("max", Whole.max) ];
  List.iter (fun (name, f) -> binary name ("Bool.eqb (Z." ^ name ^ " a b) r") few (fun a b -> truth (f a b)))
    [ ("eqb", Whole.eqb); ("ltb", Whole.ltb); ("leb", Whole.leb) ];
  binary "compare" "match Z.compare a b, r with Eq, Eq | Lt, Lt | Gt, Gt => true | _, _ => false end" few (fun a b ->
      order (Whole.compare a b));
  List.iter (fun (name, f) -> binary name ("Z." ^ name ^ " a b =? r") shifts (whole_2 f))
    [ ("shiftl", Whole.shiftl); ("shiftr", Whole.shiftr) ];
  List.iter (fun (name, f) -> unary name ("Z." ^ name ^ " a =? r") (whole f))
    [ ("opp", Whole.opp); ("abs", Whole.abs); ("log2", Whole.log2) ];
  unary "even" "Bool.eqb (Z.even a) r" (fun a -> truth (Whole.even a));
  unary "to_pos" "Z.pos (Z.to_pos a) =? r" (whole Whole.to_pos);
  unary "match_z" "match a with Z0 => 0 | Zpos p => Zpos p + 1 | Zneg p => - Zpos p - 2 end =? r"
    (whole (Whole.match_z (fun () -> Z.zero) Z.succ (fun p -> Z.pred (Z.pred (Z.neg p)))));
  unary "match_positive" "match Z.to_pos a with xI p => 4 * Zpos p | xO p => 4 * Zpos p + 1 | xH => 2 end =? r"
    (whole (fun a ->
         Whole.match_positive
           (fun p -> Z.shift_left p 2)
           (fun p -> Z.succ (Z.shift_left p 2))
           (fun () -> Z.of_int 2)
           (Whole.to_pos a)));
  unary "constructors" "Zpos (xI (xO (Z.to_pos a))) =? r" (whole (fun a -> Whole.x_i (Whole.x_o (Whole.to_pos a))))

let () =
  Random.init 1;
  match Array.to_list Sys.argv with
  | [ _; "rounding"; count ] -> check_rounding (int_of_string count)
  | [ _; "whole" ] -> print_claims ()
  | _ -> prerr_endline "usage: cinch-check-tie rounding COUNT | whole"; exit 2
