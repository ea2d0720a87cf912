// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/check_space.hpp"

#include <cmath>
#include <limits>
#include <optional>

#include "exact/corners.hpp"
#include "exact/formulas.hpp"
#include "exact/optimum.hpp"

namespace cinch::exact {

std::string space_fault(WeightSpace space, std::span<const double> b, std::span<const ClaimedBound> claims)
{
    const std::vector<Exact> exact(b.begin(), b.end());
    const auto best = optimum(space, exact);
    if (best.has_value() != is_feasible(space))
        return "optimum and feasibility disagree";
    if (best && exact.size() > 1) {
        std::vector<Exact> sorted = exact;
        std::partial_sort(sorted.begin(), sorted.begin() + 2, sorted.end(),
                          [](const Exact& x, const Exact& y) { return y < x; });
        const Exact eq12 = dual_value(space, exact, sorted[1]);
        if (eq12 < best->value)
            return "Eq. 12 lies below the optimum by " + as_fraction(best->value - eq12);
        if (sorted[0] < eq12)
            return "Eq. 12 lies above the largest b by " + as_fraction(eq12 - sorted[0]);
    }
    for (const ClaimedBound& claim : claims) {
        const std::string name = claim.name;
        if (claim.bound == std::numeric_limits<double>::infinity())
            continue;
        if (!std::isfinite(claim.bound))
            return name + " is not a number above minus infinity";
        const Exact bound(claim.bound);
        if (best && bound < best->value)
            return name + " lies below the optimum by " + as_fraction(best->value - bound);
        if (claim.has_lambda) {
            const Exact dual = dual_value(space, exact, Exact(claim.lambda));
            if (bound < dual)
                return name + " lies below D(lambda) by " + as_fraction(dual - bound);
        }
    }
    return {};
}

std::string corner_fault(WeightSpace space, std::span<const double> b)
{
    const std::vector<Exact> exact(b.begin(), b.end());
    const auto best = optimum(space, exact);
    std::optional<Exact> highest;
    visit_corners(space, [&](const CornerRun& run, const Corner& corner) {
        Exact value(0), sum(0);
        std::vector<bool> up(b.size(), false);
        for (std::size_t i = 0; i < run.order.size(); ++i)
            up[run.order[i]] = corner.at_upper[i / 64] >> (i % 64) & 1;
        for (std::size_t j = 0; j < b.size(); ++j) {
            const Exact w(up[j] ? space.h[j] : space.l[j]);
            sum = sum + w;
            value = value + w * exact[j];
        }
        if (corner.between >= 0)
            value = value + (Exact(1) - sum) * exact[run.order[static_cast<std::size_t>(corner.between)]];
        if (!highest || *highest < value)
            highest = value;
        return true;
    });
    if (highest.has_value() != best.has_value())
        return "corners and optimum disagree on feasibility";
    if (best && *highest != best->value)
        return "the best corner and the optimum differ by " + as_fraction(best->value - *highest);
    return {};
}

} // namespace cinch::exact
