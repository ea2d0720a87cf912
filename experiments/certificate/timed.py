# SPDX-License-Identifier: GPL-3.0-or-later
"""A certificate of bounds over intervals of time: reads all of it, and proves it."""
import hashlib
import json

from certificate.motion import Bone, Character, Frames
from certificate.path import Curve
from certificate.poses import PoseProof
from certificate.records import Header, check_end, partial
from certificate.surface import Surface, Target
from certificate.times import IntervalProof, Vertices
from certificate.values import Rejected, double, in_order, listed, plain, require, shown, text, whole

FORMAT = "cinch times 2"
HEADER = {"certificate", "method", "kdop", "vertices", "triangles", "nodes", "bvs", "bones", "targets", "weights",
          "clips", "partial", "missing", "sha256"}
INTERPOLATIONS = ("STEP", "LINEAR", "CUBICSPLINE")
MOVES = {"translation": 3, "rotation": 4, "scale": 3}
MOST = 1 << 31


class TimedHeader(Header):
    FORMAT = FORMAT
    COUNTS = (("vertices", 1), ("triangles", 1), ("nodes", 1), ("bvs", 1), ("bones", 0), ("targets", 0), ("clips", 1))

    def shape(self, record):
        pass  # of rest boxes, which nothing here needs

    def hashed_texts(self, record):
        limits = listed(record["weights"], None, "weights")
        require(len(limits) in (0, 2), "weights are {} limits", len(limits))
        self.any_weights = [double(x) for x in limits]
        require(self.any_weights == sorted(self.any_weights), "the greatest weight is below the least")
        require(not limits or self.targets, "weights without morph targets")
        return FORMAT, record["method"], str(record["kdop"]), *limits, *self.missing


class MotionRecords:
    """Records that the hash of the motion is over."""

    def __init__(self, records):
        self.records, self.hash = records, hashlib.sha256()

    def expect(self, what, keys):
        record = self.records.expect(what, keys)
        # The bytes as cinch writes them: no spaces, ASCII, keys in their order.
        self.hash.update(json.dumps(record, separators=(",", ":")).encode("ascii") + b"\n")
        return record


def doubles(values, length, what):
    return [double(x) for x in listed(values, length, what)]


class TimedChecker:
    """As Checker, for intervals of time. `clips`: names and motions."""

    def __init__(self, records, header, tie=None, progress=lambda text: None):
        self.records, self.header, self.progress, self.tie = records, header, progress, tie
        self.motion = MotionRecords(records)
        progress("surface")
        self.surface = Surface(header, records)
        if tie:
            tie.surface(self.surface)
        self.character = self.read_character()
        used = sorted({v for triangle in self.surface.triangles for v in triangle})
        self.vertices = Vertices(self.surface, used, self.targets)
        self.proven = self.infinite = self.intervals = 0
        self.clips, self.poses = [], False
        for i in range(header.clips):
            self.check_clip(i)
        check_end(records, header, "clips", {"proven": self.proven, "infinite": self.infinite},
                  ("motion", self.motion.hash))

    def read_character(self):
        header, bones, joints, weights, self.targets = self.header, [], [], [], []
        for i in range(header.bones):
            record = self.motion.expect(f"bone {i}", {"bone", "parent", "translation", "rotation", "scale", "matrix"})
            in_order("bone", record["bone"], i)
            matrix = doubles(record["matrix"], None, "matrix")
            require(len(matrix) in (0, 16), "a matrix of {} numbers", len(matrix))
            require(not matrix or matrix[3::4] == [0.0, 0.0, 0.0, 1.0], "a matrix that is not affine")
            bones.append(Bone(whole(record["parent"], -1, i - 1, "parent"),
                              doubles(record["translation"], 3, "translation"),
                              doubles(record["rotation"], 4, "rotation"), doubles(record["scale"], 3, "scale"), matrix))
        for j in range(header.nodes if bones else 0):
            record = self.motion.expect(f"joint {j}", {"joint", "bone", "bind"})
            in_order("joint", record["joint"], j)
            joints.append((whole(record["bone"], 0, len(bones) - 1, "bone"), doubles(record["bind"], 12, "bind")))
        for i in range(header.targets):
            record = self.motion.expect(f"target {i}", {"target", "weight", "vertices", "displacements"})
            in_order("target", record["target"], i)
            weights.append(double(record["weight"]))
            target = Target(record, header.vertices)
            self.targets.append((target.vertices, target.by))
        require(bones or not header.targets, "morph targets without bones")
        return Character(bones, joints, weights, header.any_weights) if bones else None

    def times(self, record, what):
        times = doubles(record["times"], None, "times")
        require(times and all(a <= b for a, b in zip(times, times[1:])), "the times of a {} do not ascend", what)
        require(record["interpolation"] in INTERPOLATIONS, "interpolation is {}", shown(record["interpolation"]))
        return times, len(times) * (3 if record["interpolation"] == "CUBICSPLINE" else 1)

    def curve(self, i, curves):
        record = self.motion.expect(f"curve {i}", {"curve", "bone", "moves", "interpolation", "times", "values"})
        in_order("curve", record["curve"], i)
        bone, moves = whole(record["bone"], 0, self.header.bones - 1, "bone"), record["moves"]
        require(type(moves) is str and moves in MOVES, "moves is {}", shown(moves))
        require(moves not in curves.setdefault(bone, {}), "two curves of the {} of bone {}", moves, bone)
        times, count = self.times(record, "curve")
        values = [doubles(x, MOVES[moves], "a value") for x in listed(record["values"], count, "values")]
        curves[bone][moves] = Curve(record["interpolation"], times, values)

    def morph(self, i, moved):
        record = self.motion.expect(f"curve of weights {i}",
                                    {"morph", "target", "count", "interpolation", "times", "values"})
        in_order("morph", record["morph"], i)
        count = whole(record["count"], 1, self.header.targets, "count")
        first = whole(record["target"], 0, self.header.targets - count, "target")
        require(moved.isdisjoint(range(first, first + count)), "two curves of the weight of one target")
        moved.update(range(first, first + count))
        times, rows = self.times(record, "curve")
        values = doubles(record["values"], rows * count, "values")
        rows = [values[at:at + count] for at in range(0, len(values), count)]
        return first, Curve(record["interpolation"], times, rows)

    def frames(self, count, clip):
        times, maps = [], []
        for i in range(count):
            record = self.motion.expect(f"frame {i}", {"frame", "time", "maps"})
            in_order("frame", record["frame"], i)
            times.append(double(record["time"]))
            maps.append([doubles(m, 12, "a transform") for m in listed(record["maps"], self.header.nodes, "maps")])
            if self.tie:
                self.tie.frame(clip, times[-1], maps[-1])
        require(all(a <= b for a, b in zip(times, times[1:])), "the times of frames do not ascend")
        return Frames(times, maps)

    def check_clip(self, number):
        record = self.motion.expect(f"clip {number}",
                                    {"clip", "first", "last", "curves", "morphs", "frames", "limits", "intervals"})
        name, first, last = text(record["clip"], "clip"), double(record["first"]), double(record["last"])
        require(first <= last, "clip {} ends before it begins", shown(name))
        counts = {what: whole(record[what], 0, MOST, what)
                  for what in ("curves", "morphs", "frames", "limits", "intervals")}
        if self.character:
            require(not counts["frames"], "frames of a character")
            curves, moved = {}, set()
            for i in range(counts["curves"]):
                self.curve(i, curves)
            motion = self.character.clip(curves, [self.morph(i, moved) for i in range(counts["morphs"])])
        else:
            require(counts["frames"] and not counts["curves"] and not counts["morphs"], "a clip without frames")
            motion = self.frames(counts["frames"], name)
            require(motion.times[0] <= first and last <= motion.times[-1], "the clip goes on past its frames")
        require(not motion.keys or (first <= motion.keys[0] and motion.keys[-1] <= last),
                "keys of clip {} lie outside of it", shown(name))
        self.clips.append((name, motion))
        proof = IntervalProof(self.vertices, self.surface, motion, self.header.axes)
        if counts["limits"]:
            require(self.character and counts["limits"] == self.header.bones, "limits are not one per bone")
            require(not motion.keys and first == last and counts["intervals"] == 1, "poses that are a clip")
            self.poses = True
            proof = PoseProof(proof, self.character, [self.limit(i) for i in range(counts["limits"])])
        require(counts["intervals"], "clip {} has no intervals", shown(name))
        reached = first
        for i in range(counts["intervals"]):
            self.progress(f"{plain(name)}, interval {i + 1} of {counts['intervals']}")
            reached = self.check_interval(i, reached, proof)
        require(reached == last, "the intervals of clip {} end before it does", shown(name))

    def limit(self, i):
        record = self.motion.expect(f"limit {i}", {"limit", "angle", "move"})
        in_order("limit", record["limit"], i)
        limit = double(record["angle"]), double(record["move"])
        require(min(limit) >= 0, "a limit below 0")
        return limit

    def check_interval(self, i, begin, proof):
        record = self.records.expect(f"interval {i}", {"interval", "first", "last"})
        in_order("interval", record["interval"], i)
        first, last = double(record["first"]), double(record["last"])
        require(first == begin, "interval {} does not begin where the one before it ends", i)
        require(first <= last, "interval {} ends before it begins", i)
        k, bounds = self.header.directions, []
        for bv in range(self.header.bvs):
            record = self.records.expect(f"BV {bv} of interval {i}", {"interval", "bv", "bounds"})
            in_order("interval", record["interval"], i)
            in_order("BV", record["bv"], bv)
            bounds.append([None if x == "inf" else double(x) for x in listed(record["bounds"], k, "bounds")])
            infinite = bounds[-1].count(None)
            self.infinite += infinite
            self.proven += k - infinite
        try:
            proof.check(first, last, bounds)
        except Rejected as reason:
            raise Rejected(f"interval {i}: {reason}") from None
        self.intervals += 1
        return last

    def verdict(self):
        limits = self.header.any_weights
        over = "every pose within limits" if self.poses else f"{self.intervals} intervals of time"
        return (f"{partial(self.header)}{self.proven} bounds over {over} proven, "
                f"{self.infinite} infinite" +
                (f", of morph targets with weights from {limits[0]:g} to {limits[1]:g}" if limits else ""))
