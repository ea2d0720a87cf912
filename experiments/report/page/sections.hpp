// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "experiments/report/page/html.hpp"

namespace cinch {

/// What the paper says, and what ours says to it.
struct Claim {
    std::string says;  ///< HTML
    const char* where; ///< in the paper
    std::vector<html::Judgement> on;
    std::string answer; ///< HTML, with figures that link to their lines; empty: not measured

    Verdict is() const { return html::verdict(on); }
};

/// A part of the page. An empty body: the results have nothing for it.
struct Section {
    const char* id;
    std::string title, body;
    std::vector<Claim> claims;
};

Section scaling_section(const Results& results);   ///< Table 1
Section tightness_section(const Results& results); ///< Figs. 1 and 5, attribution
Section collide_section(const Results& results);   ///< Tables 2 to 4, Figs. 6 and 7
Section cost_section(const Results& results);      ///< accuracy and cost
Section proof_section(const Results& results);     ///< verify, corners
Section audit_section(const Results& results);     ///< formulas of engines

} // namespace cinch
