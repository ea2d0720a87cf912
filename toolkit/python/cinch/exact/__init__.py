# SPDX-License-Identifier: Apache-2.0
"""The exact side of cinch: proofs of bounds, in exact arithmetic behind an interval filter.

Under GPL-3.0-or-later, as CGAL's polyhedral packages are; built apart, where CGAL is there.
"""
try:
    import cinch.exact._exact as _exact
except ModuleNotFoundError as _error:
    if _error.name != "cinch.exact._exact":
        raise
    raise ImportError(
        "cinch.exact is not part of this build; install libcgal-dev, libgmp-dev, libmpfr-dev, libmpfi-dev and "
        "nettle-dev, then pip install --no-build-isolation ./toolkit/python again") from None
from cinch.exact._exact import *  # noqa: E402,F401,F403

__all__ = [_name for _name in dir(_exact) if not _name.startswith("_")]
for _name in __all__:
    _thing = getattr(_exact, _name)
    if getattr(_thing, "__module__", None) == "cinch.exact._exact":
        _thing.__module__ = "cinch.exact"
del _name, _thing
