# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes of frames, bounds, their order and the end."""
from certificate_forge import end, header, of, sealed
from certificate_mutations import MUTATIONS, field, lower, mutation
from certificate_oracle import Oracle


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
