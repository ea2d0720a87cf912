// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/page/record_tables.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "experiments/report/number.hpp"
#include "experiments/report/page/html.hpp"
#include "experiments/report/provenance.hpp"

namespace cinch {
namespace {

using html::escaped;
using Json = nlohmann::ordered_json;

std::string value_cell(const Record& record, const std::string& field)
{
    const Json& value = record.fields.at(field);
    if (value.is_number())
        return html::cell(Results::number(record, field.c_str()));
    if (value.is_string())
        return html::text_cell(value.get<std::string>());
    return html::text_cell(value.is_null()      ? "–"
                           : value.is_boolean() ? (value.get<bool>() ? "yes" : "no")
                                                : value.dump(-1, ' ', false, Json::error_handler_t::replace));
}

/// Fields that a table shows: neither provenance nor series nor the ends of a range.
std::vector<std::string> columns_of(const Record& record)
{
    static const Json provenance_fields = to_json(Provenance{});
    std::vector<std::string> columns;
    for (const auto& [name, value] : record.fields.items())
        if (!provenance_fields.contains(name) && name != "experiment" && !(value.is_array() && value.size() > 8) &&
            !name.ends_with("_low") && !name.ends_with("_high"))
            columns.push_back(name);
    return columns;
}

/// Of several records, the columns in which all say the same, said once: "input santa; k 6".
std::string take_constant(std::vector<std::string>& columns, const std::vector<const Record*>& records)
{
    std::string said;
    if (records.size() < 2)
        return said;
    std::erase_if(columns, [&](const std::string& column) {
        const Json& first = records.front()->fields.at(column);
        if (!std::all_of(records.begin(), records.end(),
                         [&](const Record* r) { return r->fields.at(column) == first; }))
            return false;
        said += fmt::format("{}{} {}", said.empty() ? "" : "; ", column,
                            first.is_string() ? first.get<std::string>()
                                              : first.dump(-1, ' ', false, Json::error_handler_t::replace));
        return true;
    });
    return said;
}

/// A line for people: of one with much data its fields without that, and how long it is.
std::string shortened(const Record& r)
{
    constexpr std::size_t most = 8000;
    if (r.text.size() <= most)
        return r.text;
    Json rest = Json::object();
    for (const auto& [name, value] : r.fields.items())
        if (value.is_primitive() && (!value.is_string() || value.get_ref<const std::string&>().size() <= 1000))
            rest[name] = value;
    return fmt::format("{} … {} bytes in all", rest.dump(-1, ' ', false, Json::error_handler_t::replace),
                       grouped(r.text.size()));
}

} // namespace

std::string record_tables(const Results& results)
{
    std::vector<std::pair<std::vector<std::string>, std::vector<const Record*>>> groups;
    for (const Record& record : results.all()) {
        const auto columns = columns_of(record);
        auto found =
            std::find_if(groups.begin(), groups.end(), [&](const auto& group) { return group.first == columns; });
        if (found == groups.end())
            found = groups.insert(groups.end(), {columns, {}});
        found->second.push_back(&record);
    }
    std::string body;
    for (auto& [columns, records] : groups) {
        const std::string same = take_constant(columns, records);
        std::vector<std::string> head, rows;
        for (const std::string& column : columns)
            head.push_back(html::head_cell(escaped(column)));
        for (const Record* record : records) {
            std::vector<std::string> cells;
            for (const std::string& column : columns)
                cells.push_back(value_cell(*record, column));
            rows.push_back(html::row(cells));
        }
        body += html::table(counted(records.size(), "record", "records") +
                                (same.empty() ? "" : fmt::format("; in all of them: {}", escaped(same))),
                            {html::row(head)}, {html::block(rows)});
    }
    return body.empty() ? "" : html::section("records", "Records", body);
}

std::string provenance_section(const Results& results)
{
    constexpr std::array traced{"command", "commit", "seed", "cpu"};
    // Lines of one command are together, and most files are of one command.
    struct Run {
        const Record* first;
        std::size_t last;
        const Record* closing = nullptr;
    };
    std::vector<Run> runs;
    for (const Record& r : results.all()) {
        if (!runs.empty() && is_closing(r) && runs.back().first->at.file == r.at.file) {
            runs.back().closing = &r;
            continue;
        }
        const auto same = [&](const Run& run) {
            return run.first->at.file == r.at.file && std::all_of(traced.begin(), traced.end(), [&](const char* field) {
                       return run.first->fields.value(field, Json()) == r.fields.value(field, Json());
                   });
        };
        if (runs.empty() || !same(runs.back()))
            runs.push_back({&r, r.at.line});
        runs.back().last = r.at.line;
    }
    std::vector<std::string> rows;
    for (const Run& run : runs) {
        const Record& r = *run.first;
        const Record* closing = run.closing;
        const std::size_t threads =
            r.number("threads") > 0 ? static_cast<std::size_t>(std::min(r.number("threads"), 1e6)) : 0;
        rows.push_back(html::row(
            {html::raw_cell(fmt::format("<a class=\"f\" href=\"#{}\">{}.jsonl</a>, {}–{}", escaped(html::anchor(r.at)),
                                        escaped(r.at.file), r.at.line, run.last),
                            "l"),
             html::raw_cell("<code>" + escaped(r.word("command")) + "</code>", "l"),
             html::cell(Results::number(r, "seed")), html::raw_cell("<code>" + escaped(r.word("commit")) + "</code>"),
             html::text_cell(fmt::format("{}, {}, {}", r.word("cpu"), r.word("simd_target"),
                                         counted(threads, "thread", "threads"))),
             closing ? html::cell(Results::number(*closing, "seconds"), duration(closing->number("seconds")))
                     : html::text_cell(""),
             html::text_cell(closing ? closing->word("finished") : "")}));
    }
    return html::section(
        "provenance", "Provenance: where everything comes from",
        html::table("Command, seed, commit and machine of every line.",
                    {html::row({html::head_cell("file, lines"), html::head_cell("command"), html::head_cell("seed"),
                                html::head_cell("commit"), html::head_cell("machine"), html::head_cell("took"),
                                html::head_cell("finished")})},
                    {html::block(rows)}));
}

std::string lines_section(const Results& results)
{
    std::string body, file;
    for (const Record& r : results.all()) {
        if (r.at.file != file) {
            body += fmt::format("{}<details><summary>{}.jsonl</summary>\n<ol class=\"lines\">\n",
                                file.empty() ? "" : "</ol></details>\n", escaped(r.at.file));
            file = r.at.file;
        }
        body += fmt::format("<li id=\"{}\" value=\"{}\"><code>{}</code></li>\n", escaped(html::anchor(r.at)), r.at.line,
                            escaped(shortened(r)));
    }
    return body.empty() ? "" : html::section("lines", "Lines of results", body + "</ol></details>\n");
}

} // namespace cinch
