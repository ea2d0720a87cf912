# SPDX-License-Identifier: GPL-3.0-or-later
"""Certificates as lists of records that a test changes: what an accident or an attacker would do."""
import copy
import gzip
import hashlib
import json
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
