// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/answers.hpp"

#include <cmath>
#include <limits>

#include "exact/formulas.hpp"
#include "exact/optimum.hpp"

namespace cinch::exact {

std::optional<Answer> answer(WeightSpace space, std::span<const double> b, double bound)
{
    const std::vector<Exact> exact(b.begin(), b.end());
    const auto best = optimum(space, exact);
    if (!best)
        return std::nullopt;
    Answer out;
    out.maximum = as_fraction(best->value);
    out.lambda = as_fraction(best->lambda);
    for (const mpz_class& w : best->corner)
        out.corner.push_back(as_fraction(w.get_mpz_t(), -best->corner_bits));
    if (exact.size() > 1) {
        std::vector<Exact> sorted = exact;
        std::nth_element(sorted.begin(), sorted.begin() + 1, sorted.end(),
                         [](const Exact& x, const Exact& y) { return y < x; });
        out.eq12 = as_fraction(dual_value(space, exact, sorted[1]));
    }
    out.bound_holds =
        bound == std::numeric_limits<double>::infinity() || (std::isfinite(bound) && best->value <= Exact(bound));
    return out;
}

} // namespace cinch::exact
