// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/record_output.hpp"

#include <algorithm>
#include <cstdio>
#include <fstream>

#include <fmt/format.h>

#include "experiments/report/chart.hpp"
#include "experiments/report/page/charts.hpp"
#include "experiments/report/page/page.hpp"
#include "toolkit/surface/input_error.hpp"

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
            line += (line.empty() && name == names.front() ? "" : ",") + (record.contains(name) ? csv_field(record[name]) : "");
        fmt::print("{}\n", line);
    }
}

void write_file(const std::string& file, const std::string& text)
{
    std::ofstream out(file, std::ios::binary);
    out << text;
    if (!out.flush())
        throw InputError::in_file(file, "cannot be written");
}

// The records as if they had been read from a file named after their experiment.
Results results_of(const std::vector<Json>& records, const Json& from)
{
    Results results;
    std::size_t line = 0;
    for (Json record : records) {
        record.update(from);
        const std::string text = dumped(record);
        const std::string name = record.value("experiment", "records");
        results.add({{name, ++line}, std::move(record), text});
    }
    return results;
}

} // namespace

std::string json_line(Json record, const Provenance& from)
{
    record.update(to_json(from));
    return dumped(record);
}

RecordOutput::RecordOutput(const OutputOptions& options, const Provenance& from) : options_(options), from_(to_json(from))
{
    for (const auto& [file, option] : {std::pair(options.plot, "--plot"), std::pair(options.report, "--report")})
        if (!file.empty()) {
            require_gnuplot(option);
            if (!std::ofstream(file, std::ios::app))
                throw InputError::in_file(file, "cannot be written");
        }
}

void RecordOutput::describe(const Json& input) { input_.update(input); }

void RecordOutput::add(const Json& record)
{
    Json described = record;
    described.update(input_);
    if (options_.csv || !options_.plot.empty() || !options_.report.empty())
        records_.push_back(described);
    if (options_.json) {
        described.update(from_);
        fmt::print("{}\n", dumped(described));
    }
}

void RecordOutput::add_all(const std::vector<Json>& records)
{
    for (const Json& record : records)
        add(record);
}

void RecordOutput::finish()
{
    if (options_.csv)
        print_csv(records_);
    std::fflush(stdout);
    if (options_.plot.empty() && options_.report.empty())
        return;
    const Results results = results_of(records_, from_);
    if (!options_.plot.empty()) {
        std::vector<Chart> charts;
        for (const html::ChartFigure& chart : charts_of(results))
            charts.push_back(chart.chart);
        write_file(options_.plot, svg(charts));
    }
    if (!options_.report.empty())
        write_file(options_.report, command_page(results));
}

} // namespace cinch
