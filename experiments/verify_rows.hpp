// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "experiments/records/row_folder.hpp"
#include "experiments/verify.hpp"
#include "experiments/verify_totals.hpp"

namespace cinch {

/// What was verified, as far as tables and records say it.
struct VerifiedInput {
    std::string name, motion;
    std::vector<std::string> report, missing;
    std::size_t bodies = 0, vertices = 0, triangles = 0, nodes = 0;
    nlohmann::ordered_json fields; ///< of every record (fields_of)
};
VerifiedInput verified(const Inputs& inputs);

/// The plan of a verification: all that its rows depend on, and what is printed of it; and back.
nlohmann::ordered_json verify_plan(const Inputs& inputs, const VerifyOptions& options);
VerifiedInput input_of_plan(const nlohmann::ordered_json& plan);
VerifyOptions options_of_plan(const nlohmann::ordered_json& plan);

/// The row of one frame of one body.
nlohmann::ordered_json frame_row(std::size_t body, std::size_t frame, const VerifyTotals& of_frame);

/// Adds a row: those of a body in the order of frames, one body after the other.
void add_row(const nlohmann::ordered_json& row, VerifyTotals& totals);

/// What `verify` prints of a whole verification, however its rows came about; a certificate in parts, in the folder,
/// gets its end. Returns the exit status.
int print_verify(const Merged& all, const OutputOptions& options, const std::string& folder);
/// That status alone.
int verdict_of(const Merged& all);

} // namespace cinch
