// SPDX-License-Identifier: Apache-2.0
#include "toolkit/collide/collider_parts.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "cinch/bounds.hpp"
#include "cinch/environment.hpp"
#include "toolkit/bounds/rounding.hpp"
#include "toolkit/collide/exact_pair.hpp"
#include "toolkit/deform/parallel.hpp"
#include "toolkit/hierarchy/lazy_refit.hpp"

namespace cinch {
namespace {

constexpr std::size_t tests_per_task = 512, clusters_per_task = 128, tasks_at_once = 64;

/// What must not be less than the truth, where two opposite infinities met.
double outward(double x) { return std::isnan(x) ? infinite : x; }

} // namespace

BodyId Collider::Parts::add(const Bvh& bvh, std::unique_ptr<const Bvh> own_bvh, const DeformableSurface& surface,
                            const LazyOptions& own, std::span<const MorphTarget> targets)
{
    if (own.kdop != options_.kdop || own.lanes != options_.lanes || own.keep_cut != options_.keep_cut)
        throw std::invalid_argument("Collider::add: kdop, lanes and keep_cut must be those of the collider");
    bodies_.push_back({std::move(own_bvh), &surface});
    ids_.push_back(next_id_);
    try {
        trees_.emplace_back(bvh, surface, own, targets);
    } catch (...) { // as if nothing had been added
        bodies_.pop_back();
        ids_.pop_back();
        throw;
    }
    no_frame_ = "after add()";
    return next_id_++;
}

void Collider::Parts::remove(BodyId body)
{
    const auto id = std::lower_bound(ids_.begin(), ids_.end(), body);
    if (id == ids_.end() || *id != body)
        throw std::invalid_argument("Collider::remove: there is no body " + std::to_string(body));
    const auto place = id - ids_.begin();
    std::vector<LazyRefit> trees; // they cannot be assigned
    for (std::size_t i = 0; i < trees_.size(); ++i)
        if (static_cast<std::ptrdiff_t>(i) != place)
            trees.push_back(std::move(trees_[i]));
    trees_ = std::move(trees);
    bodies_.erase(bodies_.begin() + place);
    ids_.erase(id);
    fronts_.clear(); // of pairs of places
    unknown_.clear();
    no_frame_ = "after remove()";
}

void Collider::Parts::require_frame() const
{
    if (no_frame_)
        throw std::logic_error(std::string("Collider: a query ") + no_frame_ +
                               "; call update() with one frame per body first");
}

const std::vector<std::uint32_t>& Collider::Parts::unknown() const
{
    require_frame();
    return unknown_;
}

std::size_t Collider::Parts::bytes() const
{
    std::size_t bytes = 0;
    for (const LazyRefit& tree : trees_)
        bytes += tree.bytes();
    for (const Body& body : bodies_)
        bytes += body.bvh ? body.bvh->bytes() : 0;
    return bytes;
}

void Collider::Parts::update(std::span<const BodyFrame> frames)
{
    no_frame_ = "after an update() that threw";
    if (frames.size() != trees_.size())
        throw std::invalid_argument("Collider::update: one frame per body is needed");
    require_default_arithmetic();
    parallel_blocks(trees_.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
            trees_[i].begin(frames[i]);
    });
    counts_ = {};
    unknown_.clear();
    for (std::uint32_t i = 0; i < trees_.size(); ++i)
        if (!trees_[i].known())
            unknown_.push_back(ids_[i]);
    no_frame_ = nullptr;
}

// Sweeps over the roots' intervals along x, and tests the whole k-DOPs of those that overlap.
void Collider::Parts::sweep()
{
    struct Interval {
        double low, high;
        std::uint32_t body;
    };
    std::vector<Interval> intervals;
    const std::size_t side = dop_side(options_.kdop);
    for (std::uint32_t i = 0; i < trees_.size(); ++i)
        if (!trees_[i].empty() && trees_[i].known()) {
            const double high = static_cast<double>(trees_[i].dop(0)[0]),
                         low = -static_cast<double>(trees_[i].dop(0)[side]), o = trees_[i].origin()[0];
            intervals.push_back({-outward(o == 0 ? -low : succ(-low - o)), outward(o == 0 ? high : succ(high + o)), i});
        }
    std::sort(intervals.begin(), intervals.end(), [](const Interval& x, const Interval& y) {
        return x.low < y.low || (x.low == y.low && x.body < y.body);
    });
    std::vector<std::pair<std::uint32_t, std::uint32_t>> found;
    for (std::size_t i = 0; i < intervals.size(); ++i)
        for (std::size_t j = i + 1; j < intervals.size() && !(intervals[i].high < intervals[j].low); ++j)
            found.push_back(std::minmax(intervals[i].body, intervals[j].body));
    std::sort(found.begin(), found.end());

    level_.clear();
    active_ = 0;
    for (const auto& [a, b] : found) {
        if (wanted_ && !wanted_(ids_[a], ids_[b]))
            continue;
        if (active_ == pairs_.size())
            pairs_.emplace_back();
        BodyPair& pair = pairs_[active_];
        pair.a = a;
        pair.b = b;
        set_shift(pair);
        ++counts_.box_tests;
        const BoxTest roots{0, 0};
        BvPair overlapping[4];
        if (test_boxes({side, trees_[a].dop(0), trees_[b].dop(0), pair.shift.data()}, {&roots, 1}, overlapping) ==
            overlapping)
            continue;
        ++active_;
        pair.leaves.clear();
        pair.tested = 0;
        pair.begin = level_.size();
        if (trees_[a].link(0).is_leaf() && trees_[b].link(0).is_leaf())
            pair.leaves.push_back({0, 0});
        else
            level_.push_back({0, 0});
        pair.end = level_.size();
    }
    counts_.body_pairs = active_;
}

// For a direction d the supports A and B about the origins O_a and O_b are apart if A(d) + B(−d) + d·(O_a − O_b) < 0.
// The kernel tests fl(A + B) + shift < 0 instead, s = fl(A + B) being off by u|s|: with |s| ≥ 2|shift| that does no
// harm to the sign, else it is at most 2u|shift|. Where A + B or the shift overflows: an infinity from rounding up
// keeps its pair, as infinity and NaN are not < 0; fl(A + B) = −∞ with a finite shift is right, as A + B < −2^128 +
// 2^103 and the shift is at most 2^128 − 2^104; a shift below −2^128 is −∞, and succ of it NaN. Where they underflow
// sums are exact, and succ rounds up what a conversion to float loses.
void Collider::Parts::set_shift(BodyPair& pair) const
{
    const std::size_t side = dop_side(options_.kdop);
    const auto axes = axes_of(options_.kdop);
    const Vec3 &a = trees_[pair.a].origin(), &b = trees_[pair.b].origin();
    pair.shift.assign(2 * side, 0.0f);
    double furthest = 0;
    for (std::size_t r = 0; r < 3; ++r)
        furthest = std::max({furthest, std::abs(a[static_cast<int>(r)]), std::abs(b[static_cast<int>(r)])});
    pair.clusters = {trees_[pair.a].lanes(), side, {0, 0, 0}, 0};
    if (a == b)
        return;
    const double rounded = 8 * unit_roundoff * 6 * furthest; // of the differences and their sums in double
    for (std::size_t d = 0; d < axes.size(); ++d) {
        double along = 0;
        for (int r = 0; r < 3; ++r)
            along += axes[d][static_cast<std::size_t>(r)] * (a[r] - b[r]);
        auto up = [&](double x) {
            return succ(succ(static_cast<float>(succ(x + rounded))) +
                        4 * unit_roundoff_of<float> * std::abs(static_cast<float>(x)));
        };
        pair.shift[d] = up(along);
        pair.shift[side + d] = up(-along);
    }
    for (int r = 0; r < 3; ++r) {
        const double from_a = b[r] - a[r];
        const float shift = static_cast<float>(from_a);
        pair.clusters.shift[r] = shift;
        const double error =
            outward(std::abs(from_a - static_cast<double>(shift)) + rounded); // infinite where the shift is
        pair.clusters.shift_error = std::max(pair.clusters.shift_error, succ(static_cast<float>(succ(error))));
    }
}

void Collider::Parts::descend()
{
    tests_.clear();
    for (std::size_t p = 0; p < active_; ++p) {
        BodyPair& pair = pairs_[p];
        LazyRefit &a = trees_[pair.a], &b = trees_[pair.b];
        const std::size_t begin = tests_.size();
        for (std::size_t i = pair.begin; i < pair.end; ++i) {
            const BvPair& bvs = level_[i];
            const BoxTest test = children_of_pair(a, b, bvs);
            if (test.a & BoxTest::both)
                a.expand(bvs.a);
            if (test.b & BoxTest::both)
                b.expand(bvs.b);
            tests_.push_back(test);
        }
        pair.begin = begin;
        pair.end = tests_.size();
    }
    parallel_blocks(trees_.size(), trees_.size() > 1 && tests_.size() > 1000 ? 1 : trees_.size(),
                    [&](std::size_t first, std::size_t last) {
                        for (std::size_t i = first; i < last; ++i)
                            trees_[i].supply();
                    });
    test_level();
}

// From tests_ to the pairs that overlap: leaves, and the next level_.
void Collider::Parts::test_level()
{
    std::size_t pieces = 0;
    for (std::size_t p = 0; p < active_; ++p)
        for (std::size_t begin = pairs_[p].begin; begin < pairs_[p].end; begin += tests_per_task, ++pieces) {
            if (pieces == pieces_.size())
                pieces_.emplace_back();
            pieces_[pieces].pair = p;
            pieces_[pieces].begin = begin;
            pieces_[pieces].end = std::min(pairs_[p].end, begin + tests_per_task);
        }
    overlapping_.resize(4 * tests_.size());
    found_in_.resize(pieces);
    parallel_blocks(pieces, pieces < 4 ? pieces : 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            const Piece& piece = pieces_[i];
            const BodyPair& pair = pairs_[piece.pair];
            BvPair* const out = &overlapping_[4 * piece.begin];
            const BoxInput input{dop_side(options_.kdop), trees_[pair.a].dop(0), trees_[pair.b].dop(0),
                                 pair.shift.data()};
            found_in_[i] = static_cast<std::size_t>(
                test_boxes(input, std::span(tests_).subspan(piece.begin, piece.end - piece.begin), out) - out);
        }
    });
    level_.clear();
    for (std::size_t p = 0, i = 0; p < active_; ++p) {
        BodyPair& pair = pairs_[p];
        const LazyRefit &a = trees_[pair.a], &b = trees_[pair.b];
        pair.begin = level_.size();
        for (; i < pieces && pieces_[i].pair == p; ++i)
            for (const BvPair& bvs : std::span(overlapping_).subspan(4 * pieces_[i].begin, found_in_[i]))
                (a.link(bvs.a).is_leaf() && b.link(bvs.b).is_leaf() ? pair.leaves : level_).push_back(bvs);
        pair.end = level_.size();
    }
    for (const BoxTest& test : tests_)
        counts_.box_tests += (test.a & BoxTest::both ? 2u : 1u) * (test.b & BoxTest::both ? 2u : 1u);
}

void Collider::Parts::follow_fronts()
{
    std::map<std::pair<std::uint32_t, std::uint32_t>, PairFront> kept; // of the pairs of bodies that overlap now
    for (std::size_t p = 0; p < active_; ++p) {
        BodyPair& pair = pairs_[p];
        LazyRefit &a = trees_[pair.a], &b = trees_[pair.b];
        PairFront& front = kept[{pair.a, pair.b}] = std::move(fronts_[{pair.a, pair.b}]);
        counts_.box_tests +=
            front.advance(a, b, {dop_side(options_.kdop), a.dop(0), b.dop(0), pair.shift.data()}, pair.leaves);
    }
    fronts_ = std::move(kept);
    level_.clear();
}

bool Collider::Parts::find(Query query, const Sink& sink)
{
    require_frame();
    require_default_arithmetic();
    sweep();
    bool found = false, go_on = true;
    auto tell = [&](std::span<const TrianglePair> some) {
        found = true;
        return go_on = sink(some) && query != Query::any;
    };
    if (!options_.keep_cut)
        follow_fronts();
    while (!level_.empty()) {
        descend();
        if (query == Query::any && !test_leaves(query, tell))
            break;
    }
    for (std::size_t p = 0; p < active_; ++p)
        counts_.leaf_pairs += pairs_[p].leaves.size();
    if (go_on && query == Query::leaves)
        list_leaves(tell);
    else if (go_on)
        test_leaves(query, tell);
    counts_.updates = {}; // trees count from the beginning of the frame
    for (const LazyRefit& tree : trees_) {
        counts_.updates.bounds += tree.counts().bounds;
        counts_.updates.leaves += tree.counts().leaves;
        counts_.updates.vertices += tree.counts().vertices;
        counts_.updates.merged += tree.counts().merged;
    }
    return found;
}

// The leaf pairs that were not tested yet, a few tasks' worth at a time. False once the sink has had enough.
bool Collider::Parts::test_leaves(Query query, const Sink& sink)
{
    for (std::size_t p = 0; p < active_; ++p)
        for (std::size_t i = pairs_[p].tested; i < pairs_[p].leaves.size(); ++i) {
            trees_[pairs_[p].a].want_slot(pairs_[p].leaves[i].a);
            trees_[pairs_[p].b].want_slot(pairs_[p].leaves[i].b);
        }
    for (LazyRefit& tree : trees_)
        tree.supply();
    const std::size_t at_once = query == Query::any ? 1 : tasks_at_once;
    for (std::size_t p = 0; p < active_;) {
        std::size_t pieces = 0;
        for (; p < active_ && pieces < at_once; p += pairs_[p].tested == pairs_[p].leaves.size()) {
            BodyPair& pair = pairs_[p];
            if (pair.tested == pair.leaves.size())
                continue;
            if (pieces == pieces_.size())
                pieces_.emplace_back();
            Piece& piece = pieces_[pieces++];
            piece.pair = p;
            piece.begin = pair.tested;
            piece.end = pair.tested = std::min(pair.leaves.size(), pair.tested + clusters_per_task);
        }
        parallel_blocks(pieces, 1, [&](std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i)
                test_piece(pieces_[i]);
        });
        for (const Piece& piece : std::span(pieces_).first(pieces)) {
            counts_.triangle_tests += piece.counts.triangle_tests;
            counts_.in_double += piece.counts.in_double;
            counts_.in_exact += piece.counts.in_exact;
            if (!piece.found.empty() &&
                !sink(query == Query::any ? std::span(piece.found).first(1) : std::span(piece.found)))
                return false;
        }
    }
    return true;
}

void Collider::Parts::test_piece(Piece& piece) const
{
    const BodyPair& pair = pairs_[piece.pair];
    const LazyRefit &a = trees_[pair.a], &b = trees_[pair.b];
    const auto leaves = std::span(pair.leaves).subspan(piece.begin, piece.end - piece.begin);
    piece.clusters.clear();
    piece.hits.clear();
    piece.found.clear();
    piece.counts = {};
    for (const BvPair& leaf : leaves)
        piece.clusters.push_back({a.slot(leaf.a), b.slot(leaf.b), a.dop(leaf.a), b.dop(leaf.b),
                                  a.leaf(leaf.a).triangles, b.leaf(leaf.b).triangles});
    test_clusters(pair.clusters, piece.clusters, 0, piece.hits, piece.counts.triangle_tests);
    ExactPair exact(*bodies_[pair.a].surface, a.frame(), *bodies_[pair.b].surface, b.frame());
    for (const TriangleHit& hit : piece.hits) {
        const TrianglePair triangles{ids_[pair.a], a.triangle(a.leaf(leaves[hit.pair].a).first_triangle + hit.i),
                                     ids_[pair.b], b.triangle(b.leaf(leaves[hit.pair].b).first_triangle + hit.j)};
        if (!hit.doubtful || exact.intersect(triangles.triangle_a, triangles.triangle_b))
            piece.found.push_back(triangles);
    }
    piece.counts.in_double = exact.in_double();
    piece.counts.in_exact = exact.in_exact();
}

bool Collider::Parts::list_leaves(const Sink& sink) const
{
    std::vector<TrianglePair> some;
    for (std::size_t p = 0; p < active_; ++p) {
        const BodyPair& pair = pairs_[p];
        const LazyRefit &a = trees_[pair.a], &b = trees_[pair.b];
        some.clear();
        for (const BvPair& leaf : pair.leaves)
            some.push_back({ids_[pair.a], a.triangle(a.leaf(leaf.a).first_triangle), ids_[pair.b],
                            b.triangle(b.leaf(leaf.b).first_triangle)});
        if (!some.empty() && !sink(some))
            return false;
    }
    return true;
}

} // namespace cinch
