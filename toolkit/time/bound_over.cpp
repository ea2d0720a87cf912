// SPDX-License-Identifier: Apache-2.0
#include "toolkit/time/bound_over.hpp"

#include <algorithm>
#include <limits>

namespace cinch {
namespace {

constexpr int most_halvings = 20;
// And of all pieces together: enough for any motion that halving helps, little where it does not, as where a curve's
// tangents are so long that rounding hides it.
constexpr std::size_t spare_intervals = 1000, intervals_per_piece = 8;

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
    const std::size_t most_intervals = spare_intervals + intervals_per_piece * open.size();

    std::vector<double> instant(supports.size(), -std::numeric_limits<double>::infinity()), bound(supports.size());
    std::fill(supports.begin(), supports.end(), -std::numeric_limits<double>::infinity());
    auto take = [&](std::span<double> to, std::span<const double> from) {
        for (std::size_t i = 0; i < to.size(); ++i)
            to[i] = std::max(to[i], from[i]);
    };
    // What a piece may exceed bounds at instants by: of these, the most along an axis.
    auto room_of = [&](std::size_t bv, auto&& at) {
        double half_extent = 0;
        for (std::size_t d = bv * k; d < bv * k + k; d += 2)
            half_extent = std::max(half_extent, (at(d) + at(d + 1)) / 2);
        return tolerance * half_extent;
    };
    // Whether a bound stays that near to them; more instants can only make it nearer.
    auto is_near = [&](std::span<const double> bounds, auto&& at) {
        for (std::size_t bv = 0; bv < bounds.size() / k; ++bv) {
            const double room = room_of(bv, at);
            for (std::size_t d = bv * k; d < bv * k + k; ++d)
                if (bounds[d] > at(d) + room && bounds[d] > supports[d])
                    return false;
        }
        return true;
    };
    while (!open.empty()) {
        std::vector<std::pair<Piece, std::vector<double>>> doubtful; // until all instants are known
        for (const Piece& piece : open) {
            refit(motion.over(piece.first_s, piece.last_s), bound);
            const auto first = refit.at_first(), last = refit.at_last();
            take(instant, first);
            take(instant, last);
            ++cost.intervals;
            cost.refits += 2;
            if (is_near(bound, [&](std::size_t d) { return std::max(first[d], last[d]); }))
                take(supports, bound);
            else
                doubtful.emplace_back(piece, bound);
        }
        open.clear();
        for (const auto& [piece, bounds] : doubtful) {
            const double middle = piece.first_s + (piece.last_s - piece.first_s) / 2;
            if (piece.halvings < most_halvings && cost.intervals + open.size() < most_intervals &&
                middle > piece.first_s && middle < piece.last_s &&
                !is_near(bounds, [&](std::size_t d) { return instant[d]; })) {
                open.push_back({piece.first_s, middle, piece.halvings + 1});
                open.push_back({middle, piece.last_s, piece.halvings + 1});
            } else {
                take(supports, bounds);
            }
        }
    }
    return cost;
}

} // namespace cinch
