(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* SHA-256 (FIPS 180-4) of bytes that come piece by piece *)
type t = { state : int array; block : Bytes.t; mutable filled : int; mutable length : int }

let mask = 0xffffffff

(* The first 32 bits of the fractional parts of roots of the first primes *)
let primes count =
  let rec more found n =
    if List.length found = count then List.rev found
    else more (if List.exists (fun p -> n mod p = 0) found then found else n :: found) (n + 1)
  in
  more [] 2

let fraction_of_root power p = (* floor (p^(1/power) * 2^32) mod 2^32 *)
  Z.to_int (Z.logand (Z.root (Z.shift_left (Z.of_int p) (32 * power)) power) (Z.of_int mask))

let k = Array.of_list (List.map (fraction_of_root 3) (primes 64))
let start () =
  { state = Array.of_list (List.map (fraction_of_root 2) (primes 8)); block = Bytes.create 64; filled = 0; length = 0 }

let right x n = ((x lsr n) lor (x lsl (32 - n))) land mask
let w = Array.make 64 0

let compress hash =
  for i = 0 to 15 do w.(i) <- Int32.to_int (Bytes.get_int32_be hash.block (4 * i)) land mask done;
  for i = 16 to 63 do
    let x = w.(i - 15) and y = w.(i - 2) in
    let s = right x 7 lxor right x 18 lxor (x lsr 3) and t = right y 17 lxor right y 19 lxor (y lsr 10) in
    w.(i) <- (w.(i - 16) + s + w.(i - 7) + t) land mask
  done;
  let h = Array.copy hash.state in
  for i = 0 to 63 do
    let a = h.(0) and e = h.(4) in
    let s1 = right e 6 lxor right e 11 lxor right e 25 and choice = (e land h.(5)) lxor (lnot e land h.(6)) in
    let t1 = h.(7) + s1 + choice + k.(i) + w.(i) in
    let s0 = right a 2 lxor right a 13 lxor right a 22 in
    let majority = (a land h.(1)) lxor (a land h.(2)) lxor (h.(1) land h.(2)) in
    Array.blit h 0 h 1 7;
    h.(4) <- (h.(4) + t1) land mask;
    h.(0) <- (t1 + s0 + majority) land mask
  done;
  Array.iteri (fun i x -> hash.state.(i) <- (hash.state.(i) + x) land mask) h

let add_byte hash b =
  Bytes.set hash.block hash.filled (Char.chr (b land 255));
  hash.filled <- hash.filled + 1;
  hash.length <- hash.length + 1;
  if hash.filled = 64 then (compress hash; hash.filled <- 0)

let add hash s = String.iter (fun c -> add_byte hash (Char.code c)) s
let add_4 hash x = for i = 0 to 3 do add_byte hash (x lsr (8 * i)) done (* little-endian *)
let add_8 hash x = for i = 0 to 7 do add_byte hash (Int64.to_int (Int64.shift_right_logical x (8 * i))) done

let hex hash =
  let bits = 8 * hash.length in
  add_byte hash 0x80;
  while hash.filled <> 56 do add_byte hash 0 done;
  for i = 7 downto 0 do add_byte hash (bits lsr (8 * i)) done;
  String.concat "" (Array.to_list (Array.map (Printf.sprintf "%08x") hash.state))
