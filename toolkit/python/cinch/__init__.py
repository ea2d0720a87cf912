# SPDX-License-Identifier: Apache-2.0
"""Tight, proven bounding volumes of deforming surfaces.

>>> import cinch
>>> character = cinch.read_character("robot.glb")
>>> bvh = cinch.build_bvh(character.surface)
>>> boxes = cinch.Refitter(bvh)(character.sample(fps=30))   # (frames, BVs, 2, 3)

Every bound contains every vertex of the deformed surface, evaluated in real arithmetic from the stored doubles, and as
`evaluate` computes it in floating point. Lengths are in the surface's unit, times in seconds. Bad input is a
ValueError, files that cannot be read an `InputError`, which is one.

`cinch.exact`, where it was built, proves bounds in exact arithmetic.
"""
from cinch import _core
from cinch._core import *  # noqa: F401,F403
from cinch._core import __version__

__all__ = ["__version__"] + [name for name in dir(_core) if not name.startswith("_")]

for _name in __all__[1:]:  # where they are found
    _thing = getattr(_core, _name)
    if hasattr(_thing, "__module__") and _thing.__module__ == "cinch._core":
        _thing.__module__ = "cinch"
del _name, _thing
