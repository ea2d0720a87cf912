(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* cinch-check [CERTIFICATE]: from a file or standard input, not compressed. Status 0 accepted, 1 rejected, 2 usage. *)
let usage =
  "usage: cinch-check [CERTIFICATE]\n\nA file, not compressed, or standard input: zcat c.jsonl.gz | cinch-check"
let longest_line = 1 lsl 28

let reason why =
  match why with
  | Checker.WrongOrder -> "a record where another should follow, or too few or too many of them"
  | BadHeader -> "a header with an unknown kdop or with counts that cannot be"
  | BadVertex -> "a vertex whose weights are not convex multiples of 2^-53 over ascending simulation nodes"
  | BadTriangle -> "a triangle with a vertex that does not exist"
  | BadBv -> "a leaf without triangles, or a child that does not come later"
  | BadTree -> "no tree that holds every BV and every triangle once"
  | BadFrame -> "transforms that are not as many as simulation nodes"
  | BadClaim -> "bounds or lambdas that are not as many as directions, or lambdas where the method has none"
  | BoundBelowVertex -> "a vertex lies beyond a bound"
  | BoundBelowDual -> "a bound lies below D(lambda)"
  | BadEnd -> "the end states other counts, or bounds that are violated"

let is_blank line = String.for_all (function ' ' | '\t' | '\r' | '\011' | '\012' -> true | _ -> false) line

(* The fold of Checker.run over the lines, as they come *)
let check input =
  let hashes = Reader.start () in
  let state = ref Checker.Start and number = ref 0 and last = ref None in
  let refuse why = Printf.ksprintf (fun s -> Error (Printf.sprintf "line %d: %s" !number s)) "%s" why in
  let rec next () =
    match input_line input with
    | exception End_of_file ->
      incr number;
      if !state = Checker.Done then Ok (hashes, !last) else refuse "the file ends before the last record"
    | line ->
      incr number;
      if String.length line >= longest_line then refuse "a line that is too long"
      else if is_blank line then next ()
      else if !number = 1 && String.length line > 1 && String.sub line 0 2 = "\x1f\x8b" then
        refuse "compressed (zcat unpacks it)"
      else begin
        let record = Reader.line hashes (Json.parse line) in
        (match record with Checker.LEnd e -> last := Some e | _ -> ());
        match Checker.step !state record with
        | Checker.Next s -> state := s; next ()
        | Rejected why -> refuse (reason why)
      end
  in
  try next () with
  | Json.Refused why -> refuse why
  | Stack_overflow -> refuse "it takes more stack than there is"
  | Out_of_memory -> refuse "it takes more memory than there is"
  | Sys_error why -> refuse ("not readable: " ^ why)
  | other -> refuse ("not understood: " ^ Printexc.to_string other)

let () =
  let name, input =
    match Array.to_list Sys.argv with
    | [ _ ] -> "standard input", stdin
    | [ _; name ] when name = "" || name.[0] <> '-' ->
      ( name,
        try open_in_bin name
        with Sys_error why ->
          print_endline (name ^ ": rejected: not readable: " ^ why);
          exit 1 )
    | [ _; "--help" ] -> print_endline usage; exit 0
    | _ -> prerr_endline usage; exit 2
  in
  Gc.set { (Gc.get ()) with minor_heap_size = 1 lsl 20; space_overhead = 200 };
  set_binary_mode_in input true;
  match check input with
  | Ok (hashes, Some e) ->
    let missing = String.concat ", " (List.map (Printf.sprintf "%S") hashes.Reader.missing) in
    Printf.printf "%s: accepted: %s%s bounds proven, %s infinite\n" name
      (if missing = "" then "" else Printf.sprintf "partial (missing: %s): " missing)
      (Z.to_string e.Checker.proven_said) (Z.to_string e.Checker.infinite_said)
  | Ok (_, None) -> assert false
  | Error why -> Printf.printf "%s: rejected: %s\n" name why; exit 1
