# SPDX-License-Identifier: GPL-3.0-or-later
"""Certificates as lists of records that a test changes: what an accident or an attacker would do."""
import copy
import gzip
import hashlib
import json
import math
import os
import struct


def doubles(texts):
    return struct.pack(f"<{len(texts)}d", *map(float.fromhex, texts))


def in_utf8(text):
    """Of texts that JSON can spell and UTF-8 cannot, too."""
    return text.encode("utf-8", "surrogatepass")


def header(records):
    return records[0]


def end(records):
    return records[-1]


def of(records, key):
    """Places of the records that have a key."""
    return [i for i, r in enumerate(records) if key in r and "certificate" not in r]


def sealed(records):
    """With counts and hashes that fit, as who changes it on purpose would write them."""
    records = copy.deepcopy(records)
    vertices, triangles, frames, bounds = (of(records, key) for key in ("rest", "triangle", "maps", "bounds"))
    first, last = header(records), end(records)
    sha = {name: hashlib.sha256() for name in ("positions", "weights", "triangles", "method", "transforms")}
    for i in vertices:
        r = records[i]
        sha["positions"].update(doubles(r["rest"]))
        sha["weights"].update(struct.pack(f"<I{len(r['nodes'])}I", len(r["nodes"]), *r["nodes"])
                              + doubles(r["weights"]))
    for i in triangles:
        sha["triangles"].update(struct.pack("<3I", *records[i]["vertices"]))
    for i in frames:
        sha["transforms"].update(doubles([records[i]["time"]]) + b"".join(map(doubles, records[i]["maps"]))
                                 + doubles(records[i].get("morphs", [])))
    targets = of(records, "target")
    if targets:
        sha["targets"] = hashlib.sha256()
        for i in targets:
            n = len(records[i]["vertices"])
            sha["targets"].update(struct.pack(f"<I{n}I", n, *records[i]["vertices"])
                                  + b"".join(map(doubles, records[i]["displacements"])))
        first["targets"] = len(targets)
    for part in ("cinch 2", first["method"], first["rest_shape"], str(first["kdop"]), first["clip"], *first["missing"]):
        sha["method"].update(b"%d:%b" % (len(in_utf8(part)), in_utf8(part)))
    bvs = [i for i in of(records, "bv") if "bounds" not in records[i]]
    first.update(vertices=len(vertices), triangles=len(triangles), frames=len(frames), bvs=len(bvs))
    first["sha256"] = {name: sha[name].hexdigest() for name in sha if name != "transforms"}
    infinite = sum(records[i]["bounds"].count("inf") for i in bounds)
    proven = sum(len(records[i]["bounds"]) for i in bounds) - infinite
    last.update(frames=len(frames), infinite=infinite, proven=proven, violated=0)
    last["sha256"] = {"transforms": sha["transforms"].hexdigest()}
    return records


def written(folder, lines, name="changed.jsonl"):
    """A file of records, of texts, or of bytes as they are."""
    path = os.path.join(folder, name)
    if isinstance(lines, bytes):
        data = lines
    else:
        data = in_utf8("".join((line if isinstance(line, str) else json.dumps(line)) + "\n" for line in lines))
        if name.endswith(".gz"):
            data = gzip.compress(data)
    with open(path, "wb") as file:
        file.write(data)
    return path


def edited(records, rng):
    """One edit at random: of a value anywhere, or of the list of records."""
    i = rng.randrange(len(records))
    kind = rng.randrange(10)
    if kind == 0:
        del records[i]
    elif kind == 1:
        records.insert(rng.randrange(len(records)), copy.deepcopy(records[i]))
    elif kind == 2:
        j = rng.randrange(len(records))
        records[i], records[j] = records[j], records[i]
    else:
        where, key = records[i], rng.choice(list(records[i]))
        while isinstance(where[key], (list, dict)) and where[key] and rng.random() < 0.9:
            where = where[key]
            key = rng.randrange(len(where)) if isinstance(where, list) else rng.choice(list(where))
        value = where[key]
        if isinstance(value, str) and "0x" in value:
            x = float.fromhex(value)
            where[key] = rng.choice((x * (1 + 2.0**-20), x * (1 - 2.0**-20), x + 1, x - 1, -x, x * 1e200, x * 1e-200,
                                     x * 1e-300, 0.0, -0.0, math.inf)).hex()
        elif isinstance(value, list) and value:
            rng.choice((value.pop, value.reverse, lambda: value.append(value[0])))()
        elif isinstance(value, int):
            where[key] = value + rng.choice((-1, 1, 7))
        else:
            where[key] = rng.choice((None, 0, "", [], "best", "obb", "0x1p+0"))
