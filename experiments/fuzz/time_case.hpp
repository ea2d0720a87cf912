// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cinch/bvh.hpp"
#include "cinch/io.hpp"

namespace cinch {

/// A small character whose one clip is `character.rest`: a chain of bones with curves of each kind, awkward keys among
/// them, a strip of triangles along it, and every other time morph targets.
struct TimeCase {
    Character character;
    DeformableSurface surface;
    Bvh bvh;
};
TimeCase draw_time_case(std::uint64_t seed);

} // namespace cinch
