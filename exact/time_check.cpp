// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/time_check.hpp"

#include <cmath>
#include <limits>
#include <memory>
#include <mutex>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "exact/along.hpp"

namespace cinch::exact {
namespace {

constexpr int most_halvings = 48;
// Bounds with any room at all take hundreds of pieces between two keys; one that a place touches for a while, as
// damaged ones do, would take 2^48.
constexpr std::size_t spare_pieces = 20'000, pieces_per_key = 20'000;
constexpr double infinity = std::numeric_limits<double>::infinity();

// All that places are made from, at an instant.
struct Pose {
    std::vector<MapEnclosure> maps;
    std::vector<Enclosure> weights;
};
using Maps = std::shared_ptr<const Pose>;

struct Piece {
    double a, b, piece_a, piece_b;
    int halvings;
    Maps at_a, at_b;
    std::vector<std::uint32_t> open; // places in vertices_
};

} // namespace

void TimeVerdict::add(const TimeVerdict& other)
{
    bounds += other.bounds;
    violated += other.violated;
    undecided += other.undecided;
    pieces += other.pieces;
    if (other.worst && (!worst || other.worst->at_least - other.worst->bound > worst->at_least - worst->bound))
        worst = other.worst;
}

TimeChecker::TimeChecker(const DeformableSurface& surface, const Bvh& bvh, const MotionEnclosure& clip,
                         std::span<const MorphTarget> targets, int kdop, std::function<void()> poll)
    : surface_(surface), clip_(clip), kdop_(kdop), poll_(std::move(poll)), vertices_(surface, bvh),
      displaced_(targets, surface.mesh.vertices.size())
{
}

TimeVerdict TimeChecker::operator()(double a_s, double b_s, std::span<const double> supports) const
{
    const auto k = static_cast<std::size_t>(kdop_);
    const auto axes = axes_of(kdop_);
    TimeVerdict out;
    out.bounds = supports.size();
    std::vector<double> least = vertices_.least(supports, k);
    std::vector<char> refuted(supports.size()), left_open(supports.size());
    std::mutex mutex;

    std::vector<double> cuts{a_s};
    for (const double key : clip_.keys())
        if (key > a_s && key < b_s)
            cuts.push_back(key);
    cuts.push_back(b_s);
    std::vector<Piece> pieces;
    std::vector<std::uint32_t> all(vertices_.vertex.size());
    for (std::uint32_t i = 0; i < all.size(); ++i)
        all[i] = i;
    for (std::size_t i = cuts.size() - 1; i-- > 0;)
        pieces.push_back({cuts[i], cuts[i + 1], cuts[i], cuts[i + 1], 0, nullptr, nullptr, all});
    pieces.push_back({b_s, b_s, b_s, b_s, 0, nullptr, nullptr, all}); // to which a curve may jump
    const std::size_t most_pieces = spare_pieces + pieces_per_key * pieces.size();
    std::vector<MapEnclosure> maps, slopes;
    std::vector<Enclosure> weights, weight_slopes;
    auto enclose = [&](double a, double b, const Piece& piece) {
        clip_.at(a, b, piece.piece_a, piece.piece_b, maps, slopes);
        if (displaced_.targets() > 0)
            clip_.weights_at(a, b, piece.piece_a, piece.piece_b, weights, weight_slopes);
    };
    auto maps_at = [&](double t, const Piece& piece) {
        enclose(t, t, piece);
        return std::make_shared<const Pose>(Pose{maps, weights});
    };
    while (!pieces.empty()) {
        poll_();
        Piece piece = std::move(pieces.back());
        pieces.pop_back();
        if (!piece.at_a)
            piece.at_a = maps_at(piece.a, piece);
        if (!piece.at_b)
            piece.at_b = maps_at(piece.b, piece);
        ++out.pieces;
        const double middle = piece.a + (piece.b - piece.a) / 2;
        const Maps at_middle = maps_at(middle, piece);
        enclose(piece.a, piece.b, piece);
        std::vector<char> open(piece.open.size());
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, open.size(), 256), [&](const auto& range) {
            const DirectedRounding rounding;
            const Interval step = Interval(piece.a, piece.b) - Interval(middle);
            for (std::size_t n = range.begin(); n < range.end(); ++n) {
                const std::uint32_t i = piece.open[n];
                const std::uint32_t v = vertices_.vertex[i];
                const Vec3& rest = surface_.mesh.vertices[v];
                const Place still{Interval(rest[0]), Interval(rest[1]), Interval(rest[2])};
                const Weights::Row row = surface_.weights.of(v);
                auto place = [&](const Pose& pose) {
                    Place y = still, x{Interval(0), Interval(0), Interval(0)};
                    if (displaced_.targets() > 0)
                        add_displacement(displaced_.of(v), pose.weights, y);
                    add_place(row, y, pose.maps, true, x);
                    return x;
                };
                const Place here = place(*at_middle);
                Place slope{Interval(0), Interval(0), Interval(0)}; // T′(y + e) + A e′
                if (displaced_.targets() == 0) {
                    add_place(row, still, slopes, true, slope);
                } else {
                    Place y = still, rate{Interval(0), Interval(0), Interval(0)};
                    add_displacement(displaced_.of(v), weights, y);
                    add_displacement(displaced_.of(v), weight_slopes, rate);
                    add_place(row, y, slopes, true, slope);
                    add_place(row, rate, maps, false, slope);
                }
                const bool any = clip_.has_any_weights() && !displaced_.of(v).empty();
                std::optional<Place> first, last; // at the ends
                Place swept;
                for (std::size_t r = 0; r < 3; ++r)
                    swept[r] = here[r] + slope[r] * step;
                for (std::size_t d = 0; d < k; ++d) {
                    const double limit = least[i * k + d];
                    if (limit == infinity)
                        continue;
                    auto reach = [&](const Place& x) { return along(axes[d / 2], d % 2 == 1, x); };
                    auto greatest = [&](const Pose& pose) { // over all weights
                        const Along g(row, pose.maps, axes[d / 2], d % 2 == 1);
                        return g.of(rest) + g.shift + displaced_along(g, displaced_.of(v), pose.weights, true);
                    };
                    const Interval at_centre = any ? greatest(*at_middle) : reach(here);
                    Interval rise = reach(slope);
                    if (any) {
                        const Along g(row, slopes, axes[d / 2], d % 2 == 1);
                        rise = g.of(rest) + g.shift + displaced_along(g, displaced_.of(v), weights, false);
                    }
                    if ((any ? at_centre + rise * step : reach(swept)).sup() <= limit)
                        continue;
                    if (!first) {
                        first = place(*piece.at_a);
                        last = place(*piece.at_b);
                    }
                    // Where the slope has one sign the greatest value is at an end.
                    const Interval at_first = any ? greatest(*piece.at_a) : reach(*first),
                                   at_last = any ? greatest(*piece.at_b) : reach(*last);
                    if (rise.inf() >= 0 ? at_last.sup() <= limit : rise.sup() <= 0 && at_first.sup() <= limit)
                        continue;
                    open[n] = true;
                    const double at_least = std::max({at_centre.inf(), at_first.inf(), at_last.inf()});
                    if (!(at_least > limit))
                        continue;
                    const double when = at_least == at_first.inf()  ? piece.a
                                        : at_least == at_last.inf() ? piece.b
                                                                    : middle;
                    const std::lock_guard lock(mutex);
                    for (std::uint32_t at = vertices_.row[i]; at < vertices_.row[i + 1]; ++at) {
                        const std::size_t bound = vertices_.bv[at] * k + d;
                        if (supports[bound] >= at_least)
                            continue;
                        refuted[bound] = true;
                        if (!out.worst || at_least - supports[bound] > out.worst->at_least - out.worst->bound)
                            out.worst = Outside{vertices_.bv[at], d, v, when, supports[bound], at_least};
                    }
                    least[i * k + d] = infinity; // said; other directions go on
                }
            }
        });
        std::vector<std::uint32_t> rest;
        for (std::size_t n = 0; n < open.size(); ++n)
            if (open[n])
                rest.push_back(piece.open[n]);
        if (rest.empty())
            continue;
        if (piece.halvings < most_halvings && out.pieces < most_pieces && middle > piece.a && middle < piece.b) {
            pieces.push_back(
                {middle, piece.b, piece.piece_a, piece.piece_b, piece.halvings + 1, at_middle, piece.at_b, rest});
            pieces.push_back({piece.a, middle, piece.piece_a, piece.piece_b, piece.halvings + 1, piece.at_a, at_middle,
                              std::move(rest)});
        } else {
            for (const std::uint32_t i : rest)
                for (std::uint32_t at = vertices_.row[i]; at < vertices_.row[i + 1]; ++at)
                    for (std::size_t d = 0; d < k; ++d)
                        if (least[i * k + d] < infinity)
                            left_open[vertices_.bv[at] * k + d] = true;
        }
    }
    for (std::size_t i = 0; i < refuted.size(); ++i) {
        out.violated += refuted[i] != 0;
        out.undecided += left_open[i] && !refuted[i];
    }
    return out;
}

} // namespace cinch::exact
