// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/page/page.hpp"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "experiments/report/number.hpp"
#include "experiments/report/page/charts.hpp"
#include "experiments/report/page/record_tables.hpp"
#include "experiments/report/page/sections.hpp"
#include "experiments/report/page/style.hpp"
#include "experiments/report/view.hpp"

namespace cinch {
namespace {

using html::escaped;

std::string document(const std::string& title, const std::string& body)
{
    return fmt::format("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
                       "content=\"width=device-width, initial-scale=1\">\n"
                       "<title>{}</title>\n<style>\n{}</style>\n</head>\n<body>\n<main>\n{}</main>\n<script>\n{}</"
                       "script>\n</body>\n</html>\n",
                       escaped(title), page_style, body, page_script);
}

std::vector<Section> sections_of(const Results& results)
{
    std::vector<Section> all;
    for (Section (*make)(const Results&) :
         {scaling_section, tightness_section, collide_section, cost_section, proof_section, audit_section})
        all.push_back(make(results));
    return all;
}

std::string claims_section(const std::vector<Section>& sections, bool unknown_too)
{
    std::vector<std::string> items;
    std::map<Verdict, std::size_t> count;
    for (const Section& section : sections)
        for (const Claim& claim : section.claims)
            if (unknown_too || claim.is() != Verdict::unknown) {
                items.push_back(html::claim(claim.says, claim.where, claim.on, claim.answer));
                ++count[claim.is()];
            }
    if (items.empty())
        return "";
    std::string sum = fmt::format("{} of {} hold here", count[Verdict::holds], items.size());
    if (count[Verdict::fails])
        sum += fmt::format(", {} {} not", count[Verdict::fails], count[Verdict::fails] == 1 ? "does" : "do");
    if (count[Verdict::unknown])
        sum +=
            fmt::format(", {} {} not measured", count[Verdict::unknown], count[Verdict::unknown] == 1 ? "is" : "are");
    if (count[Verdict::inconclusive])
        sum += fmt::format(", {} {} inconclusive", count[Verdict::inconclusive],
                           count[Verdict::inconclusive] == 1 ? "is" : "are");
    return html::section("claims", "What the paper says, and whether it holds here",
                         html::paragraph(sum + ". Each answer is computed from the results below.") +
                             html::claims(items));
}

// Links of the parts that are there.
std::string contents(const std::vector<std::pair<std::string, std::string>>& parts)
{
    std::string out = "<nav>";
    for (const auto& [id, title] : parts)
        out += fmt::format("<a href=\"#{}\">{}</a> ", id, title);
    return out + "</nav>\n";
}

// The views that are whole enough to be drawn.
std::string views_of(const Results& results)
{
    std::vector<nlohmann::ordered_json> views;
    for (const Record& record : results.all())
        if (is_view(record))
            views.push_back(record.fields["view"]);
    return views.empty() ? "" : view_sections(views);
}

// A result that is not of all of a file's surface says so before all else.
std::string partial_notice(const Results& results)
{
    std::vector<std::string> missing;
    for (const Record& record : results.all())
        if (const auto names = record.fields.find("missing"); names != record.fields.end() && names->is_array())
            for (const auto& name : *names)
                if (name.is_string() &&
                    std::find(missing.begin(), missing.end(), name.get<std::string>()) == missing.end())
                    missing.push_back(name.get<std::string>());
    return missing.empty() ? ""
                           : fmt::format("<p class=\"damage\"><strong>Partial</strong>, without {}</p>\n",
                                         escaped(fmt::format("{}", fmt::join(missing, "; "))));
}

const char* reading = "“Here” is what this program measured; “paper / here” is the published figure over ours, so that "
                      "with times a ratio above 1 says how many times faster it is here. Every figure of "
                      "ours links to the line of results that it comes from, at the end of this page, with its "
                      "command, seed, commit and machine. Grey italics are the paper’s own figures "
                      "(3.4 GHz Pentium 4).";

} // namespace

std::string command_page(const Results& results, const std::string& note)
{
    const std::vector<Section> sections = sections_of(results);
    std::string name = "cinch", line;
    if (!results.all().empty()) {
        name = "cinch " + results.all().front().word("experiment");
        line = results.all().front().word("command");
    }
    std::string body = fmt::format("<header>\n<h1>{}</h1>\n<p class=\"lead\"><code>{}</code></p>\n</header>\n",
                                   escaped(name), escaped(line));
    if (!note.empty())
        body += fmt::format("<p class=\"damage\"><strong>Not all of it:</strong> {}</p>\n", escaped(note));
    body += partial_notice(results);
    const std::string claims = note.empty() ? claims_section(sections, false) : "";
    if (!claims.empty())
        body += html::paragraph(reading) + claims;
    if (const std::string views = views_of(results); !views.empty())
        body += html::section("views", "To look at", views);
    bool paper = false;
    for (const Section& section : sections)
        if (!section.body.empty()) {
            body += html::section(section.id, section.title, section.body);
            paper = true;
        }
    if (!paper)
        for (const html::ChartFigure& chart : charts_of(results))
            body += html::chart(chart);
    body += record_tables(results) + provenance_section(results) + lines_section(results);
    return document(name, body);
}

std::string report_page(const Results& results, const ReportNotes& notes)
{
    const std::vector<Section> sections = sections_of(results);
    std::string body = "<header>\n<h1>Tight and efficient surface bounds, reproduced</h1>\n<p class=\"lead\">The "
                       "tables and figures of D. Steinemann, M. Otaduy and M. Gross, "
                       "<cite>Tight and efficient surface bounds in meshless animation</cite>, beside what "
                       "<code>cinch</code> measures on this machine.</p>\n</header>\n";
    for (const Damage& damage : notes.damage)
        body += fmt::format("<p class=\"damage\"><strong>Left out:</strong> {}</p>\n", escaped(describe(damage)));
    if (!notes.missing.empty())
        body += fmt::format("<p class=\"missing\"><strong>Not run yet:</strong> {}</p>\n",
                            escaped(fmt::format("{}", fmt::join(notes.missing, "; "))));
    if (!notes.left_out.empty())
        body += fmt::format("<p class=\"missing\"><strong>Not part of a quick run:</strong> {}</p>\n",
                            escaped(fmt::format("{}", fmt::join(notes.left_out, "; "))));
    for (const Record& record : results.all())
        if (is_closing(record) && record.number("status") != 0)
            body += fmt::format("<p class=\"damage\"><strong>A check failed:</strong> {}: <code>{}</code> ended with "
                                "exit status {}</p>\n",
                                escaped(record.word("stage")), escaped(record.word("measured_by")),
                                html::figure(Results::number(record, "status")));
    body += partial_notice(results);
    const std::string claims = claims_section(sections, true);
    std::vector<std::pair<std::string, std::string>> parts{{"claims", "Claims"}};
    std::string rest;
    for (const Section& section : sections)
        if (!section.body.empty()) {
            parts.emplace_back(section.id, section.title.substr(0, section.title.find(':')));
            rest += html::section(section.id, section.title, section.body);
        }
    const std::string views = views_of(results);
    if (!views.empty())
        parts.insert(parts.begin(), {"views", "Look"});
    parts.emplace_back("provenance", "Provenance");
    parts.emplace_back("lines", "Lines");
    body += contents(parts);
    if (!views.empty())
        body += html::section("views", "To look at", views);
    body += html::paragraph(reading) + claims + rest + provenance_section(results) + lines_section(results);
    return document("Tight and efficient surface bounds, reproduced", body);
}

} // namespace cinch
