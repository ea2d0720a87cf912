// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/time_check.hpp"

#include <cmath>
#include <limits>
#include <memory>
#include <mutex>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "exact/number.hpp"

namespace cinch::exact {
namespace {

constexpr int most_halvings = 48;
// Bounds with any room at all take hundreds of pieces between two keys; one that a place touches for a while, as
// damaged ones do, would take 2^48.
constexpr std::size_t spare_pieces = 20'000, pieces_per_key = 20'000;
constexpr double infinity = std::numeric_limits<double>::infinity();

using Place = std::array<Interval, 3>;

Interval interval_of(const Enclosure& x) { return {x.low, x.high}; }

// Adds Σ w_j (A_j y + shift · t_j), each entry enclosed.
void add_place(const Weights::Row& row, const Place& y, const std::vector<MapEnclosure>& maps, bool shift, Place& out)
{
    for (std::size_t i = 0; i < row.node.size(); ++i) {
        const MapEnclosure& map = maps[row.node[i]];
        for (std::size_t r = 0; r < 3; ++r) {
            Interval x = shift ? interval_of(map.m[r][3]) : Interval(0);
            for (std::size_t c = 0; c < 3; ++c)
                x += interval_of(map.m[r][c]) * y[c];
            out[r] += Interval(row.weight[i]) * x;
        }
    }
}

const Place origin{Interval(0), Interval(0), Interval(0)};

// Adds Σ a_i d_i.
void add_displacement(const std::vector<std::pair<std::uint32_t, Vec3>>& by, const std::vector<Enclosure>& weights,
                      Place& out)
{
    for (const auto& [target, d] : by)
        for (std::size_t r = 0; r < 3; ++r)
            out[r] += interval_of(weights[target]) * Interval(d[static_cast<int>(r)]);
}

Interval along(const Axis& axis, bool against, const Place& x)
{
    Interval sum(0);
    for (std::size_t r = 0; r < 3; ++r)
        if (axis[r] != 0)
            sum += (axis[r] > 0) != against ? x[r] : -x[r];
    return sum;
}

// Σ w_j γᵀA_j and Σ w_j γᵀt_j.
struct Along {
    Place g = origin;
    Interval shift = Interval(0);

    Along(const Weights::Row& row, const std::vector<MapEnclosure>& maps, const Axis& axis, bool against)
    {
        for (std::size_t i = 0; i < row.node.size(); ++i)
            for (std::size_t r = 0; r < 3; ++r) {
                if (axis[r] == 0)
                    continue;
                const Interval w = (axis[r] > 0) != against ? Interval(row.weight[i]) : -Interval(row.weight[i]);
                const MapEnclosure& map = maps[row.node[i]];
                for (std::size_t c = 0; c < 3; ++c)
                    g[c] += w * interval_of(map.m[r][c]);
                shift += w * interval_of(map.m[r][3]);
            }
    }
    Interval of(const Vec3& y) const { return g[0] * Interval(y[0]) + g[1] * Interval(y[1]) + g[2] * Interval(y[2]); }
};

// Σ_i a_i g·d_i with every weight anywhere in its interval: all of it, or its greatest value.
Interval displaced_along(const Along& along, const std::vector<std::pair<std::uint32_t, Vec3>>& by,
                         const std::vector<Enclosure>& weights, bool greatest)
{
    Interval sum(0);
    for (const auto& [target, d] : by) {
        const Interval one = along.of(d), low = Interval(weights[target].low) * one,
                       high = Interval(weights[target].high) * one;
        sum += Interval(greatest ? std::max(low.inf(), high.inf()) : std::min(low.inf(), high.inf()),
                        std::max(low.sup(), high.sup()));
    }
    return sum;
}

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
    : surface_(surface), bvh_(bvh), clip_(clip), kdop_(kdop), poll_(std::move(poll))
{
    if (!targets.empty())
        displaced_.resize(surface.mesh.vertices.size());
    for (std::uint32_t i = 0; i < targets.size(); ++i)
        for (std::size_t n = 0; n < targets[i].vertex.size(); ++n)
            displaced_[targets[i].vertex[n]].push_back({i, targets[i].displacement[n]});
    std::vector<std::vector<std::uint32_t>> containing(surface.mesh.vertices.size());
    for (std::uint32_t i = 0; i < bvh.bvs.size(); ++i) {
        const Bv& bv = bvh.bvs[i];
        for (std::uint32_t t = bv.first_triangle; t < bv.first_triangle + bv.triangle_count; ++t)
            for (const std::uint32_t v : surface.mesh.triangles[bvh.triangle[t]])
                if (containing[v].empty() || containing[v].back() != i)
                    containing[v].push_back(i);
    }
    row_ = {0};
    for (std::uint32_t v = 0; v < containing.size(); ++v)
        if (!containing[v].empty()) {
            vertices_.push_back(v);
            bv_.insert(bv_.end(), containing[v].begin(), containing[v].end());
            row_.push_back(static_cast<std::uint32_t>(bv_.size()));
        }
}

TimeVerdict TimeChecker::operator()(double a_s, double b_s, std::span<const double> supports) const
{
    const auto k = static_cast<std::size_t>(kdop_);
    const auto axes = axes_of(kdop_);
    TimeVerdict out;
    out.bounds = supports.size();
    // The least support of the BVs of each vertex decides for all of them.
    std::vector<double> least(vertices_.size() * k, infinity);
    for (std::size_t i = 0; i < vertices_.size(); ++i)
        for (std::uint32_t n = row_[i]; n < row_[i + 1]; ++n)
            for (std::size_t d = 0; d < k; ++d) {
                const double support = supports[bv_[n] * k + d];
                least[i * k + d] = std::isnan(support) ? -infinity : std::min(least[i * k + d], support);
            }
    std::vector<char> refuted(supports.size()), left_open(supports.size());
    std::mutex mutex;

    std::vector<double> cuts{a_s};
    for (const double key : clip_.keys())
        if (key > a_s && key < b_s)
            cuts.push_back(key);
    cuts.push_back(b_s);
    std::vector<Piece> pieces;
    std::vector<std::uint32_t> all(vertices_.size());
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
        if (!displaced_.empty())
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
                const std::uint32_t v = vertices_[i];
                const Vec3& rest = surface_.mesh.vertices[v];
                const Place still{Interval(rest[0]), Interval(rest[1]), Interval(rest[2])};
                const Weights::Row row = surface_.weights.of(v);
                auto place = [&](const Pose& pose) {
                    Place y = still, x = origin;
                    if (!displaced_.empty())
                        add_displacement(displaced_[v], pose.weights, y);
                    add_place(row, y, pose.maps, true, x);
                    return x;
                };
                const Place here = place(*at_middle);
                Place slope = origin; // T′(y + e) + A e′
                if (displaced_.empty()) {
                    add_place(row, still, slopes, true, slope);
                } else {
                    Place y = still, rate = origin;
                    add_displacement(displaced_[v], weights, y);
                    add_displacement(displaced_[v], weight_slopes, rate);
                    add_place(row, y, slopes, true, slope);
                    add_place(row, rate, maps, false, slope);
                }
                const bool any = clip_.has_any_weights() && !displaced_.empty() && !displaced_[v].empty();
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
                        return g.of(rest) + g.shift + displaced_along(g, displaced_[v], pose.weights, true);
                    };
                    const Interval at_centre = any ? greatest(*at_middle) : reach(here);
                    Interval rise = reach(slope);
                    if (any) {
                        const Along g(row, slopes, axes[d / 2], d % 2 == 1);
                        rise = g.of(rest) + g.shift + displaced_along(g, displaced_[v], weights, false);
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
                    for (std::uint32_t at = row_[i]; at < row_[i + 1]; ++at) {
                        const std::size_t bound = bv_[at] * k + d;
                        if (supports[bound] >= at_least)
                            continue;
                        refuted[bound] = true;
                        if (!out.worst || at_least - supports[bound] > out.worst->at_least - out.worst->bound)
                            out.worst = Outside{bv_[at], d, v, when, supports[bound], at_least};
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
                for (std::uint32_t at = row_[i]; at < row_[i + 1]; ++at)
                    for (std::size_t d = 0; d < k; ++d)
                        if (least[i * k + d] < infinity)
                            left_open[bv_[at] * k + d] = true;
        }
    }
    for (std::size_t i = 0; i < refuted.size(); ++i) {
        out.violated += refuted[i] != 0;
        out.undecided += left_open[i] && !refuted[i];
    }
    return out;
}

} // namespace cinch::exact
