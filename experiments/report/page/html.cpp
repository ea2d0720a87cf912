// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/page/html.hpp"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "experiments/report/number.hpp"

namespace cinch::html {
namespace {

// "scaling.jsonl lines 3, 7-9; cost.jsonl line 1"
std::string places(const std::vector<Source>& from)
{
    std::map<std::string, std::vector<std::size_t>> files;
    for (const Source& source : from)
        files[source.file].push_back(source.line);
    std::string out;
    for (auto& [file, lines] : files) {
        std::sort(lines.begin(), lines.end());
        std::string text;
        std::size_t count = 0;
        for (std::size_t i = 0; i < lines.size();) {
            std::size_t end = i + 1;
            while (end < lines.size() && lines[end] <= lines[end - 1] + 1)
                ++end;
            text +=
                (text.empty() ? "" : ", ") +
                (lines[end - 1] > lines[i] ? fmt::format("{}–{}", lines[i], lines[end - 1]) : std::to_string(lines[i]));
            count += lines[end - 1] - lines[i] + 1;
            i = end;
        }
        out += fmt::format("{}{}.jsonl {} {}", out.empty() ? "" : "; ", file, count == 1 ? "line" : "lines", text);
    }
    return out;
}

// gnuplot's document as an element of the page: without its head, with ids of its own.
std::string inlined(std::string svg, const std::string& label)
{
    svg.erase(0, svg.find("<svg"));
    const std::string prefix = fmt::format("c{:x}-", std::hash<std::string>{}(svg));
    for (const char* mark : {"id='", "id=\"", "href='#", "url(#"})
        for (std::size_t at = 0; (at = svg.find(mark, at)) != std::string::npos; at += prefix.size()) {
            at += std::string_view(mark).size();
            svg.insert(at, prefix);
        }
    const std::size_t title = svg.find("<title>"), end = svg.find("</desc>");
    if (title != std::string::npos && end != std::string::npos)
        svg.replace(title, end + 7 - title, "<title>" + escaped(label) + "</title>");
    return svg.replace(0, 4, "<svg role=\"img\"");
}

const char* css_of(Verdict is) { return is == Verdict::holds ? "same" : is == Verdict::fails ? "differs" : "unknown"; }

// The verdict in a word, what it rests on, and a sentence.
std::string marked(const std::vector<Judgement>& on, const char* holds, const char* fails, const std::string& sentence)
{
    const Verdict is = verdict(on);
    std::string names;
    for (const Judgement& judgement : on)
        names += fmt::format("{}{}:{}", names.empty() ? "" : " ", judgement.name, name_of(judgement.is));
    return fmt::format("<strong class=\"{}\" data-verdict=\"{}\" data-on=\"{}\">{}</strong> {}", css_of(is),
                       name_of(is), escaped(names),
                       is == Verdict::holds          ? holds
                       : is == Verdict::fails        ? fails
                       : is == Verdict::inconclusive ? "Inconclusive: the rounds are too far apart."
                                                     : "Not measured.",
                       sentence);
}

std::string all_of(const std::vector<std::string>& parts)
{
    std::string out;
    for (const std::string& part : parts)
        out += part;
    return out;
}

} // namespace

std::string escaped(std::string_view text)
{
    std::string out;
    for (const char c : text)
        switch (c) {
        case '<':
            out += "&lt;";
            break;
        case '>':
            out += "&gt;";
            break;
        case '&':
            out += "&amp;";
            break;
        case '"':
            out += "&quot;";
            break;
        case '\'':
            out += "&#39;";
            break;
        default:
            out += static_cast<unsigned char>(c) < 32 && c != '\n' && c != '\t' ? ' ' : c;
        }
    return out;
}

std::string digits(double x)
{
    const double size = std::abs(x);
    if (!std::isfinite(x))
        return "–";
    if (x == std::trunc(x) && size < 1e15) // counts, and what happens to be whole
        return (x < 0 ? "−" : "") + grouped(static_cast<std::size_t>(size));
    if (size >= 1e15 || size < 1e-3)
        return fmt::format("{:.2e}", x);
    if (size >= 999.5)
        return (x < 0 ? "−" : "") + grouped(static_cast<std::size_t>(size + 0.5));
    const std::string text = size >= 99.95    ? fmt::format("{:.0f}", size)
                             : size >= 9.995  ? fmt::format("{:.1f}", size)
                             : size >= 0.9995 ? fmt::format("{:.2f}", size)
                                              : fmt::format("{:.3f}", size);
    return (x < 0 ? "−" : "") + text;
}

std::string anchor(const Source& at) { return fmt::format("{}.{}", at.file, at.line); }

std::string figure(const Traced& x, const std::string& text)
{
    if (!x.known() || x.from.empty())
        return "<span class=\"none\">–</span>";
    return fmt::format("<a class=\"f\" href=\"#{}\" title=\"{}\">{}</a>", escaped(anchor(x.from.front())),
                       escaped(places(x.from)), escaped(text));
}

std::string figure(const Traced& x) { return figure(x, digits(x.value)); }

std::string percent(const Traced& x) { return figure(x, fmt::format("{:.0f} %", 100 * x.value)); }

std::string cell(const Traced& x, const std::string& text)
{
    return fmt::format("<td class=\"n\">{}</td>", figure(x, text));
}
std::string cell(const Traced& x) { return cell(x, digits(x.value)); }

std::string paper_cell(const PaperFigure& x)
{
    return fmt::format("<td class=\"n p\" data-paper=\"{}, {}, {}\">{}</td>", x.place, x.row, x.column,
                       x.value >= 999.5 ? digits(x.value) : fmt::format("{:g}", x.value));
}

std::string text_cell(std::string_view text, const char* css) { return raw_cell(escaped(text), css); }

std::string raw_cell(const std::string& text, const char* css)
{
    return *css ? fmt::format("<td class=\"{}\">{}</td>", css, text) : fmt::format("<td>{}</td>", text);
}

std::string head_cell(const std::string& text, std::size_t columns)
{
    return columns == 1 ? fmt::format("<th scope=\"col\">{}</th>", text)
                        : fmt::format("<th scope=\"colgroup\" colspan=\"{}\">{}</th>", columns, text);
}

std::string row(const std::vector<std::string>& cells) { return "<tr>" + all_of(cells) + "</tr>\n"; }

std::string block(const std::vector<std::string>& rows, const char* css)
{
    return fmt::format("<tbody{}>\n{}</tbody>\n", *css ? fmt::format(" class=\"{}\"", css) : "", all_of(rows));
}

std::string table(const std::string& caption, const std::vector<std::string>& head_rows,
                  const std::vector<std::string>& blocks)
{
    return fmt::format(
        "<div class=\"table\"><table>\n<caption><div>{}</div></caption>\n<thead>\n{}</thead>\n{}</table></div>\n",
        caption, all_of(head_rows), all_of(blocks));
}

Judgement at_most(std::string name, const Traced& measured, double limit)
{
    return {std::move(name), cinch::at_most(measured.range(), limit)};
}

Judgement at_least(std::string name, const Traced& measured, double limit)
{
    return {std::move(name), cinch::at_least(measured.range(), limit)};
}

Verdict verdict(const std::vector<Judgement>& on)
{
    std::vector<Verdict> all;
    for (const Judgement& judgement : on)
        all.push_back(judgement.is);
    return cinch::all_of(all);
}

std::string conclusion(std::size_t columns, const std::vector<Judgement>& on, const std::string& sentence)
{
    return fmt::format("<tr class=\"why\"><td colspan=\"{}\"><div>{}</div></td></tr>\n", columns,
                       marked(on, "Same.", "Differs.", sentence));
}

std::string claim(const std::string& says, const char* where, const std::vector<Judgement>& on,
                  const std::string& sentence)
{
    return fmt::format("<li class=\"{}\"><p class=\"says\">{} <cite>{}</cite></p>\n<p>{}</p></li>\n",
                       css_of(verdict(on)), says, where, marked(on, "Confirmed.", "Not confirmed.", sentence));
}

std::string claims(const std::vector<std::string>& all) { return "<ul class=\"claims\">\n" + all_of(all) + "</ul>\n"; }

std::string section(const char* id, const std::string& title, const std::string& body)
{
    return fmt::format("<section id=\"{}\">\n<h2>{}</h2>\n{}</section>\n", id, title, body);
}

std::string paragraph(const std::string& text) { return "<p>" + text + "</p>\n"; }

std::string chart(const ChartFigure& of)
{
    Chart shown = of.chart;
    std::erase_if(shown.series, [](const Series& series) { return series.x.empty(); });
    if (shown.series.empty())
        return "";
    const std::string places_text = places(of.from);
    return fmt::format("<figure class=\"chart\">\n<div>{}</div>\n<figcaption>{} <span "
                       "class=\"from\">{}</span></figcaption>\n</figure>\n",
                       inlined(drawn(shown, Picture::svg), shown.title), of.caption,
                       of.from.empty() ? ""
                                       : fmt::format("<a class=\"f\" href=\"#{}\">{}</a>",
                                                     escaped(anchor(of.from.front())), escaped(places_text)));
}

} // namespace cinch::html
