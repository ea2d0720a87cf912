// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/verify_lazy.hpp"

#include <algorithm>
#include <limits>

#include "cinch/collider.hpp"
#include "cinch/surface.hpp"
#include "exact/absolute.hpp"
#include "exact/check_failed.hpp"
#include "experiments/report/interrupt.hpp"
#include "experiments/report/progress.hpp"
#include "toolkit/collide/collider_parts.hpp"
#include "toolkit/hierarchy/lazy_refit.hpp"

namespace cinch {
namespace {

void require_fitting(const Inputs& inputs, const VerifyOptions& options)
{
    if (inputs.bodies.size() < 2)
        throw InputError("--update other than refit is driven by a query between bodies: it needs a scene of at least "
                         "two (santa-ring-1, fishes)");
    if (!options.certificate.empty() || !options.vipr.empty() || options.volume || options.remember ||
        options.passes != 1)
        throw InputError("--certificate, --vipr, --volume, --remember and --passes go with --update refit only");
    if (options.leaf > 16)
        throw InputError("--update other than refit needs leaves of at most 16 triangles");
    if (options.sabotage == Sabotage::no_rounding)
        throw InputError("--sabotage no-rounding goes with --update refit only");
}

LazyOptions lazy_options(const VerifyOptions& options)
{
    LazyOptions lazy;
    lazy.methods = options.methods;
    lazy.kdop = options.kdop;
    lazy.precision = options.precision;
    lazy.rest_shape = options.rest_shape;
    lazy.update = options.update == VerifiedUpdate::full ? Update::full : Update::lazy;
    lazy.keep_cut = options.update != VerifiedUpdate::front;
    lazy.lanes = options.leaf <= 4 ? 4 : options.leaf <= 8 ? 8 : 16;
    return lazy;
}

// One body's BVs in a frame.
class Proof {
public:
    Proof(const Input& input, Bvh&& bvh)
        : bvh_(std::move(bvh)), verifier_(input.surface, bvh_, throw_if_interrupted), current_(bvh_.bvs.size())
    {
    }

    const Bvh& bvh() const { return bvh_; }

    // After the update: an inner BV whose children are current came from them; else it waits for the query at the cut.
    void note_merged(const LazyRefit& tree)
    {
        merged_ = 0;
        for (std::uint32_t bv = 0; bv < bvh_.bvs.size(); ++bv)
            merged_ += tree.current(bv) && !bvh_.bvs[bv].is_leaf() && tree.current(bvh_.bvs[bv].first_child);
    }

    // After the query.
    void check(const LazyRefit& tree, std::span<const AffineMap> maps, const VerifyOptions& options,
               VerifyTotals& totals, LazyTotals& lazy)
    {
        const auto k = static_cast<std::size_t>(options.kdop);
        std::vector<double> supports(bvh_.bvs.size() * k, std::numeric_limits<double>::infinity());
        std::vector<float> relative(k);
        std::size_t current = 0, leaves = 0;
        for (std::uint32_t bv = 0; bv < bvh_.bvs.size(); ++bv) {
            current_[bv] = tree.current(bv);
            if (!current_[bv])
                continue;
            ++current;
            leaves += bvh_.bvs[bv].is_leaf();
            for (std::size_t d = 0; d < k; ++d)
                relative[d] = tree.dop(bv)[d % 2 * dop_side(options.kdop) + d / 2];
            exact::absolute_supports(options.kdop, relative, tree.origin(), std::span(supports).subspan(bv * k, k));
        }
        const std::size_t deformed =
            tree.counts().leaves; // after a full update once more where their vertices are wanted too
        if (tree.counts().merged != merged_ || (tree.fully_refitted() ? deformed < leaves : deformed != leaves) ||
            tree.counts().bounds != current - merged_ - leaves)
            throw CheckFailed("the lazy update's own counts differ from the BVs that are current");
        lazy.merged += merged_;
        lazy.from_vertices += leaves;
        lazy.by_methods += current - merged_ - leaves;
        lazy.left += bvh_.bvs.size() - current;
        if (options.sabotage == Sabotage::stale)
            supports.swap(before_); // those of the last frame; in the first nothing is known, which is right
        if (supports.empty())
            supports.assign(bvh_.bvs.size() * k, std::numeric_limits<double>::infinity());
        add(bvh_, verifier_.check(maps, Method::vertices, options.kdop, supports), options.kdop, current_, totals);
        totals.infinite += static_cast<std::size_t>(std::count_if(supports.begin(), supports.end(),
                                                                  [](double s) { return std::isinf(s); })) -
                           k * (bvh_.bvs.size() - current);
    }

private:
    Bvh bvh_;
    exact::Verifier verifier_;
    std::vector<char> current_;
    std::vector<double> before_;
    std::size_t merged_ = 0;
};

} // namespace

void verify_lazy(const Inputs& inputs, const VerifyOptions& options, VerifyTotals& totals, LazyTotals& lazy)
{
    require_fitting(inputs, options);
    const LazyOptions query_options = lazy_options(options);
    Collider collider(query_options);
    std::vector<std::unique_ptr<Proof>> proofs;
    for (const Input& body : inputs.bodies) {
        Bvh bvh = options.leaf == 1 ? build_bvh(body.surface, 1)
                                    : build_bvh(body.surface, ClusterSize{options.leaf, query_options.lanes});
        damage(bvh, options.sabotage);
        proofs.push_back(std::make_unique<Proof>(body, std::move(bvh)));
        collider.add(proofs.back()->bvh(), body.surface);
        throw_if_interrupted();
    }
    Progress progress("verifying frames", totals.frames_wanted);
    std::vector<BodyFrame> frames(inputs.bodies.size());
    std::vector<Clip::Frame> maps(inputs.bodies.size());
    for (std::size_t f = 0; f < inputs.bodies[0].clip.frame_count(); ++f) {
        throw_if_interrupted();
        for (std::size_t b = 0; b < frames.size(); ++b) {
            maps[b] = inputs.bodies[b].clip.frame(f);
            frames[b] = {maps[b]};
        }
        collider.update(frames);
        for (std::size_t b = 0; b < frames.size(); ++b)
            proofs[b]->note_merged(collider.parts().trees()[b]);
        VerifyTotals now = totals; // kept if the frame is whole, all bodies of it
        LazyTotals lazy_now = lazy;
        lazy_now.pairs += collider.pairs().size();
        for (std::size_t b = 0; b < frames.size(); ++b) {
            if (f == 0)
                add_levels(proofs[b]->bvh(), now);
            proofs[b]->check(collider.parts().trees()[b], frames[b].maps, options, now, lazy_now);
        }
        totals = std::move(now);
        lazy = lazy_now;
        progress.done(totals.frames);
    }
}

} // namespace cinch
