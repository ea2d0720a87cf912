// SPDX-License-Identifier: Apache-2.0
#include "toolkit/time/bound_over.hpp"

#include <algorithm>
#include <limits>

namespace cinch {
namespace {

constexpr int most_halvings = 20;

struct Piece {
    double first_s, last_s;
    int halvings;
};

} // namespace

TimeCost bound_over(IntervalRefitter& refit, const TimedMotion& motion, double a_s, double b_s, double tolerance,
                    std::span<double> supports)
{
    TimeCost cost;
    const std::size_t k = refit.kdop();
    // Pieces between keys; their bounds are kept until all ends are known, as what is loose depends on them.
    std::vector<double> cuts{a_s};
    for (const double key : motion.keys)
        if (key > a_s && key < b_s)
            cuts.push_back(key);
    cuts.push_back(b_s);
    std::vector<Piece> open;
    for (std::size_t i = 1; i < cuts.size(); ++i)
        open.push_back({cuts[i - 1], cuts[i], 0});
    open.push_back({b_s, b_s, 0}); // where a curve may jump to what no interval before it has

    std::vector<double> instant(supports.size(), -std::numeric_limits<double>::infinity()), bound(supports.size()),
        allowed(supports.size());
    std::fill(supports.begin(), supports.end(), -std::numeric_limits<double>::infinity());
    auto take = [&](std::span<double> to, std::span<const double> from) {
        for (std::size_t i = 0; i < to.size(); ++i)
            to[i] = std::max(to[i], from[i]);
    };
    while (!open.empty()) {
        std::vector<std::vector<double>> bounds;
        for (const Piece& piece : open) {
            refit(motion.over(piece.first_s, piece.last_s), bound);
            bounds.push_back(bound);
            take(instant, refit.at_first());
            take(instant, refit.at_last());
            ++cost.intervals;
            cost.refits += 2;
        }
        for (std::size_t i = 0; i < supports.size(); i += k) {
            double half_extent = 0;
            for (std::size_t d = i; d < i + k; d += 2)
                half_extent = std::max(half_extent, (instant[d] + instant[d + 1]) / 2);
            for (std::size_t d = i; d < i + k; ++d)
                allowed[d] = instant[d] + tolerance * half_extent;
        }
        std::vector<Piece> next;
        for (std::size_t p = 0; p < open.size(); ++p) {
            const Piece& piece = open[p];
            const double middle = piece.first_s + (piece.last_s - piece.first_s) / 2;
            bool loose = false;
            for (std::size_t i = 0; i < supports.size() && !loose; ++i)
                loose = bounds[p][i] > allowed[i] && bounds[p][i] > supports[i];
            if (loose && piece.halvings < most_halvings && middle > piece.first_s && middle < piece.last_s) {
                next.push_back({piece.first_s, middle, piece.halvings + 1});
                next.push_back({middle, piece.last_s, piece.halvings + 1});
            } else {
                take(supports, bounds[p]);
            }
        }
        open = std::move(next);
    }
    return cost;
}

} // namespace cinch
