// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "experiments/report/chart.hpp"
#include "experiments/report/provenance.hpp"

namespace cinch {

/// What commands put out besides what they print for people.
struct OutputOptions {
    bool json = false, csv = false; ///< records on standard output and nothing else
    std::string plot;               ///< picture to draw (.svg, .pdf, .png), further charts as NAME-2 ...; empty: none
    std::string plot_data;          ///< CSV file with the points of all charts; empty: none
    std::string report;             ///< HTML page to write; empty: none

    bool records_only() const { return json || csv; }
};

/// How much of what was asked for a result is of. In every record as "frames_done", "frames" and "complete", so that a
/// part is never read as the whole.
struct Completeness {
    std::size_t frames_done = 0, frames = 0; ///< 0 of 0 where a command has no frames
    bool complete = true;
    std::string note; ///< for people, where it is not complete: interrupted_after()
};

/// "interrupted after 3 of 9 sizes".
std::string interrupted_after(std::size_t done, std::size_t wanted, const std::string& what);
/// The completeness of a command whose only measure is frames.
Completeness completeness_in_frames(std::size_t done, std::size_t wanted);
/// The note, where there is one, as the first line of a table on standard output.
void print_note(const Completeness& completeness);

class PictureOutput;

/// The records of a command: JSON objects, each with its completeness and the provenance added. As JSON Lines they are
/// printed as they come; CSV, charts and the page follow when all are there.
class RecordOutput {
public:
    /// To be made before measuring: throws InputError if gnuplot is missing, or a file cannot be written.
    RecordOutput(const OutputOptions& options, const Provenance& from);
    ~RecordOutput();
    /// The completeness of the records added from here on; a record's own fields of these names go before. The last one
    /// is also that of charts and page.
    void set(Completeness completeness) { completeness_ = std::move(completeness); }
    /// Fields of the input that every record carries from now on; "partial" and "missing" are among them in any case:
    /// false and none, until this says otherwise.
    void describe(const nlohmann::ordered_json& input);
    void add(const nlohmann::ordered_json& record);
    void add_all(const std::vector<nlohmann::ordered_json>& records);
    /// More charts than those of the records.
    void add_chart(const Chart& chart) { charts_.push_back(chart); }
    /// Writes what has not been printed yet. Without it charts and page stay as they were.
    void finish();

private:
    OutputOptions options_;
    nlohmann::ordered_json input_{{"partial", false}, {"missing", nlohmann::ordered_json::array()}};
    nlohmann::ordered_json from_;
    Completeness completeness_;
    std::vector<nlohmann::ordered_json> records_, rows_; ///< of charts and page; of CSV, with the provenance
    std::vector<Chart> charts_;
    std::unique_ptr<PictureOutput> pictures_;
};

/// A record of this provenance, as one line of text.
std::string json_line(nlohmann::ordered_json record, const Provenance& from);

} // namespace cinch
