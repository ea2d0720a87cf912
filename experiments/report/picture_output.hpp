// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "experiments/report/chart.hpp"
#include "experiments/report/record_output.hpp"

namespace cinch {

/// What a command's records are drawn into: the files of --plot, --plot-data and --report.
class PictureOutput {
public:
    virtual ~PictureOutput() = default;
    /// All of them, whole. `charts`: more than those of the records; `note`: why the records are not all.
    virtual void write(const std::vector<nlohmann::ordered_json>& records, const nlohmann::ordered_json& from,
                       const std::vector<Chart>& charts, const std::string& note) = 0;
};

/// None where none is asked for. Throws InputError if gnuplot is missing, or a file cannot be written.
std::unique_ptr<PictureOutput> picture_output(const OutputOptions& options);

} // namespace cinch
