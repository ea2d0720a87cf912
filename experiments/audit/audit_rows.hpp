// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "experiments/audit/audit_clip.hpp"

namespace cinch {

/// The rows of a clip, one per formula, and back.
Rows rows_of(const std::vector<AuditedFormula>& formulas, const std::string& clip);
AuditedFormula audited_formula_of(const nlohmann::ordered_json& row);

} // namespace cinch
