// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "experiments/report/provenance.hpp"

namespace cinch {

/// What commands put out besides what they print for people.
struct OutputOptions {
    bool json = false, csv = false; ///< records on standard output and nothing else
    std::string plot;               ///< SVG file to draw; empty: none
    std::string report;             ///< HTML page to write; empty: none

    bool records_only() const { return json || csv; }
};

/// The records of a command: JSON objects, each with the provenance added. As JSON Lines they are printed as they come; CSV, charts and
/// the page follow when all are there.
class RecordOutput {
public:
    /// To be made before measuring: throws InputError if gnuplot is missing, or a file cannot be written.
    RecordOutput(const OutputOptions& options, const Provenance& from);
    /// Fields of the input that every record carries from now on; "partial" and "missing" are among them in any case: false and none,
    /// until this says otherwise.
    void describe(const nlohmann::ordered_json& input);
    void add(const nlohmann::ordered_json& record);
    void add_all(const std::vector<nlohmann::ordered_json>& records);
    void finish();

private:
    OutputOptions options_;
    nlohmann::ordered_json input_{{"partial", false}, {"missing", nlohmann::ordered_json::array()}};
    nlohmann::ordered_json from_;
    std::vector<nlohmann::ordered_json> records_;
};

/// A record of this provenance, as one line of text.
std::string json_line(nlohmann::ordered_json record, const Provenance& from);

} // namespace cinch
