// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "toolkit/c/arrays.hpp"
#include "toolkit/c/call.hpp"
#include "toolkit/c/character.hpp"
#include "toolkit/c/options.hpp"

namespace {

using namespace cinch;
using namespace cinch::c;

struct Times {
    static constexpr Kind kind = Kind::clip_bounder;
    using Handle = cinch_clip_bounder;

    std::shared_ptr<const CharacterFile> character;
    std::shared_ptr<const Tree> tree;
    std::size_t k;
    ClipBounder bound;
    std::atomic<bool> busy{false};

    Times(std::shared_ptr<const CharacterFile> of, std::size_t clip, std::shared_ptr<const Tree> over,
          const RefitOptions& options)
        : character(std::move(of)), tree(std::move(over)), k(static_cast<std::size_t>(options.kdop)),
          bound(character->character, character->clip(clip), *tree->of->surface, tree->bvh, options)
    {
    }
};

} // namespace

cinch_status cinch_clip_bounder_new(const cinch_character* character, size_t clip, const cinch_bvh* bvh,
                                    const cinch_refit_options* options, cinch_clip_bounder** bounder)
{
    return call([&] {
        given(bounder, "bounder") = nullptr;
        const auto of = get<CharacterFile>(character);
        const auto tree = get<Tree>(bvh);
        if (tree->of != of->surface)
            throw std::invalid_argument("the tree is not one of the character's surface");
        *bounder = put(std::make_shared<Times>(of, clip, tree, options_of(options)));
    });
}

cinch_status cinch_clip_bounder_bound(cinch_clip_bounder* bounder, const double* times_s, size_t intervals,
                                      double tolerance, double* supports, size_t support_count)
{
    return call([&] {
        const auto of = get<Times>(bounder);
        const InUse use(of->busy, Kind::clip_bounder);
        const std::size_t bvs = of->tree->bvh.bvs.size(), k = of->k;
        if (!(tolerance >= 0 && std::isfinite(tolerance)))
            throw std::invalid_argument("tolerance must be 0 or more, and finite");
        const auto when = array<std::array<double, 2>>(times_s, intervals, "times");
        if (support_count != times(intervals, bvs))
            throw std::invalid_argument("supports has " + std::to_string(support_count) + " rows; the BVs need " +
                                        std::to_string(times(intervals, bvs)));
        const auto out = array<double>(supports, times(support_count, k), "supports");
        for (std::size_t i = 0; i < intervals; ++i)
            of->bound(when[i][0], when[i][1], out.subspan(i * bvs * k, bvs * k), tolerance);
    });
}
