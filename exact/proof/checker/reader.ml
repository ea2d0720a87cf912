(* SPDX-License-Identifier: GPL-3.0-or-later *)
(* Lines of a certificate as the checker's, and the hashes of what they hold. *)
open Json

(* From the first to the last, which hashes depend on; lists may be long. *)
let map f l = List.rev (List.rev_map f l)

let format = "cinch 2"

type hashes = {
  positions : Sha256.t;
  triangles : Sha256.t;
  weights : Sha256.t;
  transforms : Sha256.t;
  mutable stated : (string * string) list;
  mutable missing : string list;
}

let start () =
  { positions = Sha256.start (); triangles = Sha256.start (); weights = Sha256.start (); transforms = Sha256.start ();
    stated = []; missing = [] }

let agree hashes what found =
  if List.assoc what hashes.stated <> Sha256.hex found then refuse "the SHA-256 of the %s is another than stated" what

(* ---- Shapes ---- *)

let whole value = match value with Number n -> n | _ -> refuse "something that is no whole number"
let text value = match value with Text s -> s | _ -> refuse "something that is no text"
let list value = match value with List l -> l | _ -> refuse "something that is no list"

(* The values of these keys, in their order; there are no others. *)
let fields names members =
  List.iter
    (fun (name, _) -> if not (List.mem name names) then refuse "%S does not belong here" name)
    members;
  List.map
    (fun name -> match List.assoc_opt name members with Some v -> v | None -> refuse "%S is missing" name)
    names

let sha256 names value =
  match value with
  | Object members ->
    let hash v =
      let s = text v in
      let is_digit c = match c with '0' .. '9' | 'a' .. 'f' -> true | _ -> false in
      if String.length s <> 64 || not (List.for_all is_digit (List.of_seq (String.to_seq s))) then
        refuse "a SHA-256 that is none";
      s
    in
    List.combine names (map hash (fields names members))
  | _ -> refuse "sha256 is no object"

(* ---- The header ---- *)

let method_of name =
  match name with
  | "convex" -> Checker.Convex
  | "sphere" -> Sphere
  | "corners" -> Corners
  | "eq12" -> Eq12
  | "limited" -> Limited
  | "local" -> Local
  | "support" -> Support
  | "linear" -> Linear
  | "moments" -> Moments
  | "best" -> Best
  | "vertices" -> Vertices
  | _ -> refuse "an unknown method"

let header hashes members =
  match
    fields
      [ "certificate"; "method"; "rest_shape"; "kdop"; "vertices"; "triangles"; "nodes"; "bvs"; "frames"; "clip";
        "partial"; "missing"; "sha256" ]
      members
  with
  | [ certificate; methods; shape; kdop; vertices; triangles; nodes; bvs; frames; clip; partial; missing; sha ] ->
    if certificate <> Text format then refuse "the format is not %S" format;
    let names = String.split_on_char '+' (text methods) in
    if List.length (List.sort_uniq compare names) <> List.length names then refuse "a method twice";
    if text shape <> "aabb" && text shape <> "obb" then refuse "rest_shape is unknown";
    let missing = map text (list missing) in
    if partial <> Truth (missing <> []) then refuse "partial does not fit to what is missing";
    hashes.missing <- missing;
    hashes.stated <- sha256 [ "positions"; "triangles"; "weights"; "method" ] sha;
    let found = Sha256.start () in
    List.iter
      (fun part -> Sha256.add found (Printf.sprintf "%d:%s" (String.length part) part))
      ([ format; text methods; text shape; Z.to_string (whole kdop); text clip ] @ missing);
    agree hashes "method" found;
    Checker.LHeader
      { methods = map method_of names; oriented = text shape = "obb"; kdop = whole kdop;
        vertex_count = whole vertices; triangle_count = whole triangles; node_count = whole nodes;
        bv_count = whole bvs; frame_count = whole frames }
  | _ -> assert false

(* ---- The surface ---- *)

let number hash value =
  let x = Number.of_json value in
  Sha256.add_8 hash (Number.bits x);
  Number.dyadic x

let index hash value =
  let n = whole value in
  if Z.sign n < 0 || Z.numbits n > 32 then refuse "%s is no index" (Z.to_string n);
  Sha256.add_4 hash (Z.to_int n);
  n

let vertex hashes i rest nodes weights =
  let rest =
    match map (number hashes.positions) (list rest) with
    | [ px; py; pz ] -> { Checker.px; py; pz }
    | _ -> refuse "rest is no list of 3"
  in
  let nodes = list nodes and weights = list weights in
  if List.length nodes <> List.length weights then refuse "weights is no list of %d" (List.length nodes);
  Sha256.add_4 hashes.weights (List.length nodes);
  let nodes = map (index hashes.weights) nodes in
  let weights = map (number hashes.weights) weights in
  Checker.LVertex (whole i, { rest; influences = List.combine nodes weights })

let triangle hashes i vertices =
  match map (index hashes.triangles) (list vertices) with
  | [ corner_a; corner_b; corner_c ] -> Checker.LTriangle (whole i, { corner_a; corner_b; corner_c })
  | _ -> refuse "vertices is no list of 3"

(* ---- Frames ---- *)

let affine hash value =
  let numbers = map (number hash) (list value) in
  match numbers with
  | [ a; b; c; d; e; f; g; h; i; k; l; m ] ->
    { Checker.row_x = { ra = a; rb = b; rc = c; rt = d }; row_y = { ra = e; rb = f; rc = g; rt = h };
      row_z = { ra = i; rb = k; rc = l; rt = m } }
  | _ -> refuse "a transform is no list of 12"

let frame hashes i time maps =
  let time = number hashes.transforms time in
  Checker.LFrame (whole i, time, map (affine hashes.transforms) (list maps))

let bound value = match value with Text "inf" -> None | _ -> Some (Number.dyadic (Number.of_json value))

let claim frame i bounds lambdas =
  Checker.LClaim
    ( whole frame, whole i,
      { bounds = map bound (list bounds);
        lambdas = Option.map (fun l -> map Number.multiplier (list l)) lambdas } )

let ending hashes members =
  match fields [ "end"; "frames"; "proven"; "infinite"; "violated"; "sha256" ] members with
  | [ format_of_end; frames; proven; infinite; violated; sha ] ->
    if format_of_end <> Text format then refuse "the end is not that of %S" format;
    if hashes.stated = [] then refuse "an end without a header";
    hashes.stated <- sha256 [ "transforms" ] sha @ hashes.stated;
    agree hashes "positions" hashes.positions;
    agree hashes "triangles" hashes.triangles;
    agree hashes "weights" hashes.weights;
    agree hashes "transforms" hashes.transforms;
    Checker.LEnd
      { frames_said = whole frames; proven_said = whole proven; infinite_said = whole infinite;
        violated_said = whole violated }
  | _ -> assert false

let line hashes value =
  match value with
  | Object members ->
    let has name = List.mem_assoc name members in
    let get names make = make (fields names members) in
    let wrong () = assert false in
    if has "certificate" then
      if List.assoc "certificate" members = Text "cinch times 2" then refuse "not of this checker: bounds over time"
      else if has "targets" then refuse "not of this checker: morph targets"
      else header hashes members
    else if has "vertex" then
      get [ "vertex"; "rest"; "nodes"; "weights" ] (function [ i; r; n; w ] -> vertex hashes i r n w | _ -> wrong ())
    else if has "triangle" then
      get [ "triangle"; "vertices" ] (function [ i; v ] -> triangle hashes i v | _ -> wrong ())
    else if has "maps" then
      get [ "frame"; "time"; "maps" ] (function [ i; t; m ] -> frame hashes i t m | _ -> wrong ())
    else if has "lambda" then
      get [ "frame"; "bv"; "bounds"; "lambda" ] (function [ f; i; b; l ] -> claim f i b (Some l) | _ -> wrong ())
    else if has "bounds" then
      get [ "frame"; "bv"; "bounds" ] (function [ f; i; b ] -> claim f i b None | _ -> wrong ())
    else if has "children" then
      get [ "bv"; "children" ]
        (function
          | [ i; c ] ->
            (match map whole (list c) with
             | [ left; right ] -> Checker.LBv (whole i, Inner (left, right))
             | _ -> refuse "children is no list of 2")
          | _ -> wrong ())
    else if has "triangles" then
      get [ "bv"; "triangles" ]
        (function [ i; t ] -> Checker.LBv (whole i, Leaf (map whole (list t))) | _ -> wrong ())
    else ending hashes members
  | _ -> refuse "no JSON object"
