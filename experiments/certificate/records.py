# SPDX-License-Identifier: GPL-3.0-or-later
"""The lines of a certificate as records, and its header."""
import hashlib
import json
import re

from certificate.values import Rejected, listed, plain, require, shown, text, whole, MOST_INDEX

FORMAT = "cinch 2"
FACES = [(1, 0, 0), (0, 1, 0), (0, 0, 1)]
CORNERS = [(1, 1, 1), (1, 1, -1), (1, -1, 1), (1, -1, -1)]
EDGES = [(1, 1, 0), (1, 0, 1), (0, 1, 1), (1, -1, 0), (1, 0, -1), (0, 1, -1)]
AXES = {6: FACES, 14: FACES + CORNERS, 18: FACES + EDGES, 26: FACES + CORNERS + EDGES}
METHODS = ("convex", "sphere", "corners", "eq12", "limited", "local", "support", "linear", "moments", "best",
           "vertices")
BOX_METHODS = {"convex", "corners", "eq12", "limited"}
LONGEST_LINE = 1 << 28  # bytes; a record holds one BV or the transforms of one frame
HASHES = {"positions", "triangles", "weights", "method"}
HEADER = {"certificate", "method", "rest_shape", "kdop", "vertices", "triangles", "nodes", "bvs", "frames", "clip",
          "partial", "missing", "sha256"}
DISPLACED_HEADER = HEADER | {"targets"}


def unique(pairs):
    record = dict(pairs)
    if len(record) < len(pairs):
        names = [name for name, _ in pairs]
        raise Rejected(f"the key {shown(next(name for name in names if names.count(name) > 1))} stands twice")
    return record


def no_number(value):
    raise Rejected(f"the number {shown(value)}, where only whole numbers are written as numbers")


DECODE = json.JSONDecoder(object_pairs_hook=unique, parse_float=no_number, parse_constant=no_number).decode


class Records:
    """The records of a certificate, one after the other; knows the line."""

    def __init__(self, stream):
        self.stream, self.line = stream, 0

    def next(self, *keys_of):
        """The next record, which must have one of these sets of keys; None at the end of the file."""
        while True:
            self.line += 1
            data = self.stream.readline(LONGEST_LINE + 1)
            if not data:
                return None
            require(len(data) <= LONGEST_LINE, "longer than {} bytes", LONGEST_LINE)
            if not data.isspace():
                break
        try:
            record = DECODE(data.decode("utf-8"))
        except UnicodeDecodeError:
            raise Rejected("not UTF-8") from None
        except RecursionError:
            raise Rejected("nested too deeply") from None
        except ValueError as error:
            raise Rejected(f"not JSON: {str(error)[:80]}") from None
        require(type(record) is dict, "no JSON object")
        keys = record.keys()
        if not any(keys == wanted for wanted in keys_of):
            wanted = min(keys_of, key=lambda w: len(w ^ keys))
            for name in sorted(wanted - keys):
                raise Rejected(f"{shown(name)} is missing")
            for name in sorted(keys - wanted):
                raise Rejected(f"{shown(name)} does not belong here")
        return record

    def expect(self, what, *keys_of):
        record = self.next(*keys_of)
        require(record is not None, "the file ends where {} should follow", what)
        return record


class Header:
    """What certificates of frames begin with; those of another format say what they have instead."""

    FORMAT, COUNTS = FORMAT, tuple((name, 1) for name in ("vertices", "triangles", "nodes", "bvs", "frames"))

    def __init__(self, record):
        require(record["certificate"] == self.FORMAT, "the format is {}, not \"{}\"", shown(record["certificate"]),
                self.FORMAT)
        names = text(record["method"], "method").split("+")
        require(set(names) <= set(METHODS) and len(set(names)) == len(names), "method is {}", shown(record["method"]))
        self.shape(record)
        kdop = record["kdop"]
        require(type(kdop) is int and kdop in AXES, "kdop is {}", shown(kdop))
        self.axes, self.directions = AXES[kdop], kdop
        for name, least in self.COUNTS:
            setattr(self, name, whole(record[name], least, MOST_INDEX, name))
        self.missing = [text(part, "a missing part") for part in listed(record["missing"], None, "missing")]
        require(type(record["partial"]) is bool and record["partial"] == bool(self.missing),
                "partial is {}, but {} parts are missing", shown(record["partial"]), len(self.missing))
        self.sha256 = hashes(record["sha256"], self.hash_names(record))
        method = hashlib.sha256()
        for part in self.hashed_texts(record):
            data = part.encode("utf-8", "surrogatepass")
            method.update(b"%d:%b" % (len(data), data))
        self.agree("method", method)

    def hash_names(self, record):
        return HASHES

    def shape(self, record):
        shape = record["rest_shape"]
        require(shape in ("aabb", "obb"), "rest_shape is {}", shown(shape))
        self.duality = set(record["method"].split("+")) <= BOX_METHODS and shape == "aabb"
        self.targets = 0

    def hashed_texts(self, record):
        self.clip = text(record["clip"], "clip")
        return FORMAT, record["method"], record["rest_shape"], str(self.directions), self.clip, *self.missing

    def agree(self, what, found):
        require(found.hexdigest() == self.sha256[what], "the SHA-256 of the {} is another than stated", what)


class DisplacedHeader(Header):
    """Of frames in which morph targets displace the surface: no rest box holds it, so there is no duality."""

    def hash_names(self, record):
        return HASHES | {"targets"}

    def shape(self, record):
        super().shape(record)
        self.duality = False
        self.targets = whole(record["targets"], 1, MOST_INDEX, "targets")


def hashes(record, names):
    require(type(record) is dict and record.keys() == names, "sha256 does not have {}", ", ".join(sorted(names)))
    for name, value in record.items():
        require(type(value) is str and re.fullmatch("[0-9a-f]{64}", value),
                "the SHA-256 of the {} is {}", name, shown(value))
    return record


def check_end(records, header, parts, counts, hashed):
    """The last record. `parts`: the name of what the header counts; `counts`: of bounds; `hashed`: name and hash."""
    record = records.expect("the end", {"end", parts, "proven", "infinite", "violated", "sha256"})
    require(record["end"] == header.FORMAT, "the end is that of {}", shown(record["end"]))
    violated = whole(record["violated"], 0, 1 << 62, "violated")
    require(not violated, "the run that wrote it found {} bounds violated, or could not prove them", violated)
    for name, found in ((parts, getattr(header, parts)), *counts.items()):
        require(record[name] == found and type(record[name]) is int,
                "it ends with {} {}, but there are {}", name, shown(record[name]), found)
    name, found = hashed
    require(hashes(record["sha256"], {name})[name] == found.hexdigest(),
            "the SHA-256 of the {} is another than stated", name)
    require(records.next(set()) is None, "something follows the end")


def partial(header):
    """Before a verdict."""
    return f"partial (missing: {', '.join(map(plain, header.missing))}): " if header.missing else ""
