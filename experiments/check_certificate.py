#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Proves a certificate of `cinch verify` or `bake --certificate FILE` again, with nothing but the Python standard
library.

usage: check_certificate.py CERTIFICATE [--input MESH [--weights WEIGHTS --transforms TRANSFORMS]]

"Accepted" means: the file holds a whole surface (rest positions, triangles, convex weights in multiples of 2^-53),
transforms of its simulation nodes for every frame that it declares, and a tree of BVs whose leaves hold every triangle
exactly once. For every frame, every BV and every direction of its k-DOP the bound is a finite double that is proven
below, or +infinity, which is counted apart. All comparisons are exact: doubles are integers times a power of two.

  proven for     by
  every method   the vertices: no vertex of the BV's triangles lies beyond the bound, neither evaluated in real
                 arithmetic (exact) nor in doubles, operation by operation as cinch does (computed); both are evaluated
                 here again
  convex,        weak duality besides: bound >= D(lambda) = lambda + sum_j [ l_j (b_j - lambda) + (h_j - l_j)
  corners, eq12, max(b_j - lambda, 0) ], which is at least sum_j w_j b_j for all weights l <= w <= h of sum 1; b_j is
  limited        the exact extremum of the BV's rest box moved by simulation node j. Box and intervals are the least
                 that hold the BV's vertices, derived here. (Not over oriented rest boxes, nor intersected with another
                 method.)

Where morph targets displace the surface, every frame has their weights, and the vertices prove it alone.

A certificate of bounds over time (bake, verify --times all) holds the skeleton, morph targets and curves of glTF, or
frames, instead of transforms. Its intervals follow each other from the first to the last time of each clip; for every
real time of each, every vertex in real arithmetic lies within the bound of each BV that holds it: between two keys it
stays below the chord through both ends plus a parabola as high as its second derivative allows, all of them enclosed
here by intervals of whole numbers, and pieces of time that do not decide are halved.

The SHA-256 of positions, triangles, weights, transforms (or all that moves) and method must be those that the file
states, so that it cannot be changed by accident; who changes it on purpose proves bounds of another surface. --input
ties it to a mesh file (OBJ, OFF) that is read here: the same triangles and, double for double, the same positions, as
they are or centred and scaled to a longest half extent of 1.2. --weights and --transforms (a skin as text) tie the
rest: positions as they are, every weight within (n + 2) 2^-53 of the file's quotient, n the vertex's influences, and
every frame one of the clip's, in their order, with the same doubles.

Exit status: 0 accepted, 1 rejected or not understood, in one line, 2 wrong usage or unreadable files of --input.
"""
import argparse
import contextlib
import gzip
import io
import os
import re
import sys
import zlib

sys.dont_write_bytecode = True  # this folder may be read-only
from certificate.files import Tie, Unreadable  # noqa: E402
from certificate.proof import checker_of  # noqa: E402
from certificate.records import Records  # noqa: E402
from certificate.values import Rejected, plain, shown  # noqa: E402


class Parts(io.RawIOBase):
    """The bytes of the files of a folder, one after the other; those of a certificate are in order by their names."""

    def __init__(self, folder):
        self.left = sorted(os.path.join(folder, name) for name in os.listdir(folder)
                           if re.fullmatch(r"0-surface\.jsonl\.gz|1-frame-\d{8}\.jsonl\.gz|2-end\.jsonl\.gz", name))
        if not self.left:
            raise Rejected("not readable: a folder without parts of a certificate (0-surface.jsonl.gz ...)")
        self.file = None

    def readable(self):
        return True

    def readinto(self, buffer):
        while True:
            if self.file is None:
                if not self.left:
                    return 0
                self.file = gzip.open(self.left.pop(0))
            if count := self.file.readinto(buffer):
                return count
            self.file.close()
            self.file = None


@contextlib.contextmanager
def opened(name):
    """The bytes of a file, compressed or not, or of a folder of parts."""
    if os.path.isdir(name):
        yield io.BufferedReader(Parts(name), 1 << 20)
        return
    with open(name, "rb") as file:
        if file.peek(2)[:2] == b"\x1f\x8b":
            with gzip.GzipFile(fileobj=file) as unpacked:
                yield unpacked
        else:
            yield file


def check(name, tie=None, progress=lambda text: None):
    """The Checker of a file that is accepted; raises Rejected."""
    records = None
    try:
        with opened(name) as stream:
            records = Records(stream)
            return checker_of(records, tie, progress)
    except Rejected as error:
        reason = str(error)
    except (OSError, EOFError, zlib.error) as error:
        reason = f"not readable: {getattr(error, 'strerror', None) or error}"
    except MemoryError:
        reason = "it takes more memory than there is"
    except Exception as error:  # whatever was not thought of proves nothing
        reason = f"not understood: {type(error).__name__}: {shown(str(error))}"
    raise Rejected(f"line {records.line}: {reason}" if records and records.line else reason)


def arguments(given):
    usage, _, description = __doc__.strip().partition("\n\n")[2].partition("\n\n")
    title = __doc__.strip().partition("\n")[0]
    parser = argparse.ArgumentParser(usage=usage.partition(" ")[2], description=f"{title}\n\n{description}",
                                     formatter_class=argparse.RawDescriptionHelpFormatter, allow_abbrev=False)
    parser.add_argument("certificate", metavar="CERTIFICATE", help="a file, compressed or not, or a folder of parts")
    parser.add_argument("--input", metavar="MESH", help="the mesh file that it must be of: .obj or .off")
    parser.add_argument("--weights", metavar="WEIGHTS", help="and the weights: NAME.weights.txt")
    parser.add_argument("--transforms", metavar="TRANSFORMS", help="and the clips: NAME.frames.txt")
    given = parser.parse_args(given)
    if bool(given.weights) != bool(given.transforms) or (given.weights and not given.input):
        parser.error("--weights and --transforms go together, and with --input")
    return given


def main(given=None):
    chosen = arguments(given)
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")
    tty = sys.stderr.isatty()

    def progress(what):
        if tty:
            print(f"\r\x1b[Kchecking {what}", end="", file=sys.stderr, flush=True)

    try:
        tie = Tie(chosen.input, chosen.weights, chosen.transforms) if chosen.input else None
        checker = check(chosen.certificate, tie, progress)
        status, lines = 0, [f"accepted: {checker.verdict()}", *(tie.lines() if tie else ())]
    except Rejected as reason:
        status, lines = 1, [f"rejected: {reason}"]
    except Unreadable as reason:
        print(plain(str(reason)), file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        status, lines = 130, ["not checked: interrupted"]
    if tty:
        print("\r\x1b[K", end="", file=sys.stderr)
    try:
        for line in lines:
            print(f"{plain(chosen.certificate)}: {line}", flush=True)
    except OSError as error:
        sys.stdout = None
        print(f"the verdict cannot be written: {error.strerror}", file=sys.stderr)
        return status or 2
    return status


if __name__ == "__main__":
    sys.exit(main())
