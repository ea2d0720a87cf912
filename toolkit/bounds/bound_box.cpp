// SPDX-License-Identifier: Apache-2.0
#include "toolkit/bounds/bound_box.hpp"

#include <algorithm>

#include "toolkit/bounds/rounding.hpp"
#include "toolkit/bounds/weight_space.hpp"

namespace cinch {
namespace {

// b̂_j of every node along and against one axis, and the largest magnitude M̂; +∞ if anything is not finite.
double extrema(const RestBv& bv, std::span<const AffineMap> maps, const Axis& axis, BoundScratch& out)
{
    double largest = 0;
    bool finite = true;
    for (std::size_t i = 0; i < bv.node.size(); ++i) {
        const auto& m = maps[bv.node[i]].m;
        double g[4], a[4]; // Aᵀγ and γ·t; the same of absolute values
        for (int s = 0; s < 4; ++s) {
            g[s] = a[s] = 0;
            for (int r = 0; r < 3; ++r)
                if (axis[static_cast<std::size_t>(r)] != 0) {
                    g[s] += axis[static_cast<std::size_t>(r)] * m[r][s]; // ±1 times: exact
                    a[s] += std::abs(m[r][s]);
                }
        }
        const Vec3 &c = bv.box.centre, &e = bv.box.half;
        const double p = ((g[0] * c[0] + g[1] * c[1]) + g[2] * c[2]) + g[3];
        const double radius = (std::abs(g[0]) * e[0] + std::abs(g[1]) * e[1]) + std::abs(g[2]) * e[2];
        const double magnitude =
            ((a[0] * (std::abs(c[0]) + e[0]) + a[1] * (std::abs(c[1]) + e[1])) + a[2] * (std::abs(c[2]) + e[2])) + a[3];
        out.plus[i] = radius + p;
        out.minus[i] = radius - p;
        largest = std::max(largest, magnitude);
        finite &= magnitude < infinite; // false for NaN
    }
    return finite ? largest : infinite;
}

// The greatest of the n(n − 1) corners of §5.2.2: h at i, what is missing to 1 at j, l elsewhere. Kavan and Žára's
// coherent form, Σ l b + (h_i − l_i) b_i + (1 − Σ l − (h_i − l_i)) b_j; the factors are exact for weights in units of
// 2^-53. The sum of n products and the last two pass at most n + 4 roundings on leaves that are below 3 max |b| in all;
// so none overflows, where max |b| is below 2^1020. Above, a corner that overflows downwards may be the one that
// counts.
double best_corner(WeightSpace space, std::span<const double> b, Rounding rounding)
{
    if (b.size() == 1)
        return b[0];
    constexpr double most_safe = 0x1p1020;
    double base = 0, slack = 1, magnitude = 0, best = -infinite;
    for (std::size_t j = 0; j < b.size(); ++j) {
        base += space.l[j] * b[j];
        slack -= space.l[j];
        magnitude = std::max(magnitude, std::abs(b[j]));
    }
    if (!(magnitude < most_safe))
        return infinite;
    for (std::size_t i = 0; i < b.size(); ++i) {
        const double range = space.h[i] - space.l[i], raised = base + range * b[i];
        for (std::size_t j = 0; j < b.size(); ++j)
            if (j != i)
                best = std::max(best, raised + (slack - range) * b[j]);
    }
    if (rounding == Rounding::plain)
        return best;
    const double n = static_cast<double>(b.size());
    return succ(best + succ(4 * (n + 8) * unit_roundoff * magnitude + 2 * n * smallest_subnormal));
}

double box_free_bound(WeightSpace space, std::span<const double> b, Method method, Rounding rounding,
                      BoundScratch& scratch)
{
    double bound = *std::max_element(b.begin(), b.end());
    if (method == Method::convex)
        return bound;
    if (method == Method::corners)
        return best_corner(space, b, rounding); // as it is: it may well exceed the greatest b
    // The rounding terms may lift a dual value past a looser method's; every valid bound may be intersected with every
    // other.
    bound = std::min(bound, dual_bound(space, b, second_largest(b), rounding));
    if (method == Method::limited)
        bound = std::min(bound, dual_bound(space, b, best_lambda(space, b, scratch.select), rounding));
    return bound;
}

} // namespace

void bound_box(const RestBv& bv, std::span<const AffineMap> maps, Method method, Rounding rounding,
               std::span<const Axis> axes, BoundScratch& scratch, std::span<double> supports)
{
    scratch.plus.resize(bv.node.size());
    scratch.minus.resize(bv.node.size());
    // No axis is bounded by a transform that is not finite along another one: it means nothing as a whole.
    if (!std::all_of(bv.node.begin(), bv.node.end(), [&](std::uint32_t j) { return is_finite(maps[j]); })) {
        std::fill_n(supports.begin(), 2 * axes.size(), infinite);
        return;
    }
    for (std::size_t a = 0; a < axes.size(); ++a) {
        const double magnitude = extrema(bv, maps, axes[a], scratch);
        double error = 0; // of the extrema, and of the computed vertices
        if (rounding == Rounding::proven)
            error = succ(extremum_error(magnitude) + evaluation_error(bv.vertex_influences, magnitude));
        for (std::size_t side = 0; side < 2; ++side) {
            double& support = supports[2 * a + side];
            support = infinite;
            if (!(magnitude < infinite))
                continue;
            const double bound =
                box_free_bound(bv.space, side == 0 ? scratch.plus : scratch.minus, method, rounding, scratch);
            const double widened = rounding == Rounding::proven ? succ(bound + error) : bound;
            if (widened < infinite)
                support = widened;
        }
    }
}

} // namespace cinch
