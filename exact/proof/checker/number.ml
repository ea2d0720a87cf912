(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* Texts of hexadecimal floats and ratios, read exactly. That their values are doubles the checker sees to. *)
open Json

(* (-1)^negative * significand * 2^exponent, the significand odd or 0 *)
type t = { negative : bool; significand : Z.t; exponent : int }

let digit c =
  match c with
  | '0' .. '9' -> Char.code c - 48
  | 'a' .. 'f' -> Char.code c - 87
  | 'A' .. 'F' -> Char.code c - 55
  | _ -> -1

let no_float s =
  refuse "%s is no hexadecimal float whose value is a double"
    (if String.length s < 60 then Printf.sprintf "%S" s else "a long text")

(* [+-]? 0x digits* .? digits* (p [+-]? 1 to 6 decimal digits)?, a digit at least *)
let of_text s =
  let n = String.length s in
  if n >= 1200 then no_float s;
  let at = ref 0 in
  let peek () = if !at < n then s.[!at] else '\000' in
  let sign () =
    match peek () with
    | '-' -> incr at; true
    | '+' -> incr at; false
    | _ -> false
  in
  let negative = sign () in
  if not (peek () = '0' && !at + 1 < n && (s.[!at + 1] = 'x' || s.[!at + 1] = 'X')) then no_float s;
  at := !at + 2;
  let big = ref Z.zero and small = ref 0 and pending = ref 0 and digits = ref 0 in
  let flush () =
    big := Z.add (Z.shift_left !big (4 * !pending)) (Z.of_int !small);
    small := 0;
    pending := 0
  in
  let hex_digits () =
    let first = !at in
    while digit (peek ()) >= 0 do
      if !pending = 15 then flush ();
      small := (16 * !small) + digit (peek ());
      incr pending;
      incr at
    done;
    digits := !digits + (!at - first);
    !at - first
  in
  ignore (hex_digits ());
  let after_point = if peek () = '.' then (incr at; hex_digits ()) else 0 in
  if !digits = 0 then no_float s;
  flush ();
  let exponent =
    if peek () = 'p' || peek () = 'P' then begin
      incr at;
      let minus = sign () in
      let first = !at in
      let value = ref 0 in
      while (match peek () with '0' .. '9' -> true | _ -> false) do
        if !at - first >= 6 then no_float s;
        value := (10 * !value) + digit (peek ());
        incr at
      done;
      if !at = first then no_float s;
      if minus then - !value else !value
    end
    else 0
  in
  if !at < n then no_float s;
  if Z.equal !big Z.zero then { negative; significand = Z.zero; exponent = 0 }
  else
    let zeros = Z.trailing_zeros !big in
    let significand = Z.shift_right !big zeros and exponent = exponent - (4 * after_point) + zeros in
    if Z.numbits significand > 53 || exponent < -1074 || exponent + Z.numbits significand > 1024 then no_float s;
    { negative; significand; exponent }

let of_json value = match value with Text s -> of_text s | _ -> refuse "a number that is no hexadecimal float"

let dyadic x =
  { Checker.man = (if x.negative then Z.neg x.significand else x.significand); exn = Z.of_int x.exponent }

(* The bits of the double, for hashes *)
let bits x =
  let sign = if x.negative then Int64.min_int else 0L in
  if Z.equal x.significand Z.zero then sign
  else
    let n = Z.numbits x.significand in
    let top = x.exponent + n - 1 in
    let magnitude =
      if top >= -1022 then
        Z.add (Z.shift_left (Z.of_int (top + 1022)) 52) (Z.shift_left x.significand (53 - n))
      else Z.shift_left x.significand (x.exponent + 1074)
    in
    Int64.logor sign (Z.to_int64 magnitude)

(* -?digits/digits, up to 1500 each, or a float *)
let multiplier value =
  match value with
  | Text s when String.contains s '/' ->
    let slash = String.index s '/' in
    let part first last minus =
      let from = if minus && last > first && s.[first] = '-' then first + 1 else first in
      if last - from < 1 || last - from > 1500 then refuse "a lambda that is neither a float nor a ratio";
      for i = from to last - 1 do
        if s.[i] < '0' || s.[i] > '9' then refuse "a lambda that is neither a float nor a ratio"
      done;
      Z.of_string (String.sub s first (last - first))
    in
    Checker.Ratio (part 0 slash true, part (slash + 1) (String.length s) false)
  | _ -> Checker.Double (dyadic (of_json value))
