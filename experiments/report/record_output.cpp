// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/record_output.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>

#include "toolkit/surface/input_error.hpp"

namespace cinch {
namespace {

std::string csv_field(const nlohmann::ordered_json& value)
{
    if (value.is_null())
        return "";
    if (!value.is_string())
        return value.dump();
    std::string out = "\"";
    for (const char c : value.get<std::string>())
        out += c == '"' ? std::string("\"\"") : std::string(1, c);
    return out + '"';
}

std::string quoted(const std::string& text) // for gnuplot, single quotes
{
    std::string out = "'";
    for (const char c : text)
        out += c == '\'' ? std::string("''") : std::string(1, c);
    return out + "'";
}

} // namespace

void print_records(const std::vector<nlohmann::ordered_json>& records, const OutputOptions& options, const Provenance& from)
{
    if (options.json)
        for (nlohmann::ordered_json record : records) {
            record.update({{"version", from.version}, {"commit", from.commit}, {"compiler", from.compiler}, {"flags", from.flags}, {"cpu", from.cpu},
                           {"simd_target", from.simd}, {"threads", from.threads}, {"seed", from.seed}});
            fmt::print("{}\n", record.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
        }
    if (!options.csv || records.empty())
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

void require_plottable(const std::string& file)
{
    if (file.empty())
        return;
    if (std::system("command -v gnuplot >/dev/null 2>&1") != 0)
        throw InputError("--plot needs gnuplot; on Debian: apt-get install gnuplot-nox");
    if (!std::ofstream(file, std::ios::app))
        throw InputError::in_file(file, "cannot be written");
}

void plot(const std::vector<Chart>& charts, const std::string& file)
{
    std::string script = fmt::format("set terminal svg size 900,{} dynamic enhanced background '#ffffff' font 'sans-serif,14'\nset output {}\n"
                                     "set multiplot layout {},1\nset grid lc rgb '#d0d0d0'\nset key outside right\n",
                                     480 * charts.size(), quoted(file), charts.size());
    for (const Chart& chart : charts) {
        script += fmt::format("set title {} noenhanced\nset xlabel {} noenhanced\nset ylabel {} noenhanced\nunset logscale\n{}{}set autoscale\nplot ", quoted(chart.title),
                              quoted(chart.x_label), quoted(chart.y_label), chart.log_x ? "set logscale x\n" : "", chart.log_y ? "set logscale y\n" : "");
        for (std::size_t i = 0; i < chart.series.size(); ++i)
            script += fmt::format("{}'-' with {} lw 2 pt {} title {} noenhanced", i ? ", " : "", chart.series[i].points_only ? "points" : "linespoints", 4 + i % 10, quoted(chart.series[i].name));
        script += "\n";
        for (const Series& series : chart.series) {
            for (std::size_t i = 0; i < series.x.size(); ++i)
                script += fmt::format("{:.9g} {:.9g}\n", series.x[i], series.y[i]);
            script += "e\n";
        }
    }
    script += "unset multiplot\n";
    FILE* gnuplot = popen("gnuplot 2>/dev/null", "w");
    if (!gnuplot)
        throw InputError("--plot: gnuplot could not be run");
    const bool written = std::fwrite(script.data(), 1, script.size(), gnuplot) == script.size();
    if (pclose(gnuplot) != 0 || !written || !std::filesystem::exists(file))
        throw InputError::in_file(file, "gnuplot could not draw it");
}

} // namespace cinch
