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

double squared(const Lifted& x)
{
    double sum = 0;
    for (const double component : x)
        sum += component * component;
    return sum;
}

// The hull of scaled vectors, component by component beside each other: sums have the same order on every machine.
class LiftedHull {
public:
    explicit LiftedHull(std::size_t most)
    {
        for (auto& component : component_)
            component.reserve(most);
    }
    std::size_t size() const { return component_[0].size(); }
    void add(const Lifted& x)
    {
        for (std::size_t i = 0; i < lifted_size; ++i)
            component_[i].push_back(x[i]);
    }

    /// About the distance of x, and coefficients of a point of the hull that is so near; goes on from those in `alpha`,
    /// if any, for so many steps or until it is at most `enough`.
    double approach(const Lifted& x, std::vector<double>& alpha, int steps, double enough)
    {
        const std::size_t known = alpha.size();
        alpha.resize(size(), 0.0);
        score_.resize(size());
        if (known == 0)
            alpha[nearest(x)] = 1;
        Lifted rest = x;
        for (std::size_t i = 0; i < size(); ++i)
            if (alpha[i] > 0)
                for (std::size_t c = 0; c < lifted_size; ++c)
                    rest[c] -= alpha[i] * component_[c][i];
        double left = squared(rest);
        for (int step = 0; step < steps && left > enough * enough; ++step) {
            std::fill(score_.begin(), score_.end(), 0.0);
            for (std::size_t c = 0; c < lifted_size; ++c)
                for (std::size_t i = 0; i < score_.size(); ++i)
                    score_[i] += rest[c] * component_[c][i];
            std::size_t to = 0, from = 0;
            double lowest = std::numeric_limits<double>::infinity();
            for (std::size_t i = 0; i < score_.size(); ++i) {
                if (score_[i] > score_[to])
                    to = i;
                if (alpha[i] > 0 && score_[i] < lowest) {
                    lowest = score_[i];
                    from = i;
                }
            }
            if (!(score_[to] - lowest > 0.01 * left)) // within 1 % of the distance
                break;
            double along = 0;
            for (std::size_t c = 0; c < lifted_size; ++c) {
                const double move = component_[c][to] - component_[c][from];
                along += move * move;
            }
            const double move = std::min(alpha[from], (score_[to] - lowest) / along);
            if (!(move > 0))
                break;
            alpha[from] = move == alpha[from] ? 0 : alpha[from] - move;
            alpha[to] += move;
            for (std::size_t c = 0; c < lifted_size; ++c)
                rest[c] -= move * (component_[c][to] - component_[c][from]);
            left = squared(rest);
        }
        return std::sqrt(left);
    }

private:
    std::size_t nearest(const Lifted& x)
    {
        std::fill(score_.begin(), score_.end(), 0.0);
        for (std::size_t c = 0; c < lifted_size; ++c)
            for (std::size_t i = 0; i < score_.size(); ++i)
                score_[i] += (x[c] - component_[c][i]) * (x[c] - component_[c][i]);
        return static_cast<std::size_t>(std::min_element(score_.begin(), score_.end()) - score_.begin());
    }

    std::array<std::vector<double>, lifted_size> component_;
    std::vector<double> score_;
};

} // namespace

// Of n influences: d is off by u|d|, ξ by γ_n Σ w|z|, M by
// γ_{n+1} Σ w|z_a z_b|, so leaves of the products and sums of these pass at most n + 4 roundings, and the sums of
// absolute leaves at most n + 5: (n + 8)u of them leaves room for both, for n < 2²⁰. A product loses at most η/2: n for
// each ξ, which then meets |d|, and 2n for each M.
LiftedVertex lift(const Vec3& d, Weights::Row row, std::span<const Vec3> place)
{
    double xi[3] = {}, xi_leaves[3] = {}, m[6] = {}, m_leaves[6] = {}; // m: 00 11 22, 01 02 12
    static constexpr int first[6] = {0, 1, 2, 0, 0, 1}, second[6] = {0, 1, 2, 1, 2, 2};
    for (std::size_t i = 0; i < row.node.size(); ++i) {
        const Vec3& z = place[i];
        for (int s = 0; s < 3; ++s) {
            xi[s] += row.weight[i] * z[s];
            xi_leaves[s] += row.weight[i] * std::abs(z[s]);
        }
        for (int c = 0; c < 6; ++c) {
            const double product = z[first[c]] * z[second[c]];
            m[c] += row.weight[i] * product;
            m_leaves[c] += row.weight[i] * std::abs(product);
        }
    }
    LiftedVertex out;
    const double n = static_cast<double>(row.node.size());
    const auto set = [&](std::size_t place_of, double value, double leaves, double factor) {
        out.value[place_of] = value;
        out.off[place_of] =
            leaves == 0 ? 0 : succ((n + 8) * unit_roundoff * leaves + (4 * n + 8) * smallest_subnormal * (1 + factor));
    };
    const double reach = d.lpNorm<1>();
    for (std::size_t s = 0; s < 3; ++s) {
        const auto a = static_cast<int>(s), i = (a + 1) % 3, j = (a + 2) % 3;
        const int p = first[s + 3], q = second[s + 3];
        set(s, d[a], std::abs(d[a]), 0);
        set(3 + s, xi[a] - d[a], xi_leaves[a] + std::abs(d[a]), 0);
        set(6 + s, d[a] * xi[a] - 0.5 * m[a], std::abs(d[a]) * xi_leaves[a] + 0.5 * m_leaves[a], reach);
        set(9 + s, (d[p] * xi[q] + d[q] * xi[p]) - m[s + 3],
            (std::abs(d[p]) * xi_leaves[q] + std::abs(d[q]) * xi_leaves[p]) + m_leaves[s + 3], reach);
        set(12 + s, d[i] * xi[j] - d[j] * xi[i], std::abs(d[i]) * xi_leaves[j] + std::abs(d[j]) * xi_leaves[i], reach);
    }
    return out;
}

Lifted lifted_scale(double unit)
{
    Lifted scale;
    for (std::size_t c = 0; c < lifted_size; ++c)
        scale[c] = c < 6 ? 1 : 0.5 / unit;
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
    for (std::uint32_t k = 0; k < x.size(); ++k)
        if (!is_chosen[k])
            farthest.push({hull.approach(x[k], out.combination[k], 20, 0), k, hull.size()});
    while (hull.size() < most && !farthest.empty()) {
        Far top = farthest.top();
        farthest.pop();
        if (top.points == hull.size()) {
            if (!(top.distance > 0)) // or it is no number
                break;
            take(top.place);
            continue;
        }
        top.distance = std::min(top.distance, hull.approach(x[top.place], out.combination[top.place], 30, 0));
        top.points = hull.size();
        farthest.push(top);
    }
    const double enough = farthest.empty() ? 0 : 0.5 * farthest.top().distance;
    for (std::uint32_t k = 0; k < x.size(); ++k) {
        std::vector<double>& own = out.combination[k];
        if (is_chosen[k]) {
            own.clear();
            continue;
        }
        hull.approach(x[k], own, 100, enough);
        round_dyadic(own);
    }
    return out;
}

} // namespace cinch
