// SPDX-License-Identifier: Apache-2.0
#include "toolkit/bounds/bound_moments.hpp"

#include <algorithm>
#include <cmath>

#include "toolkit/bounds/rounding.hpp"
#include "toolkit/bounds/weight_space.hpp"

namespace cinch {
namespace {

double product(const Vec3& a, const Vec3& b) { return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]; }

// γ·(A (c + d) + t) = p + q·d, and the same of absolute values: of what p is the sum of, and of q.
struct CentredFunctional {
    Vec3 q = Vec3::Zero(), q_leaves = Vec3::Zero();
    double p = 0, p_leaves = 0;
};

CentredFunctional centred(const Axis& axis, const AffineMap& map, const Vec3& centre)
{
    CentredFunctional f;
    for (int r = 0; r < 3; ++r)
        if (const int sign = axis[static_cast<std::size_t>(r)]; sign != 0) {
            for (int s = 0; s < 3; ++s) {
                f.q[s] += sign * map.m[r][s]; // ±1 times: exact
                f.q_leaves[s] += std::abs(map.m[r][s]);
            }
            f.p += sign * map.m[r][3];
            f.p_leaves += std::abs(map.m[r][3]);
        }
    f.p = product(f.q, centre) + f.p;
    f.p_leaves = product(f.q_leaves, centre.cwiseAbs()) + f.p_leaves;
    return f;
}

// G z; with absolute values of both, its leaves.
Vec3 g_times(const MomentFit& fit, const Vec3& z)
{
    return (z[0] * fit.column[0] + z[1] * fit.column[1]) + z[2] * fit.column[2];
}

MomentFit leaves_of(const MomentFit& fit)
{
    return {std::abs(fit.phi),
            fit.linear.cwiseAbs(),
            fit.g.cwiseAbs(),
            {fit.column[0].cwiseAbs(), fit.column[1].cwiseAbs(), fit.column[2].cwiseAbs()}};
}

// Of a vertex as evaluated, along an axis: what its simulation node of greatest magnitude makes of the BV's box.
double world_magnitude(const RestBv& bv, std::span<const AffineMap> maps, const Axis& axis)
{
    double most = 0;
    const Vec3 reach = bv.box.centre.cwiseAbs() + bv.box.half;
    for (const std::uint32_t j : bv.node)
        most = std::max(most, centred(axis, maps[j], reach).p_leaves);
    return most;
}

// At mean b + start·(greatest b − mean b), the mean weighted by h − l.
double lambda_at(const WeightSpace& space, std::span<const double> b, double greatest, double start)
{
    double sum = 0, ranges = 0;
    for (std::size_t j = 0; j < b.size(); ++j) {
        sum += (space.h[j] - space.l[j]) * b[j];
        ranges += space.h[j] - space.l[j];
    }
    const double mean = ranges > 0 ? sum / ranges : greatest;
    return mean + start * (greatest - mean);
}

} // namespace

Lifted MomentFit::functional() const
{
    Lifted all;
    for (std::size_t b = 0; b < 3; ++b) {
        const auto i = static_cast<int>(b);
        all[b] = linear[i];
        all[3 + b] = g[i];
        for (std::size_t s = 0; s < 3; ++s)
            all[6 + 3 * s + b] = column[s][i];
    }
    return all;
}

MomentFit fit_moments(const RestBv& bv, const RestMoments& rest, std::span<const AffineMap> maps, const Axis& axis)
{
    MomentFit fit;
    Vec3 mean = Vec3::Zero(); // of q
    for (std::size_t j = 0; j < bv.node.size(); ++j) {
        const CentredFunctional f = centred(axis, maps[bv.node[j]], rest.centre);
        const MomentInfluence& own = rest.influence[j];
        mean += own.mean * f.q;
        for (int s = 0; s < 3; ++s)
            fit.column[s] += own.gradient[s] * f.q;
    }
    for (std::size_t j = 0; j < bv.node.size(); ++j) {
        const MomentInfluence& own = rest.influence[j];
        const double value = centred(axis, maps[bv.node[j]], rest.centre).p +
                             0.5 * rest.unit * product(own.place, g_times(fit, own.place));
        fit.phi += own.mean * value;
        fit.g += value * own.gradient;
    }
    fit.linear = mean + fit.g / rest.unit;
    return fit;
}

// Extrema of s_j + r_j·d over each node's own box, along and against the axis; and the greatest error of any. A leaf,
// a product of what is given, passes at most 10 roundings: A in q 2, r 3, r·d 3, the sums of s, r·d and the radius 2; A
// in p 6 and the sums 4; G in G z 3, in r 1, and as A from there, or in zᵀGz 3 and the sums 4; g fewer. So b̂ is within
// γ₁₀ M of b, M the sum of the absolute leaves, which is computed from non-negative leaves with at most 14: M ≤
// M̂/(1 − γ₁₄) and what it loses below; 16u leaves room for the product and the sum. Products of a node lose at most
// η/2 each: 15 of factor 1 or σ, and 12 of G z and g/σ, which then meet d or σz: 64η(1 + (1 + σ)(1 + |z|₁) + |y|₁ +
// |e|₁) covers both.
double remainder_extrema(const RestBv& bv, const RestMoments& rest, std::span<const AffineMap> maps, const Axis& axis,
                         const MomentFit& fit, std::span<double> plus, std::span<double> minus)
{
    const MomentFit leaves = leaves_of(fit);
    double magnitude = 0, reach = 0;
    bool finite = true;
    for (std::size_t j = 0; j < bv.node.size(); ++j) {
        const MomentInfluence& own = rest.influence[j];
        const CentredFunctional f = centred(axis, maps[bv.node[j]], rest.centre);
        const Vec3 &z = own.place, &y = own.local.centre, &e = own.local.half, at = z.cwiseAbs();
        const Vec3 gz = g_times(fit, z), r = ((f.q + fit.g / rest.unit) - fit.linear) - gz;
        const double s = (f.p - fit.phi) + (0.5 * rest.unit * product(z, gz) - product(fit.g, z)),
                     position = s + product(r, y), radius = product(r.cwiseAbs(), e);
        plus[j] = radius + position;
        minus[j] = radius - position;

        const Vec3 gz_leaves = g_times(leaves, at),
                   r_leaves = ((f.q_leaves + leaves.g / rest.unit) + leaves.linear) + gz_leaves;
        const double s_leaves =
                         (f.p_leaves + leaves.phi) + (0.5 * rest.unit * product(at, gz_leaves) + product(leaves.g, at)),
                     own_magnitude = s_leaves + product(r_leaves, y.cwiseAbs() + e);
        magnitude = std::max(magnitude, own_magnitude);
        reach = std::max(reach, ((1 + rest.unit) * (1 + at.lpNorm<1>()) + y.lpNorm<1>()) + e.lpNorm<1>());
        finite &= own_magnitude < infinite; // false for NaN
    }
    return finite ? succ(16 * unit_roundoff * magnitude + 64 * smallest_subnormal * (1 + reach)) : infinite;
}

// The support of the lifted functional, along the axis and against it, and its error: a leaf passes at most 16
// roundings, 1 in the product and 15 in the sum; the slack's at most 15. 24u of the greatest sum of absolute leaves and
// of the slack leaves room for their own rounding; 30 products lose at most η/2 each.
LiftedSupport lifted_support(const RestMoments& rest, const MomentFit& fit)
{
    LiftedSupport out;
    const Lifted functional = fit.functional();
    double leaves = 0;
    bool finite = true;
    for (const Lifted& point : rest.point) {
        double value = fit.phi, absolute = std::abs(fit.phi);
        for (std::size_t i = 0; i < lifted_size; ++i) {
            const double term = functional[i] * point[i];
            value += term;
            absolute += std::abs(term);
        }
        out.along = std::max(out.along, value);
        out.against = std::max(out.against, -value);
        leaves = std::max(leaves, absolute);
        finite &= absolute < infinite; // false for NaN
    }
    double slack[2] = {0, 0};
    for (std::size_t i = 0; i < lifted_size; ++i) {
        const double most = functional[i] * rest.greatest[i], least = functional[i] * rest.least[i];
        slack[0] += std::max(most, least);
        slack[1] += std::max(-most, -least);
        finite &= std::abs(most) < infinite && std::abs(least) < infinite;
    }
    out.along += slack[0];
    out.against += slack[1];
    out.error =
        finite ? succ(24 * unit_roundoff * (leaves + (slack[0] + slack[1])) + 32 * smallest_subnormal) : infinite;
    return out;
}

void bound_moments(const RestBv& bv, const RestMoments& rest, std::span<const AffineMap> maps, Rounding rounding,
                   std::span<const Axis> axes, BoundScratch& scratch, std::span<double> supports,
                   std::optional<double> start)
{
    std::fill_n(supports.begin(), 2 * axes.size(), infinite);
    if (!std::all_of(bv.node.begin(), bv.node.end(), [&](std::uint32_t j) { return is_finite(maps[j]); }))
        return; // along no axis
    scratch.plus.resize(bv.node.size());
    scratch.minus.resize(bv.node.size());
    for (std::size_t a = 0; a < axes.size(); ++a) {
        const MomentFit numbers = fit_moments(bv, rest, maps, axes[a]);
        const LiftedSupport lifted = lifted_support(rest, numbers);
        double error = remainder_extrema(bv, rest, maps, axes[a], numbers, scratch.plus, scratch.minus);
        if (!(error < infinite && lifted.error < infinite))
            continue;
        error = succ(succ(error + lifted.error) +
                     evaluation_error(bv.vertex_influences, world_magnitude(bv, maps, axes[a])));
        for (std::size_t side = 0; side < 2; ++side) {
            const std::vector<double>& b = side == 0 ? scratch.plus : scratch.minus;
            const double greatest = *std::max_element(b.begin(), b.end()),
                         lambda = start ? lambda_at(bv.space, b, greatest, *start)
                                        : best_lambda(bv.space, b, scratch.select),
                         remainder = std::min(greatest, dual_bound(bv.space, b, lambda, rounding)),
                         of_points = side == 0 ? lifted.along : lifted.against,
                         bound = rounding == Rounding::proven ? succ(succ(of_points + remainder) + error)
                                                              : of_points + remainder;
            if (bound < infinite)
                supports[2 * a + side] = bound;
        }
    }
}

} // namespace cinch
