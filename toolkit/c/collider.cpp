// SPDX-License-Identifier: Apache-2.0
#include "cinch/collider.hpp"

#include <algorithm>
#include <map>

#include "toolkit/c/arrays.hpp"
#include "toolkit/c/call.hpp"
#include "toolkit/c/objects.hpp"
#include "toolkit/c/options.hpp"

namespace {

using namespace cinch;
using namespace cinch::c;

struct Body {
    std::shared_ptr<const Surface> surface;
    std::shared_ptr<const Tree> tree; ///< if it was given one
    bool displaced;                   ///< has morph targets
    // Of the frame, copied.
    std::vector<AffineMap> maps;
    std::vector<Vec3> positions;
    std::vector<double> weights;
};

struct Bodies {
    static constexpr Kind kind = Kind::collider;
    using Handle = cinch_collider;

    LazyOptions options;
    std::map<BodyId, Body> of;
    Collider collider; // ends before what it refers to
    std::vector<TrianglePair> pairs;
    mutable std::atomic<bool> busy{false};

    explicit Bodies(const LazyOptions& own) : options(own), collider(own) {}

    BodyId add(const DeformableSurface& surface, std::span<const MorphTarget> targets, const Bvh* bvh,
               const cinch_body_options* own)
    {
        if (!targets.empty() && (bvh || own))
            throw std::invalid_argument(
                "Collider::add: a body with morph targets has no tree and no options of its own");
        if (!targets.empty())
            return collider.add(surface, targets);
        const LazyOptions mine = options_of(own, options);
        return bvh ? collider.add(*bvh, surface, mine) : collider.add(surface, mine);
    }

    void update(std::span<const cinch_body_frame> frames);

    // Queries say so until the next update().
    void forget_frame()
    {
        try {
            collider.update({});
        } catch (const std::invalid_argument&) { // no frame per body
        }
    }
};

template <class T> void copy_to(std::span<const T> from, std::vector<T>& to) { to.assign(from.begin(), from.end()); }

struct Given {
    std::span<const AffineMap> maps;
    std::span<const Vec3> positions;
    std::span<const double> weights;
};

Given checked(const cinch_body_frame& in, const Body& body)
{
    const std::size_t nodes = body.surface->nodes(), vertices = body.surface->surface->mesh.vertices.size(),
                      targets = body.displaced ? body.surface->targets->size() : 0;
    const bool placed = in.position_count > 0;
    if (placed && in.position_count != vertices)
        throw std::invalid_argument("LazyRefit::begin: one position per vertex is needed");
    if (in.map_count != nodes && !(placed && in.map_count == 0))
        throw std::invalid_argument("refit: one transform per simulation node is needed");
    if (in.weight_count != targets && !(placed && in.weight_count == 0))
        throw std::invalid_argument("LazyRefit::begin: one weight per morph target is needed");
    return {array<AffineMap>(in.maps, in.map_count, "maps"), array<Vec3>(in.positions, in.position_count, "positions"),
            array<double>(in.weights, in.weight_count, "weights")};
}

void Bodies::update(std::span<const cinch_body_frame> frames)
{
    if (frames.size() != of.size())
        throw std::invalid_argument("Collider::update: one frame per body is needed");
    std::vector<BodyFrame> copied;
    auto body = of.begin();
    for (const cinch_body_frame& frame : frames) {
        Body& to = (body++)->second;
        const Given from = checked(frame, to);
        copy_to(from.maps, to.maps);
        copy_to(from.positions, to.positions);
        copy_to(from.weights, to.weights);
        copied.push_back({to.maps, to.positions, to.weights});
    }
    collider.update(copied);
}

} // namespace

cinch_status cinch_collider_new(const cinch_body_options* options, cinch_collider** collider)
{
    return call([&] {
        given(collider, "collider") = nullptr;
        *collider = put(std::make_shared<Bodies>(options_of(options)));
    });
}

cinch_status cinch_collider_add(cinch_collider* collider, const cinch_surface* surface, const cinch_bvh* bvh,
                                const cinch_body_options* own, uint32_t* id)
{
    return call([&] {
        const auto all = get<Bodies>(collider);
        const InUse use(all->busy, Kind::collider);
        const auto of = get<Surface>(surface);
        const auto tree = bvh ? get<Tree>(bvh) : nullptr;
        if (tree && tree->of->surface != of->surface)
            throw std::invalid_argument("Collider::add: the tree is that of another surface");
        BodyId& out = given(id, "id");
        out = all->add(*of->surface, *of->targets, tree ? &tree->bvh : nullptr, own);
        all->pairs.clear();
        try {
            all->of[out] = {of, tree, !of->targets->empty(), {}, {}, {}};
        } catch (...) { // nothing keeps what it refers to
            all->collider.remove(out);
            throw;
        }
    });
}

cinch_status cinch_collider_remove(cinch_collider* collider, uint32_t id)
{
    return call([&] {
        const auto all = get<Bodies>(collider);
        const InUse use(all->busy, Kind::collider);
        all->collider.remove(id);
        all->pairs.clear();
        all->of.erase(id);
    });
}

cinch_status cinch_collider_get_bodies(const cinch_collider* collider, int32_t unknown, uint32_t* ids, size_t capacity,
                                       size_t* count)
{
    return call([&] {
        const auto all = get<Bodies>(collider);
        const InUse use(all->busy, Kind::collider);
        if (flag(unknown, "unknown"))
            write_list<std::uint32_t>(all->collider.unknown(), ids, capacity, count);
        else
            write_list<std::uint32_t>(all->collider.bodies(), ids, capacity, count);
    });
}

cinch_status cinch_collider_set_filter(cinch_collider* collider, cinch_filter filter, void* context)
{
    return call([&] {
        const auto all = get<Bodies>(collider);
        const InUse use(all->busy, Kind::collider);
        if (filter)
            all->collider.set_filter([=](BodyId a, BodyId b) { return filter(context, a, b) != 0; });
        else
            all->collider.set_filter({});
    });
}

cinch_status cinch_collider_update(cinch_collider* collider, const cinch_body_frame* frames, size_t count)
{
    return call([&] {
        const auto all = get<Bodies>(collider);
        const InUse use(all->busy, Kind::collider);
        all->pairs.clear();
        try {
            all->update(array<cinch_body_frame>(frames, count, "frames"));
        } catch (...) {
            all->forget_frame();
            throw;
        }
    });
}

cinch_status cinch_collider_query(cinch_collider* collider, int32_t query, size_t* count)
{
    return call([&] {
        const auto all = get<Bodies>(collider);
        const InUse use(all->busy, Kind::collider);
        given(count, "count") = 0;
        if (query < CINCH_QUERY_PAIRS || query > CINCH_QUERY_LEAVES)
            throw std::invalid_argument("there is no query " + std::to_string(query));
        constexpr Query queries[] = {Query::pairs, Query::any, Query::leaves};
        all->pairs.clear();
        all->collider.find(queries[query], [&](std::span<const TrianglePair> some) {
            const bool one = query == CINCH_QUERY_ANY;
            all->pairs.insert(all->pairs.end(), some.begin(), one && !some.empty() ? some.begin() + 1 : some.end());
            return !one;
        });
        *count = all->pairs.size();
    });
}

cinch_status cinch_collider_get_pairs(const cinch_collider* collider, uint32_t* pairs, size_t count)
{
    return call([&] {
        const auto all = get<Bodies>(collider);
        const InUse use(all->busy, Kind::collider);
        using Row = std::array<std::uint32_t, 4>;
        const auto out = array_of<Row>(pairs, count, all->pairs.size(), "pairs");
        std::transform(all->pairs.begin(), all->pairs.end(), out.begin(), [](const TrianglePair& pair) {
            return Row{pair.body_a, pair.triangle_a, pair.body_b, pair.triangle_b};
        });
    });
}

cinch_status cinch_collider_get_counts(const cinch_collider* collider, cinch_query_counts* counts)
{
    return call([&] {
        const auto all = get<Bodies>(collider);
        const InUse use(all->busy, Kind::collider);
        const QueryCounts& c = all->collider.counts();
        given(counts, "counts") = {c.body_pairs,       c.box_tests,     c.leaf_pairs,     c.triangle_tests,
                                   c.in_double,        c.in_exact,      c.updates.bounds, c.updates.leaves,
                                   c.updates.vertices, c.updates.merged};
    });
}

cinch_status cinch_swept_leaf_pairs(const cinch_swept_body* bodies, size_t body_count, int32_t kdop, uint32_t* pairs,
                                    size_t capacity, size_t* count)
{
    return call([&] {
        const int k = kdop_of(kdop);
        const auto in = array<cinch_swept_body>(bodies, body_count, "bodies");
        std::vector<std::shared_ptr<const Tree>> trees;
        std::vector<SweptBody> swept;
        for (const cinch_swept_body& body : in) {
            trees.push_back(get<Tree>(body.bvh));
            const auto supports =
                array<double>(body.supports, times(body.support_count, static_cast<std::size_t>(k)), "supports");
            if (std::any_of(supports.begin(), supports.end(), [](double s) { return s != s; }))
                throw std::invalid_argument("swept: a support is no number");
            swept.push_back({&trees.back()->bvh, supports});
        }
        std::vector<std::array<std::uint32_t, 4>> all;
        for (const LeafPair& pair : swept_leaf_pairs(swept, k))
            all.push_back({pair.body_a, pair.leaf_a, pair.body_b, pair.leaf_b});
        write_list<std::array<std::uint32_t, 4>>(all, pairs, capacity, count);
    });
}
