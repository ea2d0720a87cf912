// SPDX-License-Identifier: Apache-2.0
#include "toolkit/hierarchy/lifted_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <queue>

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
