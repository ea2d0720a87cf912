// SPDX-License-Identifier: Apache-2.0
#include "toolkit/hierarchy/lifted_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <queue>

#include "toolkit/bounds/rounding.hpp"
#include "toolkit/deform/dyadic.hpp"

namespace cinch {
namespace {

// The hull of scaled vectors, by their products with each other; in arrays of as many as there will be.
class LiftedHull {
    static constexpr int most_points = most_lifted_points;

public:
    using Values = Eigen::Array<double, Eigen::Dynamic, 1, 0, most_points, 1>; // no point has no score

    explicit LiftedHull(std::size_t most) : LiftedHull(static_cast<Eigen::Index>(most)) {}
    explicit LiftedHull(Eigen::Index most)
        : component_(Components::Zero(most, lifted_size)), product_(Products::Zero(most, most)),
          none_(Values::Constant(most, -unreachable))
    {
    }
    std::size_t size() const { return size_; }
    void add(const Lifted& x)
    {
        const auto at = static_cast<Eigen::Index>(size_++);
        for (std::size_t c = 0; c < lifted_size; ++c)
            component_(at, static_cast<Eigen::Index>(c)) = x[c];
        none_[at] = 0;
        product_.col(at) = products(x);
        product_.row(at) = product_.col(at).transpose();
    }

    /// About the distance of x, and coefficients of a point of the hull that is so near; goes on from those in `alpha`,
    /// if any is not 0, for so many steps or until it is at most `enough`. Steps from the point that is the least use
    /// to the one that is the most [pairwise Frank-Wolfe, Lacoste-Julien and Jaggi 2015].
    double approach(const Lifted& x, Values& alpha, int steps, double enough) const
    {
        Values score = products(x) + none_; // of what is left of x with each point
        if (!(alpha > 0).any()) {
            Eigen::Index nearest;
            (product_.matrix().diagonal().array() - 2 * score).minCoeff(&nearest);
            alpha[nearest] = 1;
        }
        Values unused(alpha.size());
        for (Eigen::Index i = 0; i < alpha.size(); ++i) {
            unused[i] = alpha[i] > 0 ? 0 : 2 * unreachable;
            if (alpha[i] > 0)
                score -= alpha[i] * product_.col(i);
        }
        double left = of_rest(x, alpha);
        for (int step = 0; step < steps && left > enough * enough; ++step) {
            const Values held = score + unused;
            const double most = score.maxCoeff(), least = held.minCoeff(); // in vectors, as their places are not found
            const Eigen::Index to = place_of(score, most), from = place_of(held, least);
            if (to == score.size() || from == score.size()) // one is no number
                break;
            const double gain = most - least;
            if (!(gain > 0.01 * left)) // within 1 % of the distance
                break;
            const double along = product_(to, to) - 2 * product_(to, from) + product_(from, from),
                         move = std::min(alpha[from], gain / along);
            if (!(move > 0 && along > 0))
                break;
            if (move == alpha[from])
                unused[from] = 2 * unreachable;
            alpha[from] = move == alpha[from] ? 0 : alpha[from] - move;
            alpha[to] += move;
            unused[to] = 0;
            score -= move * (product_.col(to) - product_.col(from));
            left = std::max(0.0, left + move * (move * along - 2 * gain));
        }
        return std::sqrt(left);
    }

private:
    static constexpr double unreachable = 0x1p1000;
    static Eigen::Index place_of(const Values& all, double value)
    {
        Eigen::Index i = 0;
        while (i < all.size() && all[i] != value)
            ++i;
        return i;
    }
    Values products(const Lifted& x) const
    {
        Values out = Values::Zero(none_.size());
        for (std::size_t c = 0; c < lifted_size; ++c)
            out += x[c] * component_.col(static_cast<Eigen::Index>(c));
        return out;
    }
    // Squared, without cancellation.
    double of_rest(const Lifted& x, const Values& alpha) const
    {
        Eigen::Map<const Eigen::Array<double, 1, lifted_size>> all(x.data());
        Eigen::Array<double, 1, lifted_size> rest = all;
        for (Eigen::Index i = 0; i < alpha.size(); ++i)
            if (alpha[i] > 0)
                rest -= alpha[i] * component_.row(i);
        return rest.square().sum();
    }

    std::size_t size_ = 0;
    using Components = Eigen::Array<double, Eigen::Dynamic, lifted_size, 0, most_points, lifted_size>;
    using Products = Eigen::Array<double, Eigen::Dynamic, Eigen::Dynamic, 0, most_points, most_points>;
    Components component_;
    Products product_;
    Values none_; // 0 for each point there is
};

} // namespace

// Of n influences: d is off by u|d|, ξ by γ_n Σ w|z|, M by γ_{n+1} Σ w|z_a z_b|, so leaves of the products and sums of
// these pass at most n + 4 roundings, and the sums of absolute leaves at most n + 5: (n + 8)u of them leaves room for
// both, for n < 2²⁰. A product loses at most η/2: n for each ξ, which then meets |d|, and 2n for each M.
LiftedVertex lift(const Vec3& d, Weights::Row row, std::span<const Vec3> place, double unit)
{
    Vec3 xi = Vec3::Zero(), xi_leaves = xi;
    Eigen::Matrix3d m = Eigen::Matrix3d::Zero(), m_leaves = m;
    for (std::size_t i = 0; i < row.node.size(); ++i) {
        const Vec3& z = place[i];
        xi += row.weight[i] * z;
        xi_leaves += row.weight[i] * z.cwiseAbs();
        m += row.weight[i] * (z * z.transpose());
        m_leaves += row.weight[i] * (z * z.transpose()).cwiseAbs();
    }
    LiftedVertex out;
    const double n = static_cast<double>(row.node.size()), reach = d.lpNorm<1>();
    const auto set = [&](std::size_t place_of, double value, double leaves, double factor) {
        out.value[place_of] = value;
        out.off[place_of] =
            leaves == 0 ? 0 : succ((n + 8) * unit_roundoff * leaves + (4 * n + 8) * smallest_subnormal * (1 + factor));
    };
    for (std::size_t b = 0; b < 3; ++b) {
        const auto i = static_cast<int>(b);
        set(b, d[i], std::abs(d[i]), 0);
        set(3 + b, xi[i] - d[i] / unit, xi_leaves[i] + std::abs(d[i] / unit), 0);
        for (int s = 0; s < 3; ++s)
            set(6 + 3 * static_cast<std::size_t>(s) + b, d[i] * xi[s] - 0.5 * unit * m(i, s),
                std::abs(d[i]) * xi_leaves[s] + 0.5 * unit * m_leaves(i, s), reach + unit);
    }
    return out;
}

Lifted lifted_scale(double unit)
{
    Lifted scale;
    for (std::size_t c = 0; c < lifted_size; ++c)
        scale[c] = c < 3 ? 1 / unit : c < 6 ? 1 : 0.5 / unit;
    return scale;
}

LiftedPoints choose_lifted(std::span<const Lifted> all, const Lifted& scale, std::size_t most)
{
    LiftedPoints out;
    out.combination.resize(all.size());
    if (all.size() <= most) {
        out.chosen.resize(all.size());
        std::iota(out.chosen.begin(), out.chosen.end(), 0u);
        return out;
    }
    std::vector<Lifted> x(all.begin(), all.end());
    for (Lifted& own : x)
        for (std::size_t i = 0; i < lifted_size; ++i)
            own[i] *= scale[i];
    LiftedHull hull(most);
    std::vector<LiftedHull::Values> alpha(all.size(), LiftedHull::Values::Zero(static_cast<Eigen::Index>(most)));
    std::vector<bool> is_chosen(all.size(), false);
    const auto take = [&](std::uint32_t k) {
        if (is_chosen[k])
            return;
        is_chosen[k] = true;
        out.chosen.push_back(k);
        hull.add(x[k]);
    };
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto [low, high] = std::minmax_element(
            x.begin(), x.end(), [&](const Lifted& a, const Lifted& b) { return a[axis] < b[axis]; });
        take(static_cast<std::uint32_t>(low - x.begin()));
        take(static_cast<std::uint32_t>(high - x.begin()));
    }
    // A distance only shrinks as points are added, so that one from before is at least what it is.
    struct Far {
        double distance;
        std::uint32_t place;
        std::size_t points;
        bool operator<(const Far& other) const
        {
            return distance < other.distance || (distance == other.distance && place > other.place);
        }
    };
    std::priority_queue<Far> farthest;
    const auto take_farthest = [&](std::size_t step, std::size_t until) { // of every step-th vertex
        farthest = {};
        for (std::size_t k = 0; k < x.size(); k += step)
            if (!is_chosen[k])
                farthest.push({hull.approach(x[k], alpha[k], 20, 0), static_cast<std::uint32_t>(k), hull.size()});
        while (hull.size() < until && !farthest.empty()) {
            Far top = farthest.top();
            farthest.pop();
            if (top.points == hull.size()) {
                if (!(top.distance > 0)) // or it is no number
                    break;
                take(top.place);
                continue;
            }
            top.distance = std::min(top.distance, hull.approach(x[top.place], alpha[top.place], 30, 0));
            top.points = hull.size();
            farthest.push(top);
        }
    };
    constexpr std::size_t sample = 128;
    if (x.size() > 2 * sample) // half of them from a sample: it takes a third of the time, and is hardly looser
        take_farthest(x.size() / sample, most / 2);
    take_farthest(1, most);
    const double enough = farthest.empty() ? 0 : 0.5 * farthest.top().distance;
    for (std::uint32_t k = 0; k < x.size(); ++k) {
        if (is_chosen[k])
            continue;
        hull.approach(x[k], alpha[k], 50, enough);
        out.combination[k].assign(alpha[k].data(), alpha[k].data() + hull.size());
        round_dyadic(out.combination[k]);
    }
    return out;
}

} // namespace cinch
