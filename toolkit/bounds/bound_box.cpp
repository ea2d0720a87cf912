// SPDX-License-Identifier: Apache-2.0
#include "toolkit/bounds/bound_box.hpp"

#include <algorithm>

#include "toolkit/bounds/rounding.hpp"

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
        const Vec3 &c = bv.centre, &e = bv.half;
        const double p = ((g[0] * c[0] + g[1] * c[1]) + g[2] * c[2]) + g[3];
        const double radius = (std::abs(g[0]) * e[0] + std::abs(g[1]) * e[1]) + std::abs(g[2]) * e[2];
        const double magnitude = ((a[0] * (std::abs(c[0]) + e[0]) + a[1] * (std::abs(c[1]) + e[1])) + a[2] * (std::abs(c[2]) + e[2])) + a[3];
        out.plus[i] = radius + p;
        out.minus[i] = radius - p;
        largest = std::max(largest, magnitude);
        finite &= magnitude < infinite; // false for NaN
    }
    return finite ? largest : infinite;
}

double box_free_bound(WeightSpace space, std::span<const double> b, Method method, Rounding rounding, BoundScratch& scratch)
{
    double bound = *std::max_element(b.begin(), b.end());
    if (method == Method::convex)
        return bound;
    // The rounding terms may lift a dual value past a looser method's; every valid bound may be intersected with every other.
    bound = std::min(bound, dual_bound(space, b, second_largest(b), rounding));
    if (method == Method::limited)
        bound = std::min(bound, dual_bound(space, b, best_lambda(space, b, scratch.select), rounding));
    return bound;
}

} // namespace

void bound_box(const RestBv& bv, std::span<const AffineMap> maps, Method method, Rounding rounding, std::span<const Axis> axes,
               BoundScratch& scratch, std::span<double> supports)
{
    scratch.plus.resize(bv.node.size());
    scratch.minus.resize(bv.node.size());
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
            const double bound = box_free_bound(bv.space, side == 0 ? scratch.plus : scratch.minus, method, rounding, scratch);
            const double widened = rounding == Rounding::proven ? succ(bound + error) : bound;
            if (widened < infinite)
                support = widened;
        }
    }
}

} // namespace cinch
