// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "experiments/verify.hpp"
#include "experiments/verify_totals.hpp"

namespace cinch {

/// How the BVs that stand at the end of a query came about.
struct LazyTotals {
    std::size_t by_methods = 0, merged = 0, from_vertices = 0; ///< BVs × frames
    std::size_t left = 0;                                      ///< BVs × frames that no query wanted
    std::size_t pairs = 0;                                     ///< of triangles that intersect, over all frames
};

/// The lazy update of all bodies of a scene, and a query of their intersecting triangles, frame by frame; then proves
/// every BV that is current: what the query read. Throws InputError for options that do not go with it, and Interrupted
/// between frames, those before it added.
void verify_lazy(const Inputs& inputs, const VerifyOptions& options, VerifyTotals& totals, LazyTotals& lazy);

} // namespace cinch
