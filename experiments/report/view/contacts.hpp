// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "experiments/report/view/drawn_body.hpp"

namespace cinch {

/// The triangles of each frame that intersect one of another body, ascending, frames one after the other; and how many
/// pairs.
struct Contacts {
    std::vector<std::int32_t> triangle, triangles_in_frame, pairs_in_frame;
};

/// Of the first frames; empty for less than two bodies.
Contacts contacts(const std::vector<DrawnBody>& bodies, std::size_t frames);

} // namespace cinch
