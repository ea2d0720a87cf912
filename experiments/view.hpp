// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "experiments/report/view.hpp"

namespace cinch {

struct ViewOptions {
    ViewRequest request; ///< without a scene: the views of the report
    std::string report;  ///< HTML page to write; empty: none
    bool json = false;   ///< the views as JSON Lines
    int threads = 0;
};

/// Writes a page with a 3-D view of an input, or of the paper's figures. Returns the exit status: 0 done, 130
/// interrupted (with the frames done so far, if there are any). Throws InputError.
int view(const ViewOptions& options);

} // namespace cinch
