// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <compare>
#include <deque>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "experiments/measure/verdict.hpp"

namespace cinch {

/// A line of a results file. Names of files are without folder and ending.
struct Source {
    std::string file;
    std::size_t line = 0; ///< from 1
    auto operator<=>(const Source&) const = default;
};

/// One result: a JSON object, and where it stands.
struct Record {
    Source at;
    nlohmann::ordered_json fields;
    std::string text; ///< the line itself

    /// A field as text, empty if it is missing or none.
    std::string word(const char* field) const;
    /// A field as a number, NaN if it is missing or none.
    double number(const char* field) const;
};

/// A figure and all the lines that it comes from. NaN: not measured.
struct Traced {
    double value = NAN;
    std::vector<Source> from;
    double low = NAN, high = NAN; ///< of what was timed: between the quartiles; NaN where it is exact

    bool known() const { return std::isfinite(value); }
    Range range() const { return std::isnan(low) ? Range(value) : Range(value, low, high); }
};
Traced operator+(const Traced& a, const Traced& b);
Traced operator-(const Traced& a, const Traced& b);
Traced operator*(const Traced& a, const Traced& b);
Traced operator/(const Traced& a, const Traced& b);
Traced operator/(double a, const Traced& b);
Traced operator-(double a, const Traced& b);
Traced operator/(const Traced& a, double b);
/// The known ones of these; unknown if there are none.
Traced mean(const std::vector<Traced>& all);
Traced least(const std::vector<Traced>& all);
Traced greatest(const std::vector<Traced>& all);

/// Results of one or more files.
class Results {
public:
    void add(Record record) { records_.push_back(std::move(record)); }
    const std::deque<Record>& all() const { return records_; }
    /// All that have these fields with these values.
    std::vector<const Record*> where(const nlohmann::ordered_json& fields) const;
    /// A field of the first of them in which it is a number.
    Traced number(const nlohmann::ordered_json& fields, const char* field) const;
    /// With its quartiles where the record has them: "FIELD_low" and "FIELD_high".
    static Traced number(const Record& record, const char* field);

private:
    std::deque<Record> records_;
};

/// Of records that a command made just now, each with the fields of `from` too, as if they had been read from a file
/// named after their experiment.
Results results_of(const std::vector<nlohmann::ordered_json>& records, const nlohmann::ordered_json& from);

/// What is wrong with a results file. Line 0: the file as a whole.
struct Damage {
    std::string file; ///< with its ending
    std::size_t line = 0;
    std::string what;
};
std::string describe(const Damage& damage);

/// A file as `cinch reproduce` stores it: lines, each ended, and a closing line, a JSON object, that becomes their
/// checksum's place too.
std::string sealed(const std::string& lines, std::string_view closing);

/// Reads one file as `cinch reproduce` stores it: JSON Lines, each with its provenance, and a closing line that says
/// how many there are and has a checksum of every byte before it. Returns no record at all if anything is wrong with
/// it: what is left of a damaged file would pass for the whole.
std::vector<Record> read_results(const std::filesystem::path& file, std::vector<Damage>& damage);

/// What `view_sections` draws, and is too large to stand on a page twice.
bool is_view(const Record& record);

/// Of the file's closing line, as `closing_line` made it.
bool is_closing(const Record& record);

} // namespace cinch
