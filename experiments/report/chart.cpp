// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/chart.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <numeric>
#include <set>
#include <string_view>
#include <utility>

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

// The last part of a path: titles and names say what is drawn, not where it lies.
std::string base_name(const std::string& text)
{
    std::string out;
    for (std::size_t at = 0; at < text.size();) { // word by word
        const std::size_t end = std::min(text.find(' ', at), text.size());
        const std::string word = text.substr(at, end - at);
        const std::size_t slash = word.find_last_of('/');
        const bool is_path = slash != std::string::npos && word.find('.', slash) != std::string::npos;
        out += (is_path ? word.substr(slash + 1) : word) + (end < text.size() ? " " : "");
        at = end + 1;
    }
    return out;
}

template <class Take> void each_point(const Series& series, const Take& take)
{
    for (std::size_t p = 0; p < series.x.size(); ++p)
        if (std::isfinite(series.x[p]) && std::isfinite(series.y[p]))
            take(p);
}

// "set xtics (...)" of a logarithmic axis: gnuplot's own are at powers of ten alone, which may lie outside. The values
// themselves where they are few and whole; else 1, 2, 5 of each power, and more where there is one power or less.
std::string log_tics(const char* axis, const Chart& chart, std::vector<double> Series::*values)
{
    std::set<double> all;
    for (const Series& series : chart.series)
        for (const double value : series.*values)
            if (std::isfinite(value) && value > 0)
                all.insert(value);
    if (all.empty())
        return "";
    std::string list;
    auto tic = [&](double at) { list += fmt::format("{}{:.6g}", list.empty() ? "" : ", ", at); };
    const bool is_x = *axis == 'x';
    if (is_x && all.size() <= 10 && std::all_of(all.begin(), all.end(), [](double x) { return x == std::round(x); })) {
        for (const double value : all)
            tic(value);
        return fmt::format("set {}tics ({})\n", axis, list);
    }
    const double least = *all.begin() / 1.2, greatest = *all.rbegin() * 1.2, decades = std::log10(greatest / least);
    if (decades > 4)
        return fmt::format("set {}tics autofreq\n", axis);
    const std::vector<double> steps = decades > 2   ? std::vector<double>{1, 3}
                                      : decades > 1 ? std::vector<double>{1, 2, 5}
                                                    : std::vector<double>{1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8};
    for (double power = std::pow(10, std::floor(std::log10(least))); power <= greatest; power *= 10)
        for (const double step : steps)
            if (step * power >= least && step * power <= greatest)
                tic(step * power);
    return fmt::format("set {}tics ({})\n", axis, list);
}

// Where a name stands, as a share of the height from below, by its series.
using LabelHeights = std::vector<double>;

// Beside the right ends of lines, moved apart where these are near each other; none where there is but one line, where
// there are points alone, and where they would not fit.
LabelHeights label_heights(const Chart& chart, double low, double high)
{
    constexpr double line = 0.056; // of text, of the height
    if (chart.series.size() < 2 || static_cast<double>(chart.series.size()) * line > 1)
        return {};
    auto scaled = [&](double y) { return chart.log_y ? std::log(y) : y; };
    LabelHeights at;
    for (const Series& series : chart.series) {
        if (series.points_only)
            return {};
        double last = NAN, furthest = -INFINITY;
        each_point(series, [&](std::size_t p) {
            if (series.x[p] >= furthest) {
                furthest = series.x[p];
                last = series.y[p];
            }
        });
        const double height = (scaled(last) - scaled(low)) / (scaled(high) - scaled(low));
        at.push_back(std::isfinite(height) ? height : 0);
    }
    std::vector<std::size_t> order(at.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return at[a] < at[b]; });
    // As near to their lines as may be, one above the other: the least squares of places less i lines that never fall.
    std::vector<std::pair<double, std::size_t>> blocks; // mean, and of how many
    for (std::size_t i = 0; i < order.size(); ++i) {
        blocks.emplace_back(at[order[i]] - static_cast<double>(i) * line, 1);
        while (blocks.size() > 1 && blocks[blocks.size() - 2].first > blocks.back().first) {
            const auto [mean, count] = blocks.back();
            blocks.pop_back();
            auto& [below, of] = blocks.back();
            below =
                (below * static_cast<double>(of) + mean * static_cast<double>(count)) / static_cast<double>(of + count);
            of += count;
        }
    }
    std::size_t i = 0;
    for (const auto& [mean, count] : blocks)
        for (std::size_t n = 0; n < count; ++n, ++i) {
            const double above = static_cast<double>(order.size() - 1 - i) * line + line / 2,
                         under = static_cast<double>(i) * line + line / 2; // what the others need
            at[order[i]] = std::clamp(mean + static_cast<double>(i) * line, under, 1 - above);
        }
    return at;
}

// From the least to the greatest value, bands included, and a little more; 0 and 0 where there are none.
std::pair<double, double> y_range(const Chart& chart)
{
    double low = INFINITY, high = -INFINITY;
    for (const Series& series : chart.series)
        for (const std::vector<double>* values : {&series.y, &series.low, &series.high})
            for (const double y : *values)
                if (std::isfinite(y) && (!chart.log_y || y > 0)) {
                    low = std::min(low, y);
                    high = std::max(high, y);
                }
    if (!(low <= high))
        return {0, 0};
    if (chart.log_y) {
        const double more = std::max(std::pow(high / low, 0.05), 1.02);
        return {low / more, high * more};
    }
    const double more = std::max(0.05 * (high - low), 1e-3 * std::max(std::abs(low), std::abs(high)));
    return more > 0 ? std::pair(low - more, high + more) : std::pair(-1.0, 1.0);
}

std::string script_of(const Chart& chart)
{
    const auto [low, high] = y_range(chart);
    const LabelHeights heights = low < high ? label_heights(chart, low, high) : LabelHeights{};
    std::string script = fmt::format("set title {} noenhanced\nset xlabel {} noenhanced\nset ylabel {} "
                                     "noenhanced\n{}{}set autoscale fix\nset offsets graph 0.02, graph 0.02, 0, 0\n",
                                     quoted(base_name(chart.title)), quoted(chart.x_label), quoted(chart.y_label),
                                     chart.log_x ? "set logscale x\n" + log_tics("x", chart, &Series::x) : "",
                                     chart.log_y ? "set logscale y\n" + log_tics("y", chart, &Series::y) : "");
    if (low < high)
        script += fmt::format("set yrange [{:.9g}:{:.9g}]\n", low, high);
    std::size_t longest = 0;
    for (std::size_t i = 0; i < heights.size(); ++i) {
        const std::string name = base_name(chart.series[i].name);
        longest = std::max(longest, name.size());
        script += fmt::format("set label {} {} at graph 1.025, graph {:.4f} left offset 1,0 noenhanced tc rgb '{}' "
                              "point pt {} ps 0.6 lc rgb '{}'\n",
                              i + 2, quoted(name), heights[i], colours[i % colours.size()], marks[i % marks.size()],
                              colours[i % colours.size()]);
    }
    if (!heights.empty())
        script += fmt::format("unset key\nset rmargin {}\n", longest + 4);
    script += "plot ";
    std::string points;
    for (std::size_t i = 0; i < chart.series.size(); ++i) {
        const Series& series = chart.series[i];
        const char* colour = colours[i % colours.size()];
        if (!series.low.empty()) {
            script +=
                fmt::format("'-' with filledcurves fs transparent solid 0.18 noborder lc rgb '{}' notitle, ", colour);
            each_point(series, [&](std::size_t p) {
                points += fmt::format("{:.9g} {:.9g} {:.9g}\n", series.x[p], series.low[p], series.high[p]);
            });
            points += "e\n";
        }
        script += fmt::format("'-' with {} lw 2 lc rgb '{}' pt {} ps {} title {} noenhanced{}",
                              series.points_only ? "points" : "linespoints", colour, marks[i % marks.size()],
                              series.points_only ? 0.5 : 0.6, quoted(base_name(series.name)),
                              i + 1 < chart.series.size() ? ", " : "");
        each_point(series, [&](std::size_t p) { points += fmt::format("{:.9g} {:.9g}\n", series.x[p], series.y[p]); });
        points += "e\n";
    }
    return script + "\n" + points;
}

const char* terminal_of(Picture picture)
{
    switch (picture) {
    case Picture::svg:
        return "svg size 760,430 dynamic enhanced background '#ffffff' font 'sans-serif,15'";
    case Picture::pdf:
        return "pdfcairo size 6in,3.4in enhanced font 'sans-serif,11'";
    case Picture::png:
        return "pngcairo size 1520,860 enhanced background '#ffffff' font 'sans-serif,22' linewidth 2 pointscale 2.5";
    }
    return "";
}

bool is_whole(const std::string& picture, Picture as)
{
    using namespace std::string_view_literals;
    return as == Picture::svg ? picture.ends_with("</svg>\n\n")
           : as == Picture::pdf
               ? picture.starts_with("%PDF-") && picture.find("%%EOF", picture.size() - 32) != picture.npos
               : picture.ends_with("IEND\xae\x42\x60\x82"sv);
}

} // namespace

void require_gnuplot(const std::string& option)
{
    if (std::system("command -v gnuplot >/dev/null 2>&1") != 0)
        throw InputError(option + " needs gnuplot; on Debian: apt-get install gnuplot-nox");
}

Picture picture_of(const std::string& file)
{
    constexpr std::array known{std::pair{".svg", Picture::svg}, std::pair{".pdf", Picture::pdf},
                               std::pair{".png", Picture::png}};
    for (const auto& [end, picture] : known)
        if (file.ends_with(end))
            return picture;
    throw InputError::in_file(file, "pictures are .svg, .pdf or .png");
}

std::string data_of(const std::vector<Chart>& charts)
{
    auto field = [](const std::string& text) {
        std::string out = "\"";
        for (const char c : text)
            out += c == '"' ? std::string("\"\"") : std::string(1, c);
        return out + '"';
    };
    std::string out = "chart,series,x,y,low,high\n";
    for (const Chart& chart : charts)
        for (const Series& series : chart.series)
            each_point(series, [&](std::size_t p) {
                out += fmt::format("{},{},{},{},{},{}\n", field(chart.title), field(series.name), series.x[p],
                                   series.y[p], series.low.empty() ? "" : fmt::format("{}", series.low[p]),
                                   series.high.empty() ? "" : fmt::format("{}", series.high[p]));
            });
    return out;
}

std::string drawn(const Chart& chart, Picture as, const std::string& note)
{
    std::string script =
        fmt::format("set encoding utf8\nset terminal {}\nset grid lc rgb '#dddddd'\n"
                    "set border lc rgb '#555555'\nset key outside bottom center horizontal samplen 1.5 "
                    "spacing 1.15\n",
                    terminal_of(as));
    if (!note.empty())
        script += fmt::format("set label 1 {} at screen 0.01,0.98 left noenhanced tc rgb '#b3261e'\n", quoted(note));
    script += script_of(chart);
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
    const bool is_drawn = gnuplot && pclose(gnuplot) == 0 && is_whole(out, as);
    std::error_code ignored;
    std::filesystem::remove(name, ignored);
    if (!is_drawn)
        throw InputError("gnuplot could not draw '" + chart.title + "'");
    return out;
}

} // namespace cinch
