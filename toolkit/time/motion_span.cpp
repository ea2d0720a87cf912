// SPDX-License-Identifier: Apache-2.0
// Why it holds. At t_i, v is Σ_j w_j T_j(t_i) v⁰, so it is above its chord by Σ_j w_j γ·(T_j(t_i) − chord_j(t_i)) v⁰ at
// most, which is what the rises say. Between t_i and t_{i+1}, v is below its own chord there plus Σ_j w_j bump_j, as
// each T_j(t) v⁰ is below its own chord plus 4σ(1 − σ) times its bump. And that chord, of values below the parabola (1
// − τ) γ·v(t_0) + τ γ·v(t_n) + 4τ(1 − τ) s at both of its ends, is below it in between, since s ≥ 0.
#include "toolkit/time/motion_span.hpp"

#include <algorithm>
#include <cmath>

#include "toolkit/bounds/rounding.hpp"

namespace cinch {
namespace {

// What a map reaches over a box along an axis: q·c ± |q|·h, q the sum of up to three rows. With m what the entries of
// any map amount to there without cancellation: a difference of maps at three times, the shares of time off by 3u,
// rounds by 6u of each, 54um in three rows; their sum by 2u of 9m; products and sums with centre and half by 10u of 9m;
// 162um in all. The box is within √3 of the ball that an interval's `error` is of, which is at least 2⁻⁴² m = 2¹¹um: so
// twice the error is room for it many times over. `bend_error` is as much of the bend's. Products lose at most η/2 each
// besides, 64 of them are fewer.
double reach_along(const Axis& axis, const AffineMap& map, const RestBox& box, double sign)
{
    double q[4] = {};
    for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 4; ++c)
            q[c] += axis[r] * map.m[r][c];
    double centre = q[3], half = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const auto i = static_cast<Eigen::Index>(c);
        centre += q[c] * box.centre[i];
        half += std::abs(q[c]) * box.half[i];
    }
    return sign * centre + half;
}

const double products = smallest_times<double>(64);

double at_least_0(double x) { return x >= 0 ? x : std::isnan(x) ? infinite : 0; }

} // namespace

MotionSpan motion_span(Intervals intervals, const Bvh& bvh, int kdop)
{
    const auto axes = axes_of(kdop);
    const std::size_t k = 2 * axes.size(), nodes = intervals.front()->limits.size();
    MotionSpan out{std::vector<double>(nodes * k), std::vector<double>(nodes * k), std::vector<double>(nodes)};
    const double first_s = intervals.front()->first_s, last_s = intervals.back()->last_s, length = last_s - first_s;
    const RestBv root = bvh.rest(0);
    for (std::size_t n = 0; n < root.node.size(); ++n) {
        const std::uint32_t j = root.node[n];
        const RestBox& box = root.local[n];
        const AffineMap &from = intervals.front()->first[j], &to = intervals.back()->last[j];
        double& error = out.error[j];
        for (const auto& interval : intervals)
            error = std::max(error, interval->limits[j].error);
        auto rise_to = [&](double t_s, const AffineMap& at) {
            const double after = (t_s - first_s) / length, before = (last_s - t_s) / length,
                         share = 4 * after * before; // of the parabola
            AffineMap above;
            for (std::size_t r = 0; r < 3; ++r)
                for (std::size_t c = 0; c < 4; ++c)
                    above.m[r][c] = at.m[r][c] - (before * from.m[r][c] + after * to.m[r][c]);
            for (std::size_t d = 0; d < k; ++d) {
                const double reach = reach_along(axes[d / 2], above, box, d % 2 ? -1 : 1) + 2 * error + products;
                double& rise = out.rise[j * k + d];
                rise = std::max(rise, share > 0x1p-500 ? at_least_0(reach / share * (1 + 0x1p-48)) : infinite);
            }
        };
        for (std::size_t i = 0; i < intervals.size(); ++i) {
            const MotionInterval& interval = *intervals[i];
            if (i > 0)
                rise_to(interval.first_s, interval.first[j]);
            if (i + 1 < intervals.size()) // where a curve jumps
                rise_to(interval.last_s, interval.last[j]);
            const MotionInterval::Limits& limits = interval.limits[j];
            for (std::size_t d = 0; d < k; ++d) {
                const Axis& axis = axes[d / 2];
                const double norm = std::sqrt(
                                 static_cast<double>(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2])),
                             wider = norm * (1 + 0x1p-48);
                const double reach = reach_along(axis, interval.bend[j], box, d % 2 ? -1 : 1),
                             by_bend = reach + wider * limits.remainder + 4 * limits.bend_error + products,
                             by_norm = wider * limits.bump + products;
                out.bump[j * k + d] =
                    std::max(out.bump[j * k + d],
                             std::isnan(by_bend) ? at_least_0(by_norm) : at_least_0(std::min(by_bend, by_norm)));
            }
        }
    }
    return out;
}

} // namespace cinch
