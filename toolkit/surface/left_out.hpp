// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace cinch {

/// So many of one kind of what a mesh file names and what bounds nothing.
struct LeftOut {
    std::size_t count;
    const char* one;  ///< "line"
    const char* many; ///< "lines"
};

/// Adds the line of the load report that counts these, if there are any.
void note_left_out(const std::vector<LeftOut>& kinds, std::vector<std::string>& notes);

} // namespace cinch
