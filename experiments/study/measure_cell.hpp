// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "experiments/records/row_folder.hpp"
#include "experiments/study/plan.hpp"

namespace cinch {

/// The rows of a cell: for each method, arithmetic and k-DOP, bound over truth, as a ratio of radii (box_radius) at the
/// root ("root_ratio") and of all BVs whose radius is not 0, and of the width along the axes of the k-DOP
/// ("width_ratio"); means and greatest values over frames and BVs. With the plan's detail, rows of levels, frames or
/// BVs follow. Throws Interrupted.
Rows measure_cell(const Plan& plan, const InputOptions& what);

} // namespace cinch
