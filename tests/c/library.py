# SPDX-License-Identifier: GPL-3.0-or-later
"""The library for C as ctypes has it: enumerations, structures and prototypes are read from the headers themselves."""
import ctypes
import pathlib
import re

NUMBERS = {
    "double": ctypes.c_double, "float": ctypes.c_float, "size_t": ctypes.c_size_t, "int32_t": ctypes.c_int32,
    "uint32_t": ctypes.c_uint32, "uint64_t": ctypes.c_uint64, "cinch_status": ctypes.c_int}


class Library:
    """`functions`: name -> [(type, name)] of parameters, types as the header has them; `cinch`: what calls them."""

    def __init__(self, library, headers):
        text = "".join((pathlib.Path(headers) / "cinch" / name).read_text() for name in ("cinch.h", "cinch_io.h"))
        text = re.sub(r"//[^\n]*|/\*.*?\*/", "", text, flags=re.S)
        self.constants = {}
        for body in re.findall(r"typedef enum \w+ \{(.*?)\}", text, re.S):
            for name, value in re.findall(r"(\w+) = (\d+)", body):
                self.constants[name] = int(value)
        self.opaque = set(re.findall(r"typedef struct (\w+) \1;", text))
        self.callbacks = {
            "cinch_task": ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_size_t),
            "cinch_filter": ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p, ctypes.c_uint32, ctypes.c_uint32)}
        self.callbacks["cinch_run"] = ctypes.CFUNCTYPE(
            None, ctypes.c_void_p, ctypes.c_size_t, self.callbacks["cinch_task"], ctypes.c_void_p)
        self.structures = {}
        for name, body in re.findall(r"typedef struct (\w+) \{(.*?)\} \1;", text, re.S):
            fields = []
            for line in filter(None, (part.strip() for part in body.split(";"))):
                kind, names = re.fullmatch(r"((?:const )?\w+)\s*(.*)", line, re.S).groups()
                for one in names.split(","):
                    stars, field, sizes = re.fullmatch(r"\s*(\**)\s*(\w+)((?:\[\d+\])*)", one).groups()
                    kind_of = self.type_of(kind + stars)
                    for size in reversed(re.findall(r"\d+", sizes)):
                        kind_of = kind_of * int(size)
                    fields.append((field, kind_of))
            self.structures[name] = type(name, (ctypes.Structure,), {"_fields_": fields})
        self.cinch = ctypes.CDLL(str(library))
        self.functions = {}
        for result, name, parameters in re.findall(r"CINCH_API (.*?)(cinch_\w+)\(([^;]*)\);", text, re.S):
            self.functions[name] = []
            for parameter in "".join(parameters.split("\n")).split(","):
                if parameter.strip() == "void":
                    continue
                kind, field, array = re.fullmatch(r"\s*(.*?[\s*])(\w+)((?:\[\d+\])?)\s*", parameter).groups()
                self.functions[name].append((re.sub(r"\s*\*", "*", kind.strip()) + ("*" if array else ""), field))
            function = getattr(self.cinch, name)
            function.argtypes = [self.type_of(kind) for kind, _ in self.functions[name]]
            function.restype = ctypes.c_char_p if "char" in result else self.type_of(result.strip())
            setattr(self, name, function)

    def type_of(self, kind):
        kind = kind.replace("const ", "").strip()
        if kind.endswith("*"):
            return ctypes.c_char_p if kind == "char*" else ctypes.c_void_p
        return NUMBERS.get(kind) or self.callbacks.get(kind) or self.structures[kind]

    def message(self):
        return self.cinch_error_message().decode()

    def need(self, name, *arguments):
        """Calls it and raises ValueError with the library's sentence where it fails."""
        if getattr(self, name)(*arguments) != 0:
            raise ValueError(self.message())

    def make(self, name, *arguments):
        """The same for what makes a handle, by its last parameter."""
        handle = ctypes.c_void_p()
        self.need(name, *arguments, ctypes.byref(handle))
        return handle.value


def doubles(values):
    return (ctypes.c_double * len(values))(*values)


def indices(values):
    return (ctypes.c_uint32 * len(values))(*values)


def strip_arrays(library, columns, targets=0):
    """A flag of 2 columns triangles that two simulation nodes move, by the share of x; what the structure points to is
    kept by it."""
    vertices = 2 * columns + 2
    x = [i // 2 / columns for i in range(vertices)]
    arrays = library.structures["cinch_surface_arrays"]()
    kept = {
        "positions": doubles([c for i in range(vertices) for c in (x[i], i % 2, 0)]),
        "triangles": indices([v for i in range(2 * columns) for v in (i, i + 1 + i % 2, i + 2 - i % 2)]),
        "weight_row": indices(range(0, 2 * vertices + 1, 2)),
        "weight_node": indices([0, 1] * vertices),
        "weight": doubles([w for i in range(vertices) for w in (1 - x[i], x[i])])}
    counts = {"vertex_count": vertices, "triangle_count": 2 * columns, "weight_count": 2 * vertices, "node_count": 2}
    if targets:
        kept |= {"target_row": indices(range(0, targets + 1)), "target_vertex": indices(range(targets)),
                 "target_displacement": doubles([0, 0, 0.5] * targets)}
        counts |= {"target_count": targets, "displacement_count": targets}
    for field, value in kept.items():
        setattr(arrays, field, ctypes.addressof(value))
    for field, value in counts.items():
        setattr(arrays, field, value)
    arrays.kept = kept
    return arrays
