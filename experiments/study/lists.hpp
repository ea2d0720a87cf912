// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace cinch {

/// Whole numbers as people write lists of them: "7", "1-20" (all from 1 to 20), "16..512" (doubled from 16 on, and 512
/// last), and several of these behind commas. Throws InputError, which begins with `what`, for anything else, an empty
/// list, a number twice and more than 100,000.
std::vector<std::uint64_t> parse_list(std::string_view text, std::string_view what);

} // namespace cinch
