// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/corners.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cinch/environment.hpp"
#include "cinch/surface.hpp"
#include "exact/answers.hpp"
#include "exact/corners.hpp"
#include "experiments/case_file.hpp"
#include "experiments/report/interrupt.hpp"
#include "experiments/report/whole_file.hpp"
#include "toolkit/bounds/rounding.hpp"
#include "toolkit/bounds/weight_space.hpp"

namespace cinch {
namespace {

using Json = nlohmann::ordered_json;

// The toolkit's proven bound for extrema that are exact as given: method `limited` without a box.
double toolkit_bound(WeightSpace space, const std::vector<double>& b)
{
    std::vector<std::pair<double, double>> scratch;
    return std::min({*std::max_element(b.begin(), b.end()), dual_bound(space, b, second_largest(b), Rounding::proven),
                     dual_bound(space, b, best_lambda(space, b, scratch), Rounding::proven)});
}

struct Row {
    std::optional<exact::Answer> answer;
    double bound = 0;
};

Json record_of(const std::string& file, const Case& problem, bool feasible, const exact::CornerCount& count,
               const std::vector<Row>& rows)
{
    Json record{{"experiment", "corners"},       {"file", file},
                {"n", problem.space().l.size()}, {"feasible", feasible},
                {"vertex_count", nullptr},       {"rows", Json::array()}};
    if (count.count)
        record["vertex_count"] = *count.count;
    else
        record["vertex_count_reason"] = count.reason;
    for (const Row& row : rows) {
        Json r{{"exact_max", nullptr}, {"eq12", nullptr}, {"bound", nullptr}, {"lambda", nullptr}};
        if (row.answer) {
            r = {{"exact_max", row.answer->maximum},
                 {"eq12", nullptr},
                 {"bound", fmt::format("{:a}", row.bound)},
                 {"lambda", row.answer->lambda},
                 {"corner", row.answer->corner},
                 {"bound_holds", row.answer->bound_holds}};
            if (row.answer->eq12)
                r["eq12"] = *row.answer->eq12;
        }
        record["rows"].push_back(r);
    }
    return record;
}

void print_text(const std::string& file, bool feasible, const exact::CornerCount& count, const std::vector<Row>& rows)
{
    fmt::print("{}: {}, {}\n", file, feasible ? "feasible" : "infeasible: no weights sum to 1",
               count.count ? *count.count + " corners" : count.reason);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (!rows[i].answer)
            continue;
        const exact::Answer& a = *rows[i].answer;
        fmt::print("  b[{}]  maximum {}\n        Eq. 12  {}\n        bound   {:a} = {:.17g}{}\n        lambda  {}\n", i,
                   a.maximum, a.eq12 ? *a.eq12 : "undefined for n = 1", rows[i].bound, rows[i].bound,
                   a.bound_holds ? "" : ", BELOW the maximum", a.lambda);
    }
}

// Throws Interrupted, and says so where the list ends.
void list_corners(const std::string& file, WeightSpace space, const CornersOptions& options, RecordOutput& output)
{
    std::uint64_t listed = 0;
    exact::visit_corners(space, [&](const exact::CornerRun& run, const exact::Corner& corner) {
        const std::vector<std::string> weights = exact::weights_of(space, run, corner);
        if (options.output.json) // one of very many: without provenance
            fmt::print("{}\n", Json{{"experiment", "corners"},
                                    {"file", file},
                                    {"corner", weights},
                                    {"frames_done", 0},
                                    {"frames", 0},
                                    {"complete", true}}
                                   .dump(-1, ' ', false, Json::error_handler_t::replace));
        else
            fmt::print("{}\n", fmt::join(weights, " "));
        return ++listed != options.limit && !interrupted();
    });
    if (!interrupted())
        return;
    output.add({{"experiment", "corners"}, {"file", file}, {"corners_listed", listed}, {"complete", false}});
    if (!options.output.records_only())
        fmt::print("{}: interrupted after {} corners\n", file, listed);
    throw Interrupted{};
}

} // namespace

int corners(const CornersOptions& options)
{
    require_default_arithmetic();
    RecordOutput output(options.output, provenance(1, 0));
    for (const std::string& file : options.files)
        guard_input(file);
    catch_interrupt();
    int status = 0;
    std::size_t done = 0;
    auto answer = [&](const std::string& file) {
        const Case problem = read_case(file);
        const bool feasible = exact::is_feasible(problem.space());
        const exact::CornerCount count = exact::count_corners(problem.space());
        std::vector<Row> rows;
        for (const std::vector<double>& b : problem.b) {
            throw_if_interrupted();
            Row row{std::nullopt, toolkit_bound(problem.space(), b)};
            row.answer = exact::answer(problem.space(), b, row.bound);
            if (row.answer && !row.answer->bound_holds)
                status = std::max(status, 1);
            rows.push_back(std::move(row));
        }
        output.add(record_of(file, problem, feasible, count, rows));
        if (!options.output.records_only())
            print_text(file, feasible, count, rows);
        if (options.list)
            list_corners(file, problem.space(), options, output);
    };
    try {
        for (const std::string& file : options.files) {
            throw_if_interrupted();
            try {
                answer(file);
            } catch (const InputError& error) {
                std::fflush(stdout);
                fmt::print(stderr, "cinch: {}\n", error.what());
                status = 2;
            }
            ++done;
        }
    } catch (const Interrupted&) { // files before it are kept
    }
    const bool is_complete = done == options.files.size();
    const Completeness completeness{0, 0, is_complete,
                                    is_complete ? "" : interrupted_after(done, options.files.size(), "files")};
    output.set(completeness);
    if (!is_complete) // those that came before had no way to know
        output.add({{"experiment", "corners"}, {"files_done", done}, {"files", options.files.size()}});
    output.finish();
    if (is_complete)
        return status;
    if (!options.output.records_only())
        fmt::print("{}\n", completeness.note);
    std::fflush(stdout);
    fmt::print(stderr, "cinch: {}\n", completeness.note);
    return status == 1 ? 1 : 130;
}

} // namespace cinch
