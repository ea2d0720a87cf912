# SPDX-License-Identifier: GPL-3.0-or-later
"""The files of --input: readers of their own for meshes (OBJ, OFF) and skins as text, and the comparison with them."""
import math
import os
import re
from fractions import Fraction

from certificate.values import ONE, plain, require, shown

SCALED_HALF = 1.2  # longest half extent of meshes with a scripted motion
CENTRED = f"centred and scaled to a longest half extent of {SCALED_HALF}"


class Unreadable(Exception):
    """One line: file, place, reason."""


def lines_of(name):
    """Number and words of every line that has any, comments left out."""
    try:
        with open(name, "rb") as file:
            data = file.read()
    except OSError as error:
        raise Unreadable(f"{name}: {error.strerror}") from None
    if data.startswith(b"\xef\xbb\xbf"):
        data = data[3:]
    # Bytes, not characters: only line ends and blanks of ASCII separate words.
    for number, line in enumerate(re.split(rb"\r\n|\n|\r", data), 1):
        yield number, line.decode("latin-1")


BLANKS = re.compile(r"[ \t\f\v]+")


def words_of(line):
    words = [w for w in BLANKS.split(line) if w]
    for i, word in enumerate(words):
        if word.startswith("#"):
            return words[:i]
    return words


def joined(lines):
    """Lines of an OBJ: a backslash before the line end joins the next one."""
    first, text = None, ""
    for number, line in lines:
        first = first or number
        if line.endswith("\\"):
            text += line[:-1] + " "
            continue
        yield first, text + line
        first, text = None, ""
    if first:
        yield first, text


NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?").fullmatch
INTEGER = re.compile(r"[+-]?[0-9]{1,18}").fullmatch


class Words:
    """The words of one file, or of one line, for numbers that are read one after the other."""

    def __init__(self, name, lines):
        self.name, self.number = name, 0
        self.words = self.each(lines)

    def each(self, lines):
        for number, line in lines:
            self.number = number
            yield from words_of(line)

    def fail(self, reason):
        raise Unreadable(f"{self.name}:{self.number}: {reason}")

    def word(self, what):
        word = next(self.words, None)
        if word is None:
            self.fail(f"the file ends where {what} was expected")
        return word

    def integer(self, what, least=0):
        word = self.word(what)
        if not INTEGER(word) or int(word) < least:
            self.fail(f"expected {what}, found {shown(word)}")
        return int(word)

    def double(self, what):
        word = self.word(what)
        if not NUMBER(word) or not math.isfinite(float(word)):
            self.fail(f"expected {what}, found {shown(word)}")
        return float(word)

    def point(self):
        return [self.double("a coordinate") for _ in range(3)]

    def end(self):
        word = next(self.words, None)
        if word is not None:
            self.fail(f"{shown(word)} where the file should end")


def fan(polygon):
    return [(polygon[0], polygon[i - 1], polygon[i]) for i in range(2, len(polygon))]


def read_obj(name):
    positions, triangles = [], []
    for number, line in joined(lines_of(name)):
        keyword, *rest = words_of(line) or [""]
        words = Words(name, [(number, " ".join(rest))])
        words.number = number
        if keyword == "v":
            positions.append(words.point())
        elif keyword in ("f", "fo"):
            polygon = []
            for word in rest:
                index = word.split("/")[0]
                if not INTEGER(index) or int(index) == 0 or int(index) < -len(positions):
                    words.fail(f"expected a vertex index, found {shown(word)}")
                polygon.append(int(index) - 1 if int(index) > 0 else len(positions) + int(index))
            triangles += fan(polygon)
    return positions, triangles


def read_off(name):
    """One vertex and one face per line, with whatever follows; or, where that does not fit, number after number."""
    lines = [(number, line) for number, line in lines_of(name) if words_of(line)]
    try:
        return off_by_lines(name, lines)
    except Unreadable as reason:
        try:
            return off_by_numbers(name, lines)
        except Unreadable:
            raise reason from None


OFF_KEYWORD = re.compile("(ST)?C?N?OFF").fullmatch


def off_header(words):
    first = words.word("the word OFF")
    if OFF_KEYWORD(first):
        return words.integer("the number of vertices"), words.integer("the number of faces")
    if not INTEGER(first) or int(first) < 0:
        words.fail(f"expected OFF, found {shown(first)}")
    return int(first), words.integer("the number of faces")


def off_by_lines(name, lines):
    at = 0
    while at < len(lines):  # the header ends with the line of the number of faces
        words = Words(name, lines[:at + 1])
        try:
            vertices, faces = off_header(words)
            break
        except Unreadable:
            if at > 3:
                raise
        at += 1
    else:
        raise Unreadable(f"{name}: has no header of OFF")
    body = lines[at + 1:]
    if len(body) != vertices + faces:
        raise Unreadable(f"{name}: {len(body)} lines for {vertices} vertices and {faces} faces")
    positions = [Words(name, [line]).point() for line in body[:vertices]]
    triangles = []
    for line in body[vertices:]:
        words = Words(name, [line])
        triangles += fan([off_index(words, vertices) for _ in range(words.integer("the number of vertices of a face"))])
    return positions, triangles


def off_by_numbers(name, lines):
    words = Words(name, lines)
    vertices, faces = off_header(words)
    words.integer("the number of edges")
    positions = [words.point() for _ in range(vertices)]
    triangles = []
    for _ in range(faces):
        triangles += fan([off_index(words, vertices) for _ in range(words.integer("the number of vertices of a face"))])
    words.end()
    return positions, triangles


def off_index(words, vertices):
    index = words.integer("a vertex index")
    if index >= vertices:
        words.fail(f"vertex index {index} of {vertices}")
    return index


def read_mesh(name):
    extension = os.path.splitext(name)[1].lower()
    if extension not in (".obj", ".off"):
        raise Unreadable(f"{name}: --input reads .obj and .off")
    positions, triangles = (read_obj if extension == ".obj" else read_off)(name)
    if not triangles or max(map(max, triangles)) >= len(positions):
        raise Unreadable(f"{name}: " + ("a face has a vertex that does not exist" if triangles else "has no triangles"))
    return positions, triangles


def read_weights(name):
    """Number of simulation nodes; per vertex {node: weight}, not normalised."""
    words = Words(name, lines_of(name))
    vertices, nodes = words.integer("the number of vertices"), words.integer("the number of nodes", 1)
    rows = []
    for _ in range(vertices):
        row = {}
        for _ in range(words.integer("the number of influences", 1)):
            node, weight = words.integer("a node index"), words.double("a weight")
            if node >= nodes or node in row or weight < 0:
                words.fail("a node index out of range or twice, or a negative weight")
            row[node] = weight
        rows.append(row)
    words.end()
    return nodes, rows


def read_clips(name):
    """Per clip its name, and time and transforms of its frames."""
    words = Words(name, lines_of(name))
    clips = []
    for _ in range(words.integer("the number of clips", 1)):
        clip = words.word("the name of a clip")
        count, nodes = words.integer("the number of frames", 1), words.integer("the number of nodes", 1)
        frames = []
        for _ in range(count):
            time = words.double("a time")
            frames.append((time, [[words.double("a matrix entry") for _ in range(12)] for _ in range(nodes)]))
        clips.append((clip.encode("latin-1").decode("utf-8", "replace"), frames))
    words.end()
    return clips


def centred_and_scaled(positions):
    """In doubles, operation by operation, as cinch does before a scripted motion."""
    low, high = ([f(p[s] for p in positions) for s in range(3)] for f in (min, max))
    centre = [0.5 * h + 0.5 * l for l, h in zip(low, high)]
    half = max(0.5 * h - 0.5 * l for l, h in zip(low, high))
    moved = [[x - c for x, c in zip(p, centre)] for p in positions]
    return [[x / half * SCALED_HALF for x in p] for p in moved] if half > 0 else moved


class Tie:
    """Compares what a certificate holds with files. Raises Unreadable for these and Rejected for what differs."""

    def __init__(self, mesh, weights=None, transforms=None):
        self.names = mesh, weights, transforms
        self.positions, self.triangles = read_mesh(mesh)
        self.weights = read_weights(weights)[1] if weights else None
        self.clips = read_clips(transforms) if transforms else None
        self.scaled, self.at, self.ties = False, 0, {}  # per clip: frames found, of how many

    def surface(self, surface):
        require(surface.triangles == self.triangles, "its triangles are not those of {}", plain(self.names[0]))
        if surface.positions != self.positions:
            self.scaled = not self.weights and surface.positions == centred_and_scaled(self.positions)
            require(self.scaled, "its positions are not those of {}{}", plain(self.names[0]),
                    "" if self.weights else f", neither as they are nor {CENTRED}")
        if self.weights:
            require(len(self.weights) == len(surface.rows),
                    "{} has weights of {} vertices", plain(self.names[1]), len(self.weights))
            for k, (row, given) in enumerate(zip(surface.rows, self.weights)):
                require(same_weights({j: u for j, u, _ in row}, given),
                        "the weights of vertex {} are not those of {}", k, plain(self.names[1]))

    def frame(self, name, time, maps):
        if not self.clips:
            return
        frames = next((frames for clip, frames in self.clips if clip == name), None)
        require(frames is not None, "{} has no clip {}", plain(self.names[2]), shown(name))
        if name not in self.ties:
            self.ties[name], self.at = [0, len(frames)], 0
        while self.at < len(frames) and frames[self.at] != (time, maps):
            self.at += 1
        require(self.at < len(frames),
                "the frame is none of those of clip {} in {}, or not in their order", shown(name), plain(self.names[2]))
        self.at += 1
        self.ties[name][0] += 1

    def lines(self):
        mesh, weights, clips = (plain(name) if name else None for name in self.names)
        own = "" if weights else "; weights and transforms are the certificate's own"
        yield f"triangles and positions are those of {mesh}{f', {CENTRED}' if self.scaled else ''}{own}"
        if weights:
            frames = ", ".join(f"{n} of {of} frames of clip {shown(name)}" for name, (n, of) in self.ties.items())
            yield f"weights are those of {weights}, normalised; transforms are those of {frames} in {clips}"


def same_weights(units, given):
    """Whether weights in units of 2^-53 are those given, normalised: within (n + 2) units of the exact quotient."""
    if not units.keys() <= given.keys():
        return False
    total = sum(map(Fraction, given.values()))
    if total == 0:  # bound to the first simulation node that it names
        return units == {min(given): ONE}
    return all(abs(units.get(j, 0) - Fraction(w) / total * ONE) <= len(given) + 2 for j, w in given.items())
