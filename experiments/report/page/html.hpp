// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "experiments/measure/verdict.hpp"
#include "experiments/report/chart.hpp"
#include "experiments/report/paper_figures.hpp"
#include "experiments/report/results.hpp"

namespace cinch::html {

/// Text as it is, whatever it holds, in elements and in quoted attributes.
std::string escaped(std::string_view text);

/// About three digits: "0.0412", "1.31", "57", "1,234".
std::string digits(double x);

/// A figure that links to the lines it comes from; a dash if there is none. Its text is `digits`, or what is given.
std::string figure(const Traced& x);
std::string figure(const Traced& x, const std::string& text);
/// "37 %".
std::string percent(const Traced& x);

/// Cells of a table, <td> and all.
std::string cell(const Traced& x);
std::string cell(const Traced& x, const std::string& text);
std::string paper_cell(const PaperFigure& x);
std::string text_cell(std::string_view text, const char* css = "");
std::string raw_cell(const std::string& html, const char* css = "");
std::string head_cell(const std::string& html, std::size_t columns = 1);

std::string row(const std::vector<std::string>& cells);
/// One <tbody>; `css` may be empty.
std::string block(const std::vector<std::string>& rows, const char* css = "");
/// A whole table, which scrolls by itself where the page is too narrow. `caption` is HTML.
std::string table(const std::string& caption, const std::vector<std::string>& head_rows,
                  const std::vector<std::string>& blocks);

/// One statement about figures, by a name of its own on the page, and whether it holds. Tables and claims rest on
/// these, so that they cannot say different things of one figure.
struct Judgement {
    std::string name;
    Verdict is;
};
Judgement at_most(std::string name, const Traced& measured, double limit);
Judgement at_least(std::string name, const Traced& measured, double limit);
/// Together.
Verdict verdict(const std::vector<Judgement>& on);

/// The last row of a block: what its figures say. Over all columns.
std::string conclusion(std::size_t columns, const std::vector<Judgement>& on, const std::string& sentence);
/// What the paper says, `where` it says so, and what ours says to it. `says` and `sentence` are HTML.
std::string claim(const std::string& says, const char* where, const std::vector<Judgement>& on,
                  const std::string& sentence);
std::string claims(const std::vector<std::string>& all);

/// Charts as inline SVG, each as a figure with its caption (HTML) and the lines that it is drawn from. One that is
/// empty is left out.
struct ChartFigure {
    Chart chart;
    std::string caption;
    std::vector<Source> from;
};
std::string chart(const ChartFigure& figure);

std::string section(const char* id, const std::string& title, const std::string& body);
std::string paragraph(const std::string& html);

/// The element of a line: what links lead to.
std::string anchor(const Source& at);

} // namespace cinch::html
