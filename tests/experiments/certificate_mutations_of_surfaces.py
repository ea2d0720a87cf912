# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes of the surface, its BVs and the header."""
import math

from certificate_forge import header, of, sealed
from certificate_mutations import field, inner, leaves, mutation


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
