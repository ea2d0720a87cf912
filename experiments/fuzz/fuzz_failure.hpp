// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

#include <nlohmann/json.hpp>

#include "experiments/fuzz/fuzz_case.hpp"

namespace cinch {

/// A case that fails, and the smallest one like it.
struct FuzzFailure {
    std::string family; ///< of the case found
    std::size_t nodes = 0;
    std::string fault; ///< of the smallest
    std::string text;  ///< the smallest, as JSON
    std::string place; ///< where it was saved; empty: nowhere
};

/// Shrinks what was found; saves it in the corpus, a folder that is made where it is not, unless that is empty.
FuzzFailure shrink_and_save(const FuzzCase& found, Defect defect, const std::string& corpus);

/// As a record, and for people; `index` is its number among all cases.
nlohmann::ordered_json record_of(const FuzzFailure& failure, std::uint64_t index);
void print(const FuzzFailure& failure, std::uint64_t index);

} // namespace cinch
