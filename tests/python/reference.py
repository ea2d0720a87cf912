# SPDX-License-Identifier: GPL-3.0-or-later
"""reference.cpp through ctypes: what C++ itself computes of the same arrays."""
import ctypes
import os

import numpy as np
from shapes import csr

path = os.environ.get("CINCH_REFERENCE", "")
library = ctypes.CDLL(path) if os.path.exists(path) else None
if library:
    library.reference_make.restype = ctypes.c_void_p
    library.reference_bvs.restype = library.reference_pairs.restype = ctypes.c_size_t
    library.reference_refit.restype = ctypes.c_double


def at(array):
    return array.ctypes.data_as(ctypes.c_void_p)


class Reference:
    """A surface, its tree and its refitter in C++."""

    def __init__(self, vertices, triangles, dense, leaf=4, method="best", kdop=6, precision="float32"):
        data, indices, indptr = csr(dense)
        self.nodes, self.kdop, self.vertices = dense.shape[1], kdop, len(vertices)
        kept = (np.ascontiguousarray(vertices, np.float64), np.ascontiguousarray(triangles, np.uint32),
                np.ascontiguousarray(data, np.float64), np.ascontiguousarray(indices, np.uint32),
                np.ascontiguousarray(indptr, np.uint32))
        self.count = len(data)
        self.here = ctypes.c_void_p(library.reference_make(
            at(kept[0]), ctypes.c_size_t(len(vertices)), at(kept[1]), ctypes.c_size_t(len(triangles)), at(kept[2]),
            at(kept[3]), at(kept[4]), ctypes.c_uint32(self.nodes), ctypes.c_size_t(leaf), method.encode(),
            ctypes.c_int(kdop), ctypes.c_bool(precision == "float64")))
        self.bvs = library.reference_bvs(self.here)

    def __del__(self):
        if library and hasattr(self, "here"):
            library.reference_free(self.here)

    def weights(self):
        out = np.empty(self.count)
        library.reference_weights(self.here, at(out))
        return out

    def refit(self, maps, out=None):
        """Supports, and nanoseconds."""
        frames = maps.reshape(-1, self.nodes, 3, 4)
        out = np.empty((len(frames), self.bvs, self.kdop)) if out is None else out
        return out, library.reference_refit(self.here, at(frames), ctypes.c_size_t(len(frames)), at(out))

    def evaluate(self, maps):
        out = np.empty((self.vertices, 3))
        library.reference_evaluate(self.here, at(maps), at(out))
        return out

    def crowd(self, maps, level):
        boxes = ctypes.c_size_t()
        arguments = (self.here, at(maps), ctypes.c_size_t(len(maps)), ctypes.c_int(level))
        library.reference_crowd(*arguments, None, ctypes.byref(boxes))
        out = np.empty((len(maps), boxes.value, 2, 3))
        library.reference_crowd(*arguments, at(out), ctypes.byref(boxes))
        return out

    def pairs(self, first, second):
        out = np.empty((1_000_000, 4), np.uint32)
        count = library.reference_pairs(self.here, at(first), at(second), at(out), ctypes.c_size_t(len(out)))
        assert count <= len(out)
        return out[:count]
