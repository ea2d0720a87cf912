// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "cinch/io.hpp"

namespace cinch {

/// Weights and clips as text (cinch/io.hpp), from bytes in memory; `file` is for messages only.
Influences parse_weights_text(std::string_view bytes, const std::string& file, std::size_t vertices);
std::vector<Clip> parse_clips_text(std::string_view bytes, const std::string& file, std::uint32_t nodes);

} // namespace cinch
