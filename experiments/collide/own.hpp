// SPDX-License-Identifier: GPL-3.0-or-later
// Internal to collide/: this project's own backends, and the baselines of the paper's Tables 3 and 4.
#pragma once

#include "experiments/collide/backend.hpp"

namespace cinch {

std::unique_ptr<Backend> make_default(const CollideScene& scene);    ///< the best of everything
std::unique_ptr<Backend> make_simd_refit(const CollideScene& scene); ///< its fallback: all leaves, all BVs
std::unique_ptr<Backend> make_pair_front(const CollideScene& scene); ///< a front of BV pairs instead of a cut per tree
std::unique_ptr<Backend> make_full_refit_1(const CollideScene& scene); ///< bottom-up, one triangle per leaf
std::unique_ptr<Backend> make_full_refit_16(const CollideScene& scene);
std::unique_ptr<Backend> make_spatial_hash(const CollideScene& scene);
std::unique_ptr<Backend> make_paper(const CollideScene& scene, int kdop,
                                    RestShape shape); ///< Eq. 12, one triangle per leaf, lazy

} // namespace cinch
