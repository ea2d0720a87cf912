// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/collide/backend.hpp"
#include "experiments/collide/own.hpp"
#include "experiments/collide/peers.hpp"

namespace cinch {

const std::vector<BackendKind>& backend_kinds()
{
    static const std::vector<BackendKind> all{
        {"cinch", "the default: lazy update on each tree's cut, 16-triangle leaves, full refit where that is faster",
         make_default},
        {"cinch-full", "its fallback alone: all leaves by SIMD, all BVs by merging", make_simd_refit},
        {"cinch-front", "a front of BV pairs instead of a cut per tree", make_pair_front},
        {"refit-16", "full bottom-up refit of AABBs, 16-triangle leaves", make_full_refit_16},
        {"refit-1", "the same, one triangle per leaf: the paper's Table 3", make_full_refit_1},
        {"hash", "spatial hashing: the paper's Table 3", make_spatial_hash},
        {"eq12-aabb", "the paper's method, AABB/AABB: Eq. 12, lazy, one triangle per leaf: its Table 4",
         [](const CollideScene& s) { return make_paper(s, 6, RestShape::aabb); }},
        {"eq12-obb-14", "OBB/14-DOP: its Table 4",
         [](const CollideScene& s) { return make_paper(s, 14, RestShape::obb); }},
        {"eq12-aabb-14", "AABB/14-DOP", [](const CollideScene& s) { return make_paper(s, 14, RestShape::aabb); }},
        {"eq12-aabb-18", "AABB/18-DOP", [](const CollideScene& s) { return make_paper(s, 18, RestShape::aabb); }},
        {"eq12-aabb-26", "AABB/26-DOP", [](const CollideScene& s) { return make_paper(s, 26, RestShape::aabb); }},
#ifdef CINCH_EMBREE
        {"embree", "Embree " CINCH_EMBREE ", user geometry, REFIT and rtcCollide", make_embree},
#endif
#ifdef CINCH_TINYBVH
        {"tinybvh", "tinybvh, SAH tree, refit, both trees descended at once", make_tinybvh},
#endif
#ifdef CINCH_FCL
        {"fcl", "FCL, AABB, replace and refit", make_fcl},
#endif
#ifdef CINCH_BULLET
        {"bullet", "Bullet, GImpact's quantised tree, refit", make_bullet},
#endif
#ifdef CINCH_EXACT
        {"cgal", "CGAL, AABB_tree, built anew: it has no refit", make_cgal},
#endif
    };
    return all;
}

} // namespace cinch
