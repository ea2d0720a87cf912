// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "toolkit/bounds/weight_space.hpp"

namespace cinch {

/// A weight space with rows of extrema: {"n":3,"l":[…],"h":[…],"b":[[…],…]}.
struct Case {
    std::vector<double> l, h;
    std::vector<std::vector<double>> b;
    WeightSpace space() const { return {l, h}; }
};

/// Of a file, of standard input ("-"), or of a case that comes with the program, by its name without ending. Numbers
/// are JSON numbers, or strings that are a decimal or hexadecimal floating-point number ("0x1.8p-1"). "b" may be left
/// out; other fields are passed over. Throws InputError with file, field and index: malformed JSON, lengths that
/// contradict n, numbers that are none, NaN or infinite, values outside 0 ≤ l ≤ h ≤ 1. An infeasible space is no error.
Case read_case(const std::filesystem::path& path);
Case parse_case(const std::string& text, const std::string& file);

} // namespace cinch
