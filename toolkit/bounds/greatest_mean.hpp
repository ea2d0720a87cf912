// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "cinch/bounds.hpp"
#include "toolkit/bounds/rounding.hpp"

namespace cinch {

/// At least max Σ w_j c_j over the BV's weight space, c_j ≥ 0 (Eq. 12, or the greatest c_j); `of(j)` gives that of
/// the j-th of the BV's simulation nodes.
template <class F> double greatest_mean(const RestBv& bv, F&& of)
{
    double most = 0, second = 0;
    for (std::size_t j = 0; j < bv.node.size(); ++j) {
        const double c = of(j);
        second = std::max(second, std::min(c, most));
        most = std::max(most, c);
    }
    if (!(most < HUGE_VAL) || second == most)
        return most;
    double sum = second; // D(λ) at the second-greatest
    for (std::size_t j = 0; j < bv.node.size(); ++j) {
        const double above = of(j) - second;
        sum += bv.space.l[j] * above + (bv.space.h[j] - bv.space.l[j]) * std::max(above, 0.0);
    }
    // |terms| sum to at most 3 most, each passes n + 3 roundings; 2n products lose at most η/2 each, and the next one.
    const double rounding =
        (static_cast<double>(bv.node.size()) + 8) * 0x1p-51 * most + smallest_times<double>(2 * bv.node.size());
    return std::min(most, sum + rounding);
}

} // namespace cinch
