// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "experiments/input.hpp"
#include "toolkit/surface/checksum.hpp"

namespace cinch {

/// Of the bytes of what is deformed and of all that deforms it: another file under the same name is another plan.
/// Throws Interrupted.
std::uint64_t checksum_of(const Input& input, std::uint64_t so_far = checksum_of_nothing);
std::uint64_t checksum_of(const Inputs& inputs);

} // namespace cinch
