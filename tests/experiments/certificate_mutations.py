# SPDX-License-Identifier: GPL-3.0-or-later
"""MUTATIONS: name -> (change of a certificate's records, part of the reason to reject it).
HARMLESS: name -> a change of nothing.

Names with "sealed" carry hashes and counts that fit, so that what is wrong must be found itself; names with "of best"
change the certificate of method best, the others that of limited. A change returns records, texts of lines or bytes."""
import gzip
import json
import math
import random
import re

from certificate_forge import end, header, of, sealed
from certificate_oracle import Oracle

MUTATIONS, HARMLESS = {}, {}


def text_of(records, **style):
    return "".join(json.dumps(r, **style) + "\n" for r in records).encode()


def mutation(name, reason):
    def add(change):
        MUTATIONS[name] = change, reason
        return change
    return add


def harmless(change):
    HARMLESS[change.__name__.replace("_", " ")] = change
    return change


def field(key, path, value, reason, seal=False, name=None, which=3):
    """Sets a field of the record number `which` of those with the key; value may be a function of what stood there."""
    def change(records):
        place = of(records, key) if key != "certificate" else [0]
        target = records[place[min(which, len(place) - 1)]]
        for step in path[:-1]:
            target = target[step]
        target[path[-1]] = value(target[path[-1]]) if callable(value) else value
        return sealed(records) if seal else records
    default = f"{key}: {'.'.join(map(str, path))} = {str(value)[:30]}" + (", sealed" if seal else "")
    MUTATIONS[name or default] = change, reason


def leaves(records):
    return [records[i] for i in of(records, "triangles") if "bv" in records[i]]


def inner(records):
    return [records[i] for i in of(records, "children")]


def lower(by):
    return lambda x: (float.fromhex(x) - by).hex()


# ---- the surface and its BVs -----------------------------------------------------------------------------------------

@mutation("a leaf's triangle doubled, sealed", "in two leaves or twice in one")
def _(records):
    leaves(records)[0]["triangles"].append(leaves(records)[0]["triangles"][0])
    return sealed(records)


@mutation("a leaf's triangle replaced by its neighbour, sealed", "in two leaves or twice in one")
def _(records):
    leaves(records)[0]["triangles"][0] = leaves(records)[0]["triangles"][1]
    return sealed(records)


@mutation("a leaf's triangle replaced by another leaf's, and bounds below its own vertices, sealed",
          "in two leaves or twice in one")
def _(records):
    leaves(records)[-1]["triangles"] = list(leaves(records)[0]["triangles"])
    return sealed(records)


@mutation("a leaf emptied, sealed", "a leaf without triangles")
def _(records):
    leaves(records)[1]["triangles"] = []
    return sealed(records)


@mutation("a leaf shortened, sealed", "triangles")
def _(records):
    leaves(records)[1]["triangles"].pop()
    return sealed(records)


@mutation("a leaf's triangle by its vertices, sealed", "a triangle is [")
def _(records):
    leaves(records)[1]["triangles"][0] = [0, 1, 2]
    return sealed(records)


@mutation("a triangle made degenerate", "SHA-256 of the triangles")
def _(records):
    t = records[of(records, "triangle")[4]]["vertices"]
    t[1] = t[0]
    return records


@mutation("the triangles of a leaf exchanged for another's vertices", "SHA-256 of the triangles")
def _(records):
    a, b = (records[of(records, "triangle")[i]] for i in (4, 20))
    a["vertices"] = b["vertices"]
    return records


@mutation("a triangle left out of mesh and leaf, not sealed", "triangle")
def _(records):
    last = of(records, "triangle")[-1]
    t = records[last]["triangle"]
    for leaf in leaves(records):
        if t in leaf["triangles"]:
            leaf["triangles"].remove(t)
    header(records)["triangles"] -= 1
    return records[:last] + records[last + 1:]


@mutation("a child twice, sealed", "two parents")
def _(records):
    inner(records)[1]["children"][0] = inner(records)[1]["children"][1]
    return sealed(records)


@mutation("a child of another BV, sealed", "two parents")
def _(records):
    inner(records)[1]["children"] = list(inner(records)[2]["children"])
    return sealed(records)


@mutation("children and triangles, sealed", "does not belong here")
def _(records):
    inner(records)[1]["triangles"] = [0]
    return sealed(records)


@mutation("neither children nor triangles, sealed", "is missing")
def _(records):
    del leaves(records)[1]["triangles"]
    return sealed(records)


field("children", ["children", 0], 0, "a child is 0", seal=True)
field("children", ["children", 0], 10**6, "a child is 1000000", seal=True)
field("children", ["children"], [3], "no list of 2", seal=True)
field("triangle", ["vertices", 1], 36, "a vertex is 36", seal=True)
field("triangle", ["vertices"], [0, 1], "no list of 3")
field("triangle", ["vertices", 0], True, "a vertex is True")
field("triangle", ["triangle"], 7, "triangle 7 where 3 should follow", seal=True)
field("rest", ["vertex"], 4, "vertex 4 where 3 should follow", seal=True)
field("rest", ["vertex"], 3.0, "only whole numbers", seal=True)
field("rest", ["rest", 0], lambda x: (float.fromhex(x) + 2.0**-30).hex(), "SHA-256 of the positions",
      name="a rest position moved")
field("rest", ["rest", 0], "0x1.00000000000001p+0", "no hexadecimal float")
field("rest", ["rest", 0], "0x1.0000000000001p-1030", "no hexadecimal float")
field("rest", ["rest", 0], "0x1p-1075", "no hexadecimal float")
field("rest", ["rest", 0], "0x1p+1024", "no hexadecimal float")
field("rest", ["rest", 0], "0x1p999999999", "no hexadecimal float")
field("rest", ["rest", 0], "1e999999999", "no hexadecimal float")
field("rest", ["rest", 0], "0x", "no hexadecimal float")
field("rest", ["rest", 0], "0x1p+0\n", "no hexadecimal float")
field("rest", ["rest", 0], "0x" + "1" * 10**5, "no hexadecimal float", name="a rest position of 100,000 digits")
field("rest", ["rest", 0], "nan", "no hexadecimal float")
field("rest", ["rest", 0], "inf", "no hexadecimal float")
field("rest", ["rest", 0], 1.5, "only whole numbers")
field("rest", ["rest", 0], 1, "no hexadecimal float")
field("rest", ["rest", 0], None, "no hexadecimal float")
field("rest", ["rest"], ["0x1p+0"] * 2, "no list of 3")
field("rest", ["rest"], {"x": "0x1p+0"}, "no list of 3")
field("rest", ["weights", 0], "0x1.0000000000001p-2", "positive multiple of 2^-53", seal=True)
field("rest", ["weights", 0], "-0x1p-2", "positive multiple of 2^-53", seal=True)
field("rest", ["weights", 0], "0x0p+0", "positive multiple of 2^-53", seal=True)
field("rest", ["weights", 0], "0x1.8p+0", "positive multiple of 2^-53", seal=True)
field("rest", ["weights", 0], lambda x: (float.fromhex(x) + math.copysign(2.0**-53, 0.5 - float.fromhex(x))).hex(),
      "do not sum to 1", seal=True, name="a weight moved by 2^-53, sealed")
field("rest", ["nodes", 0], 6, "simulation node", seal=True)
field("rest", ["nodes", 0], -1, "a simulation node is -1", seal=False)
field("rest", ["nodes"], lambda nodes: nodes[::-1], "do not ascend", seal=True,
      name="simulation nodes turned round, sealed")
field("rest", ["nodes"], lambda nodes: [nodes[0]] * len(nodes), "do not ascend", seal=True,
      name="a simulation node twice, sealed")
field("rest", ["nodes"], lambda nodes: nodes[1:], "weights is no list", seal=True,
      name="a simulation node less, sealed")


@mutation("a weight moved to another simulation node", "SHA-256 of the weights")
def _(records):
    weights = next(records[i]["weights"] for i in of(records, "rest") if len(records[i]["weights"]) > 1)
    weights[:2] = (float.fromhex(weights[0]) + 2.0**-40).hex(), (float.fromhex(weights[1]) - 2.0**-40).hex()
    return records


# ---- the header ------------------------------------------------------------------------------------------------------

for key, value, reason in (
    ("certificate", "cinch 1", "the format is"),
    ("certificate", None, "the format is"),
    ("method", "eq12", "SHA-256 of the method"),
    ("method", "limited+limited", "method is"),
    ("method", "vertices", "SHA-256 of the method"),
    ("method", "better", "method is"),
    ("method", ["limited"], "method is"),
    ("method", "", "method is"),
    ("rest_shape", "obb", "SHA-256 of the method"),
    ("rest_shape", {}, "rest_shape is"),
    ("kdop", 7, "kdop is 7"),
    ("kdop", True, "kdop is True"),
    ("kdop", [], "kdop is []"),
    ("kdop", 14, "SHA-256 of the method"),
    ("vertices", 35, "is missing"),
    ("triangles", 0, "triangles is 0"),
    ("nodes", 5, "a simulation node is 5"),
    ("nodes", 7, "no list of 7"),
    ("bvs", 1, "a child is 1"),
    ("bvs", 10**9, "1000000000 BVs over 50 triangles"),
    ("frames", 2, "is missing"),
    ("frames", 4, "is missing"),
    ("frames", -1, "frames is -1"),
    ("frames", "3", "frames is"),
    ("frames", 10**30, "frames is 1000"),
    ("clip", "weak", "SHA-256 of the method"),
    ("clip", 5, "clip is 5"),
    ("partial", True, "partial is True"),
    ("partial", 0, "partial is 0"),
    ("missing", ["x"], "partial is False"),
    ("missing", "x", "no list"),
    ("sha256", {}, "sha256 does not have"),
    ("sha256", None, "sha256 does not have"),
):
    field("certificate", [key], value, reason)
for name in ("positions", "triangles", "weights", "method"):
    field("certificate", ["sha256", name], lambda x: x[::-1], f"SHA-256 of the {name} is another",
          name=f"the SHA-256 of the {name} changed")
field("certificate", ["sha256", "positions"], "A" * 64, "SHA-256 of the positions is")


@mutation("method best without lambdas, not sealed", "SHA-256 of the method")
def _(records):
    header(records)["method"] = "best"
    for i in of(records, "lambda"):
        del records[i]["lambda"]
    return records


@mutation("method best with lambdas, sealed", '"lambda" does not belong here')
def _(records):
    header(records)["method"] = "best"
    return sealed(records)


@mutation("lambdas left out, sealed", '"lambda" is missing')
def _(records):
    for i in of(records, "lambda"):
        del records[i]["lambda"]
    return sealed(records)


@mutation("weight_space turned off", '"weight_space" does not belong here')
def _(records):
    header(records)["weight_space"] = False
    return records


@mutation("a partial certificate made whole", "SHA-256 of the method")
def _(records):
    header(records).update(partial=True, missing=["wheels"])
    records = sealed(records)
    header(records).update(partial=False, missing=[])
    return records


@mutation("a missing key", '"clip" is missing')
def _(records):
    del header(records)["clip"]
    return records


@mutation("no header", "is missing")
def _(records):
    return records[1:]


# ---- frames and bounds -----------------------------------------------------------------------------------------------

field("maps", ["maps", 0, 5], lambda x: (float.fromhex(x) + 2.0**-45).hex(), "", name="a transform changed", which=1)
field("maps", ["time"], "0x1p+3", "SHA-256 of the transforms")
field("maps", ["maps", 0], ["0x1p+0"] * 11, "no list of 12")
field("maps", ["maps"], [], "no list of 6")
field("maps", ["maps", 0, 0], "inf", "no hexadecimal float")
field("maps", ["frame"], 0, "frame 0 where 2 should follow")
for x in ("nan", "-inf", "Infinity", None, 3, "0x1.00000000000001p+9"):
    field("bounds", ["bounds", 2], x, "no hexadecimal float")
field("bounds", ["bounds"], lambda b: b[:-1], "no list of 6", name="a bound less")
field("bounds", ["bounds"], lambda b: b + b[-1:], "no list of 6", name="a bound more")
field("bounds", ["bounds", 3], "inf", "it ends with proven")
field("bounds", ["bounds", 3], lower(1), "beyond the bound", name="a bound lowered far, sealed", seal=True)
field("bounds", ["bounds", 3], lower(1), "beyond the bound", name="a bound of best lowered far", which=20)
for x in ("1/0", "1/-2", "-/3", "1/0x2", "1e999999999/3", "1.5/2", "9" * 2000 + "/7", "٣/4", "inf", "nan", None,
          ["0x1p+0"]):
    field("bounds", ["lambda", 2], x, "", name=f"lambda = {str(x)[:20]}")
field("bounds", ["lambda"], lambda b: b[:-1], "no list of 6", name="a lambda less")
field("bounds", ["lambda", 1], "0x1p+40", "lies below D(lambda)")
field("bounds", ["lambda", 1], "-" + "9" * 300 + "/7", "lies below D(lambda)")


@mutation("bounds between the vertices and D(lambda), sealed", "lies below D(lambda)")
def _(records):
    oracle = Oracle(records)
    r = next(r for r in records if "bounds" in r and r["frame"] == 2)  # of the root
    support, bound = float(oracle.support(2, 0, 0)), float.fromhex(r["bounds"][0])
    assert support < bound - 0.1
    r["bounds"][0] = (support + (bound - support) * 0.5).hex()
    return sealed(records)


@mutation("two BVs' bounds exchanged", "beyond the bound")
def _(records):
    a, b = (records[of(records, "bounds")[i]] for i in (0, -1))
    a["bounds"], b["bounds"] = b["bounds"], a["bounds"]
    return records


def without_frame(records, f):
    kept = [r for r in records if r.get("frame") != f]
    for r in kept:
        if r.get("frame", -1) > f:
            r["frame"] -= 1
    return kept


@mutation("a frame left out consistently", "SHA-256 of the transforms")
def _(records):
    kept = without_frame(records, 1)
    header(kept)["frames"] = end(kept)["frames"] = 2
    end(kept)["proven"] = end(kept)["proven"] // 3 * 2
    return kept


@mutation("the last frame left out, and the end as it was", "it ends with frames 3")
def _(records):
    kept = without_frame(records, 2)
    header(kept)["frames"] = 2
    return kept


@mutation("all frames left out, sealed", "frames is 0")
def _(records):
    return sealed([r for r in records if "frame" not in r])


@mutation("a frame left out", "frame")
def _(records):
    return [r for r in records if r.get("frame") != 1]


@mutation("a frame twice", "is missing")
def _(records):
    first = records[of(records, "maps")[-1]:-1]
    return records[:-1] + first + records[-1:]


def moved(key, which, after_key, after):
    def change(records):
        i = of(records, key)[which]
        record = records.pop(i)
        records.insert(of(records, after_key)[after] + 1, record)
        return records
    return change


for name, change in {
    "a vertex between frames": moved("rest", 3, "bounds", 5),
    "the last vertex after the frames": moved("rest", -1, "bounds", -1),
    "a triangle between frames": moved("triangle", 3, "bounds", 5),
    "a BV after the first frame": moved("children", 0, "maps", 0),
    "a BV's bounds later": moved("bounds", 3, "bounds", 8),
    "two vertices exchanged": moved("rest", 3, "rest", 3),
    "the end before the last frame": moved("end", 0, "maps", 1),
}.items():
    MUTATIONS[name] = change, ""


def inserted(record, place, name, reason):
    def change(records):
        i = place(records)
        return records[:i] + [record if record is not None else records[i - 1]] + records[i:]
    MUTATIONS[name] = change, reason


inserted(None, lambda r: of(r, "rest")[3] + 1, "a vertex twice", "vertex 3 where 4 should follow")
inserted(None, lambda r: of(r, "bounds")[3] + 1, "bounds twice", "should follow")
inserted({}, lambda r: 5, "an empty record", "is missing")
inserted({"x": 1}, lambda r: 5, "an unknown record", "is missing")
inserted({"vertex": 36, "rest": ["0x1p+0"] * 3, "nodes": [0], "weights": ["0x1p+0"]}, lambda r: of(r, "maps")[1],
         "a new vertex between frames", "")
inserted({}, len, "an empty record after the end", "something follows the end")
inserted(None, len, "the end twice", "does not belong here")
def without(key, which):
    return lambda records: [r for i, r in enumerate(records) if i != (of(records, key) * 11)[which]]


for which, name in ((0, "first"), (10, "eleventh"), (-1, "last")):
    for key in ("rest", "triangle", "bv", "maps", "bounds"):
        MUTATIONS[f"without the {name} record with {key}"] = without(key, which), ""


# ---- the end ---------------------------------------------------------------------------------------------------------

MUTATIONS["no end"] = (lambda records: records[:-1]), "the file ends where the end should follow"
for key, value, reason in (
    ("end", True, "the end is that of"),
    ("frames", 2, "it ends with frames"),
    ("proven", 1, "it ends with proven"),
    ("infinite", 1, "it ends with infinite"),
    ("infinite", False, "it ends with infinite"),
    ("violated", 1, "bounds violated"),
    ("violated", -1, "violated is -1"),
    ("sha256", {"transforms": "0" * 64}, "SHA-256 of the transforms"),
):
    field("end", [key], value, reason)


# ---- the text --------------------------------------------------------------------------------------------------------

def line_changed(name, reason, change, which=7):
    def of_records(records):
        lines = [json.dumps(r) for r in records]
        lines[which] = change(lines[which])
        return lines
    MUTATIONS[name] = of_records, reason


line_changed("a key twice, the same", 'the key "vertex" stands twice', lambda s: s.replace("{", '{"vertex": 6, ', 1))
line_changed("a key twice in the header, the first one wrong", 'the key "method" stands twice',
             lambda s: s.replace("{", '{"method": "vertices", ', 1), 0)
line_changed("a key twice in a hash", 'the key "positions" stands twice',
             lambda s: s.replace('"sha256": {', '"sha256": {"positions": "", '), 0)
line_changed("a key twice, spelt in two ways", 'the key "bounds" stands twice',
             lambda s: s.replace("{", '{"\\u0062ounds": [], ', 1), -2)
line_changed("an array", "no JSON object", lambda s: f"[{s}]")
line_changed("a comma too many", "not JSON", lambda s: s.replace("}", ",}"))
line_changed("NaN as a number", "only whole numbers", lambda s: s.replace('"vertex": 6', '"vertex": NaN'))
line_changed("a number of 5,000 digits", "not JSON", lambda s: s.replace('"vertex": 6', '"vertex": ' + "6" * 5000))
line_changed("two records on a line", "not JSON", lambda s: s + s)
line_changed("nested deeply", "nested too deeply", lambda s: "[" * 200000)
line_changed("nested deeply within", "nested too deeply",
             lambda s: s.replace('"vertex": 6', '"vertex": ' + '{"a":' * 100000))
line_changed("a tab in a key", "not JSON", lambda s: s.replace("vertex", "ver\tex"))
line_changed("half a line", "not JSON", lambda s: s[:len(s) // 2])
MUTATIONS["not UTF-8"] = (lambda records: text_of(records).replace(b"vertex", b"\xff\xfe", 1)), "not UTF-8"
MUTATIONS["UTF-16"] = (lambda records: text_of(records).decode().encode("utf-16")), "not UTF-8"
MUTATIONS["a byte order mark"] = (lambda records: b"\xef\xbb\xbf" + text_of(records)), "not JSON"
MUTATIONS["zero bytes"] = (lambda records: b"\0" * 100), "not JSON"
MUTATIONS["an empty file"] = (lambda records: b""), "the file ends where a header should follow"
MUTATIONS["the header alone"] = (lambda records: text_of(records[:1])), "the file ends where vertex 0 should follow"
MUTATIONS["cut in the middle"] = (lambda records: text_of(records)[:len(text_of(records)) // 2]), ""
for name, damage, reason in (
    ("cut in the middle", lambda data: data[:-500], "not readable"),
    ("cut before its last bytes", lambda data: data[:-3], "not readable"),
    ("with a wrong sum", lambda data: data[:-8] + b"\1\2\3\4" + data[-4:], "not readable"),
    ("and more behind", lambda data: data + b"more", "not readable"),
    ("no more than its first bytes", lambda data: data[:2], "not readable"),
    ("a damaged block", lambda data: data[:40] + b"\xff" * 40 + data[80:], ""),
):
    MUTATIONS[f"gzip, {name}"] = (lambda records, damage=damage: damage(gzip.compress(text_of(records)))), reason


# ---- what changes nothing --------------------------------------------------------------------------------------------

@harmless
def order_of_keys(records):
    rng = random.Random(3)
    return [dict(rng.sample(list(r.items()), len(r))) for r in records]


@harmless
def spaces_and_empty_lines(records):
    return b"\n" + text_of(records, separators=("  ,\t", " :  ")).replace(b"\n", b" \r\n\n  \n")


@harmless
def no_spaces_and_no_last_line_end(records):
    return text_of(records, separators=(",", ":"))[:-1]


@harmless
def compression_by_gzip(records):
    return text_of(records)


@harmless
def compression_by_gzip_in_two_parts(records):
    data = text_of(records)
    return gzip.compress(data[:1000], 9) + gzip.compress(data[1000:], 1)


@harmless
def escapes(records):
    return text_of(records).replace(b'"vertex"', b'"\\u0076ertex"').replace(b'"0x', b'"\\u0030x')


def respelt(spell):
    def change(records):
        return [re.sub(r'"(-?)0x([0-9a-f.]+)p([+-]\d+)"', lambda m: f'"{spell(m[0][1:-1])}"', json.dumps(r))
                for r in records]
    return change


HARMLESS["doubles with all their digits"] = respelt(lambda x: float.fromhex(x).hex())
HARMLESS["doubles in capitals"] = respelt(str.upper)
HARMLESS["doubles with more zeros"] = respelt(
    lambda x: x.replace("0x", "0x000").replace("p", "0000p" if "." in x else ".0000p"))
@respelt
def as_a_whole_number(x):
    p, q = float.fromhex(x).as_integer_ratio()
    return f"{'-' if x[0] == '-' else ''}0x{abs(p):x}p{1 - q.bit_length()}"


HARMLESS["doubles as whole numbers"] = as_a_whole_number


@harmless
def lambdas_as_ratios(records):
    for i in of(records, "lambda"):
        records[i]["lambda"] = [x if "/" in x else "{}/{}".format(*(7 * n for n in float.fromhex(x).as_integer_ratio()))
                                for x in records[i]["lambda"]]
    return records


@harmless
def higher_bounds(records):
    for i in of(records, "bounds"):
        records[i]["bounds"] = [lower(-0.25)(x) for x in records[i]["bounds"]]
    return records
