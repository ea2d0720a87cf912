// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/chart.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include <fmt/format.h>
#include <unistd.h>

#include "cinch/surface.hpp"

namespace cinch {
namespace {

// Okabe and Ito's colours, which differ for everyone, and marks that differ without colour.
constexpr std::array colours{"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00",
                             "#56b4e9", "#000000", "#8c564b", "#7f7f7f", "#b8a900"};
constexpr std::array marks{7, 5, 9, 11, 13, 6, 4, 8, 10}; // one fewer, so that the eleventh colour has another

// In single quotes nothing is special but the quote itself, and the end of the line.
std::string quoted(const std::string& text)
{
    std::string out = "'";
    for (const char c : text)
        out += c == '\'' ? std::string("''") : std::string(1, static_cast<unsigned char>(c) < 32 ? ' ' : c);
    return out + "'";
}

std::string script_of(const Chart& chart)
{
    std::string script = fmt::format("set title {} noenhanced\nset xlabel {} noenhanced\nset ylabel {} "
                                     "noenhanced\nunset logscale\n{}{}set autoscale\nplot ",
                                     quoted(chart.title), quoted(chart.x_label), quoted(chart.y_label),
                                     chart.log_x ? "set logscale x\n" : "", chart.log_y ? "set logscale y\n" : "");
    std::string points;
    for (std::size_t i = 0; i < chart.series.size(); ++i) {
        const Series& series = chart.series[i];
        script += fmt::format("{}'-' with {} lw 2 lc rgb '{}' pt {} ps {} title {} noenhanced", i ? ", " : "",
                              series.points_only ? "points" : "linespoints", colours[i % colours.size()],
                              marks[i % marks.size()], series.points_only ? 0.5 : 0.6, quoted(series.name));
        for (std::size_t p = 0; p < series.x.size(); ++p)
            if (std::isfinite(series.x[p]) && std::isfinite(series.y[p]))
                points += fmt::format("{:.9g} {:.9g}\n", series.x[p], series.y[p]);
        points += "e\n";
    }
    return script + "\n" + points;
}

} // namespace

void require_gnuplot(const std::string& option)
{
    if (std::system("command -v gnuplot >/dev/null 2>&1") != 0)
        throw InputError(option + " needs gnuplot; on Debian: apt-get install gnuplot-nox");
}

std::string svg(const std::vector<Chart>& charts, const std::string& note)
{
    std::string script =
        fmt::format("set encoding utf8\n"
                    "set terminal svg size 760,{} dynamic enhanced background '#ffffff' font 'sans-serif,15'\n"
                    "set multiplot layout {},1\nset grid lc rgb '#dddddd'\nset border lc rgb '#555555'\nset key "
                    "outside bottom center horizontal samplen 1.5 spacing 1.15 font ',13'\n",
                    430 * charts.size(), charts.size());
    if (!note.empty())
        script += fmt::format("set label 1 {} at screen 0.01,0.992 left noenhanced font ',13' tc rgb '#b3261e'\n",
                              quoted(note));
    for (const Chart& chart : charts)
        script += script_of(chart) + "unset label 1\n";
    script += "unset multiplot\n";
    std::string name = (std::filesystem::temp_directory_path() / "cinch-XXXXXX").string();
    const int file = mkstemp(name.data());
    if (file < 0)
        throw InputError("no temporary file can be made; is the disk full?");
    const bool written = write(file, script.data(), script.size()) == static_cast<ssize_t>(script.size());
    close(file);
    std::string out; // an interrupt of the terminal's whole group is for us: what is there is still drawn
    FILE* gnuplot =
        written ? popen(("trap '' INT TERM; exec gnuplot '" + name + "' 2>/dev/null").c_str(), "r") : nullptr;
    if (gnuplot) {
        std::array<char, 65536> part;
        for (std::size_t n; (n = std::fread(part.data(), 1, part.size(), gnuplot)) > 0;)
            out.append(part.data(), n);
    }
    const bool drawn = gnuplot && pclose(gnuplot) == 0 && out.ends_with("</svg>\n\n");
    std::error_code ignored;
    std::filesystem::remove(name, ignored);
    if (!drawn)
        throw InputError("gnuplot could not draw '" + (charts.empty() ? std::string() : charts.front().title) + "'");
    return out;
}

} // namespace cinch
