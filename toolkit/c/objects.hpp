// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "cinch/bvh.hpp"
#include "cinch/cinch.h"
#include "toolkit/c/registry.hpp"

namespace cinch::c {

/// What several files of this room refer to. Each keeps alive what it is made of.
struct Surface {
    static constexpr Kind kind = Kind::surface;
    using Handle = cinch_surface;

    std::shared_ptr<const DeformableSurface> surface;
    std::shared_ptr<const std::vector<MorphTarget>> targets; ///< not null
    WeightReport report;                                     ///< of arrays and files

    std::size_t nodes() const { return surface->weights.node_count; }
};

struct Tree {
    static constexpr Kind kind = Kind::bvh;
    using Handle = cinch_bvh;

    std::shared_ptr<const Surface> of;
    Bvh bvh;
};

} // namespace cinch::c
