(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* One line of JSON (RFC 8259) as a value. Numbers are whole; keys of an object stand once. *)
type t =
  | Object of (string * t) list
  | List of t list
  | Text of string
  | Number of Z.t
  | Truth of bool
  | Null

exception Refused of string

let refuse format = Printf.ksprintf (fun reason -> raise (Refused reason)) format
let deepest = 50
let most_digits = 4300

(* UTF-8 of one character, or of half a surrogate pair *)
let add_utf_8 out c =
  let byte b = Buffer.add_char out (Char.chr b) in
  let rest shift = byte (0x80 lor ((c lsr shift) land 0x3f)) in
  if c < 0x80 then byte c
  else if c < 0x800 then (byte (0xc0 lor (c lsr 6)); rest 0)
  else if c < 0x10000 then (byte (0xe0 lor (c lsr 12)); rest 6; rest 0)
  else (byte (0xf0 lor (c lsr 18)); rest 12; rest 6; rest 0)

let check_utf_8 s =
  let n = String.length s in
  let byte i = if i < n then Char.code s.[i] else 0 in
  let rec go i =
    if i < n then begin
      let tail k = byte (i + k) land 0xc0 = 0x80 in
      let b = byte i and c = byte (i + 1) in
      if b < 0x80 then go (i + 1)
      else if b >= 0xc2 && b < 0xe0 && tail 1 then go (i + 2)
      else if b land 0xf0 = 0xe0 && tail 1 && tail 2 && (b <> 0xe0 || c >= 0xa0) && (b <> 0xed || c < 0xa0) then
        go (i + 3)
      else if
        b >= 0xf0 && b <= 0xf4 && tail 1 && tail 2 && tail 3 && (b <> 0xf0 || c >= 0x90) && (b <> 0xf4 || c < 0x90)
      then go (i + 4)
      else refuse "not UTF-8"
    end
  in
  go 0

let parse s =
  check_utf_8 s;
  let n = String.length s in
  let at = ref 0 in
  let fail () = refuse "not JSON: byte %d" !at in
  let peek () = if !at < n then String.unsafe_get s !at else '\000' in
  let rec blanks () =
    match peek () with ' ' | '\t' | '\n' | '\r' when !at < n -> incr at; blanks () | _ -> ()
  in
  let expect c = if !at < n && peek () = c then incr at else fail () in
  let hex_4 () =
    if !at + 4 > n then fail ();
    let digit c =
      match c with
      | '0' .. '9' -> Char.code c - 48
      | 'a' .. 'f' -> Char.code c - 87
      | 'A' .. 'F' -> Char.code c - 55
      | _ -> fail ()
    in
    let value = ref 0 in
    for _ = 1 to 4 do value := (16 * !value) + digit (peek ()); incr at done;
    !value
  in
  let escape out =
    let c = peek () in
    incr at;
    match c with
    | '"' | '\\' | '/' -> Buffer.add_char out c
    | 'b' -> Buffer.add_char out '\b'
    | 'f' -> Buffer.add_char out '\012'
    | 'n' -> Buffer.add_char out '\n'
    | 'r' -> Buffer.add_char out '\r'
    | 't' -> Buffer.add_char out '\t'
    | 'u' ->
      let first = hex_4 () in
      let before = !at in
      if first land 0xfc00 = 0xd800 && !at + 6 <= n && s.[!at] = '\\' && s.[!at + 1] = 'u' then begin
        at := !at + 2;
        let second = hex_4 () in
        if second land 0xfc00 = 0xdc00 then
          add_utf_8 out (0x10000 + ((first land 0x3ff) lsl 10) + (second land 0x3ff))
        else (at := before; add_utf_8 out first)
      end
      else add_utf_8 out first
    | _ -> fail ()
  in
  let text () =
    expect '"';
    let first = !at in
    let rec plain () =
      if !at >= n then fail ();
      match String.unsafe_get s !at with
      | '"' | '\\' | '\000' .. '\031' -> ()
      | _ -> incr at; plain ()
    in
    plain ();
    if peek () = '"' then (incr at; String.sub s first (!at - 1 - first))
    else begin
      let out = Buffer.create 64 in
      Buffer.add_substring out s first (!at - first);
      let rec more () =
        if !at >= n then fail ();
        match peek () with
        | '"' -> incr at
        | '\\' -> incr at; escape out; more ()
        | '\000' .. '\031' -> fail ()
        | c -> Buffer.add_char out c; incr at; more ()
      in
      more ();
      Buffer.contents out
    end
  in
  let number () =
    let first = !at in
    if peek () = '-' then incr at;
    let digits = !at in
    while (match peek () with '0' .. '9' -> true | _ -> false) do incr at done;
    let count = !at - digits in
    if count = 0 || (count > 1 && s.[digits] = '0') then fail ();
    (match peek () with
     | '.' | 'e' | 'E' -> refuse "a number that is not written as a whole number"
     | _ -> ());
    if count > most_digits then refuse "not JSON: a number of %d digits" count;
    if count <= 18 then Z.of_int (int_of_string (String.sub s first (!at - first)))
    else Z.of_string (String.sub s first (!at - first))
  in
  let word w value =
    let l = String.length w in
    if !at + l <= n && String.sub s !at l = w then (at := !at + l; value) else fail ()
  in
  let rec value depth =
    if depth > deepest then refuse "nested too deeply";
    blanks ();
    match peek () with
    | '{' -> incr at; Object (members depth)
    | '[' -> incr at; List (items depth)
    | '"' -> Text (text ())
    | '-' | '0' .. '9' -> Number (number ())
    | 't' -> word "true" (Truth true)
    | 'f' -> word "false" (Truth false)
    | 'n' -> word "null" Null
    | _ -> fail ()
  and items depth =
    blanks ();
    if peek () = ']' then (incr at; [])
    else
      let rec more out =
        let out = value (depth + 1) :: out in
        blanks ();
        match peek () with
        | ',' -> incr at; more out
        | ']' -> incr at; List.rev out
        | _ -> fail ()
      in
      more []
  and members depth =
    blanks ();
    if peek () = '}' then (incr at; [])
    else
      let rec more out =
        blanks ();
        let name = text () in
        if List.mem_assoc name out then refuse "the key %S stands twice" name;
        blanks ();
        expect ':';
        let out = (name, value (depth + 1)) :: out in
        blanks ();
        match peek () with
        | ',' -> incr at; more out
        | '}' -> incr at; List.rev out
        | _ -> fail ()
      in
      more []
  in
  let result = value 0 in
  blanks ();
  if !at < n then fail ();
  result
