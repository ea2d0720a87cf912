// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cinch/cinch.h"
#include "cinch/collider.hpp"
#include "cinch/refit.hpp"

namespace cinch::c {

/// The library's options; null and 0 stand for the defaults. Throw std::invalid_argument for what is no choice.
RefitOptions options_of(const cinch_refit_options* options);
/// k and lanes of 0, and all where there are no options, are those of `defaults`.
LazyOptions options_of(const cinch_body_options* options, const LazyOptions& defaults = {});
CrowdOptions options_of(const cinch_crowd_options* options);
/// k, or 6 for 0.
int kdop_of(std::int32_t k);
/// Whether a flag, 0 or 1, is set.
bool flag(std::int32_t value, const char* name);

} // namespace cinch::c
