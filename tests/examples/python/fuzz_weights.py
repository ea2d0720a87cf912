#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""fuzz_weights.py [--cases 400] [--out fuzz_weights.png]: random weight intervals, by hypothesis, against cinch.exact.
Of each: the toolkit's bound is at least the exact maximum over the intervals, the certificate proves it, and no corner
exceeds it. The picture: how far above the exact maximum the proven bound and the paper's Eq. 12 are."""
import argparse
from fractions import Fraction

import cinch
import matplotlib
import numpy as np
from hypothesis import HealthCheck, given, seed, settings
from hypothesis import strategies as st

try:
    from cinch import exact
except ImportError as error:
    raise SystemExit(f"SKIPPED: {error}")
matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--cases", type=int, default=400)
parser.add_argument("--out", default="fuzz_weights.png")
options = parser.parse_args()
seen = []


@st.composite
def cases(draw):
    """Intervals that hold some weights, and extrema."""
    n = draw(st.integers(2, 8))
    weights = np.array(draw(st.lists(st.floats(0.01, 1), min_size=n, max_size=n)))
    weights /= weights.sum()
    below, above = (np.array(draw(st.lists(st.floats(0, 1), min_size=n, max_size=n))) for _ in range(2))
    l, h = weights * below, weights + (1 - weights) * above
    b = draw(st.lists(st.floats(-1e6, 1e6), min_size=n, max_size=n))
    return l, h, b


def dual(l, h, b, x):
    """D(x), which for every x is at least the maximum: weak duality, in fractions."""
    parts = [Fraction(b_j) - x for b_j in b]
    return x + sum(Fraction(h_j if part > 0 else l_j) * part for l_j, h_j, part in zip(l, h, parts))


@seed(0)
@settings(max_examples=options.cases, deadline=None, database=None, suppress_health_check=list(HealthCheck))
@given(cases())
def check(case):
    l, h, b = case
    best = exact.optimum(l, h, b)
    if best is None:  # no weights between them sum to exactly 1
        assert not exact.is_feasible(l, h) and exact.corners(l, h) == []
        return
    value = best.value
    assert best.bound_holds and Fraction(best.bound) >= value
    assert sum(w * Fraction(b_j) for w, b_j in zip(best.corner, b)) == value == dual(l, h, b, best.lambda_)
    assert sum(best.corner) == 1 and all(l_j <= w <= h_j for l_j, w, h_j in zip(l, best.corner, h))
    corners = exact.corners(l, h)
    assert len(corners) == exact.count_corners(l, h)
    assert max(sum(w * Fraction(b_j) for w, b_j in zip(corner, b)) for corner in corners) == value
    assert best.eq12 >= value
    size = max(map(abs, b)) or 1
    if size > 1e-300:
        seen.append((len(b), float((Fraction(best.bound) - value) / Fraction(size)),
                     float((best.eq12 - value) / Fraction(size))))


check()
count, bound, eq12 = np.array(seen).T
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.4), layout="constrained")
unit = 2.0**-52
left.hist(bound / unit, bins=40, color="tab:green")
left.set(xlabel="bound - exact maximum, in units of $2^{-52}$ max |b|", ylabel="cases",
         title="what the proof of rounding costs")
places = np.arange(2, 9)
left.axvline(0, color="0.3", linewidth=1)
right.boxplot([eq12[count == n] for n in places], positions=places, widths=0.6, medianprops={"color": "tab:red"},
              flierprops={"markersize": 2})
right.set(xlabel="n, weights", ylabel="(Eq. 12 - exact maximum) / max |b|",
          title="what the paper's corner gives away")
for axes in (left, right):
    axes.grid(alpha=0.3)
figure.savefig(options.out, dpi=100)
print(f"{len(seen)} weight spaces: the bound is never below the exact maximum, and at most {bound.max() / unit:.1f} "
      f"x 2^-52 above it; Eq. 12 is loose in {np.mean(eq12 > 1e-12):.0%}")
