// SPDX-License-Identifier: Apache-2.0
#include "cinch/refit.hpp"

#include "toolkit/c/arrays.hpp"
#include "toolkit/c/call.hpp"
#include "toolkit/c/objects.hpp"
#include "toolkit/c/options.hpp"

namespace {

using namespace cinch;
using namespace cinch::c;

struct Refit {
    static constexpr Kind kind = Kind::refitter;
    using Handle = cinch_refitter;

    std::shared_ptr<const Tree> tree;
    std::size_t k;
    Refitter refit;
    std::atomic<bool> busy{false};

    Refit(std::shared_ptr<const Tree> of, const RefitOptions& options)
        : tree(std::move(of)), k(static_cast<std::size_t>(options.kdop)),
          refit(tree->bvh, *tree->of->surface, options, *tree->of->targets)
    {
    }
};

struct Crowd {
    static constexpr Kind kind = Kind::crowd;
    using Handle = cinch_crowd;

    CrowdRefitter refit; // copies what it needs
};

} // namespace

cinch_status cinch_refitter_new(const cinch_bvh* bvh, const cinch_refit_options* options, cinch_refitter** refitter)
{
    return call([&] {
        given(refitter, "refitter") = nullptr;
        *refitter = put(std::make_shared<Refit>(get<Tree>(bvh), options_of(options)));
    });
}

cinch_status cinch_refitter_refit(cinch_refitter* refitter, size_t frames, const double* maps, size_t map_count,
                                  const double* weights, size_t weight_count, double* supports, size_t support_count,
                                  cinch_refit_report* reports)
{
    return call([&] {
        const auto of = get<Refit>(refitter);
        const InUse use(of->busy, Kind::refitter);
        const std::size_t nodes = of->tree->of->nodes(), targets = of->tree->of->targets->size(),
                          bvs = of->tree->bvh.bvs.size();
        // In the library's sentences, for all frames.
        if (map_count != times(frames, nodes))
            throw std::invalid_argument("refit: one transform per simulation node is needed");
        if (weight_count != 0 && weight_count != times(frames, targets))
            throw std::invalid_argument("refit: one weight per morph target is needed, or none");
        if (support_count != times(frames, bvs))
            throw std::invalid_argument("refit: supports needs k places per BV");
        const auto moved = array<AffineMap>(maps, map_count, "maps");
        const auto by = array<double>(weights, weight_count, "weights");
        const auto out = array<double>(supports, times(support_count, of->k), "supports");
        const auto said = array<cinch_refit_report>(reports, reports ? frames : 0, "reports");
        for (std::size_t f = 0; f < frames; ++f) {
            const RefitReport report = of->refit(moved.subspan(f * nodes, nodes),
                                                 by.subspan(weight_count ? f * targets : 0, weight_count ? targets : 0),
                                                 out.subspan(f * bvs * of->k, bvs * of->k));
            if (reports)
                said[f] = {report.unbounded_nodes, report.infinite};
        }
    });
}

cinch_status cinch_crowd_new(const cinch_bvh* bvh, const cinch_crowd_options* options, cinch_crowd** crowd)
{
    return call([&] {
        given(crowd, "crowd") = nullptr;
        const auto tree = get<Tree>(bvh);
        *crowd = put(std::make_shared<Crowd>(Crowd{CrowdRefitter(tree->bvh, *tree->of->surface, options_of(options))}));
    });
}

cinch_status cinch_crowd_get_bvs(const cinch_crowd* crowd, uint32_t* bvs, size_t capacity, size_t* count)
{
    return call([&] { write_list<std::uint32_t>(get<Crowd>(crowd)->refit.bvs(), bvs, capacity, count); });
}

cinch_status cinch_crowd_refit(const cinch_crowd* crowd, const double* maps, size_t map_count, double* boxes,
                               size_t box_count)
{
    return call([&] {
        const auto of = get<Crowd>(crowd);
        of->refit(array<AffineMap>(maps, map_count, "maps"), array<Aabb>(boxes, box_count, "boxes"));
    });
}
