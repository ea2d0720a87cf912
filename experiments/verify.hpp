// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "experiments/input.hpp"
#include "experiments/report/record_output.hpp"
#include "toolkit/hierarchy/refit.hpp"

namespace cinch {

/// Damage done on purpose, to see the verifier find it.
enum class Sabotage { none, no_rounding, swap_interval, lower_h };

struct VerifyOptions {
    InputOptions input;
    Methods methods = Method::best;
    Precision precision = Precision::float32;
    int passes = 1;
    bool remember = false;
    RestShape rest_shape = RestShape::aabb;
    bool stats = false; ///< memory too
    int kdop = 6;
    std::size_t leaf = 1; ///< triangles
    int threads = 0;      ///< 0: as many as the machine has
    OutputOptions output;
    std::string certificate; ///< file to write; empty: none
    std::string vipr;        ///< folder for single bounds as VIPR files; empty: none
    bool volume = false;     ///< exact volume ratios too
    Sabotage sabotage = Sabotage::none;
};

/// Refits every BV in every frame and proves every bound. Returns the exit status: 0 all proven, 1 a check failed, 130 interrupted.
int verify(const VerifyOptions& options);

} // namespace cinch
