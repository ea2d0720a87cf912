// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "experiments/report/results.hpp"

namespace cinch {

/// A self-contained page of one command's records. `note`: why they are not all of them, first of all; then it judges
/// no claim.
std::string command_page(const Results& results, const std::string& note = {});

/// The page of `cinch reproduce`: all parts, the paper's claims, where everything comes from, what is damaged or not
/// there yet.
struct ReportNotes {
    std::vector<Damage> damage;
    std::vector<std::string> missing;  ///< experiments not run yet, for people
    std::vector<std::string> left_out; ///< those that are no part of a quick run
};
std::string report_page(const Results& results, const ReportNotes& notes);

} // namespace cinch
