// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "experiments/report/results.hpp"

namespace cinch {

/// All records as plain tables, those with the same fields together.
std::string record_tables(const Results& results);

/// Per file: commands, seed, commit, machine.
std::string provenance_section(const Results& results);

/// The lines themselves, which all figures link to.
std::string lines_section(const Results& results);

} // namespace cinch
