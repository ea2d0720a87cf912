// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/record_output.hpp"

#include <algorithm>
#include <cstdio>

#include <fmt/format.h>

#include "experiments/report/picture_output.hpp"

namespace cinch {
namespace {

using Json = nlohmann::ordered_json;

std::string dumped(const Json& record) { return record.dump(-1, ' ', false, Json::error_handler_t::replace); }

std::string csv_field(const Json& value)
{
    if (value.is_null())
        return "";
    if (value.is_number() || value.is_boolean())
        return value.dump();
    std::string out = "\"";
    for (const char c : value.is_string() ? value.get<std::string>() : dumped(value))
        out += c == '"' ? std::string("\"\"") : std::string(1, c);
    return out + '"';
}

void print_csv(const std::vector<Json>& records)
{
    if (records.empty())
        return;
    std::vector<std::string> names;
    for (const auto& record : records) // not every record has every field
        for (const auto& [name, value] : record.items())
            if (std::find(names.begin(), names.end(), name) == names.end())
                names.push_back(name);
    fmt::print("{}\n", fmt::join(names, ","));
    for (const auto& record : records) {
        std::string line;
        for (const std::string& name : names)
            line += (line.empty() && name == names.front() ? "" : ",") +
                    (record.contains(name) ? csv_field(record[name]) : "");
        fmt::print("{}\n", line);
    }
}

} // namespace

std::string json_line(Json record, const Provenance& from)
{
    record.update(to_json(from));
    return dumped(record);
}

std::string interrupted_after(std::size_t done, std::size_t wanted, const std::string& what)
{
    return fmt::format("interrupted after {} of {} {}", done, wanted, what);
}

Completeness completeness_in_frames(std::size_t done, std::size_t wanted)
{
    return {done, wanted, done == wanted, done == wanted ? "" : interrupted_after(done, wanted, "frames")};
}

void print_note(const Completeness& completeness)
{
    if (!completeness.note.empty())
        fmt::print("{}: what follows is of these alone\n\n", completeness.note);
}

RecordOutput::~RecordOutput() = default;

RecordOutput::RecordOutput(const OutputOptions& options, const Provenance& from)
    : options_(options), from_(to_json(from)), pictures_(picture_output(options))
{
}

void RecordOutput::describe(const Json& input) { input_.update(input); }

void RecordOutput::add(const Json& record)
{
    Json line = record;
    line.update(input_);
    for (const auto& [name, value] :
         {std::pair("frames_done", Json(completeness_.frames_done)), std::pair("frames", Json(completeness_.frames)),
          std::pair("complete", Json(completeness_.complete))})
        if (!line.contains(name))
            line[name] = value;
    if (pictures_)
        records_.push_back(line);
    if (options_.csv) {
        rows_.push_back(line);
        rows_.back().update(from_);
    }
    if (!options_.json)
        return;
    line.update(from_);
    fmt::print("{}\n", dumped(line));
}

void RecordOutput::add_all(const std::vector<Json>& records)
{
    for (const Json& record : records)
        add(record);
}

void RecordOutput::finish()
{
    if (options_.csv)
        print_csv(rows_);
    std::fflush(stdout);
    if (pictures_)
        pictures_->write(records_, from_, charts_, completeness_.note);
}

} // namespace cinch
