// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "experiments/report/number.hpp"
#include "experiments/report/table.hpp"
#include "experiments/verify_report.hpp"

namespace cinch {
namespace {

double share(double part, std::size_t whole) { return whole ? part / static_cast<double>(whole) : 0; }

const char* name_of(VerifiedUpdate update)
{
    return update == VerifiedUpdate::lazy    ? "lazy"
           : update == VerifiedUpdate::full  ? "full"
           : update == VerifiedUpdate::front ? "front"
                                             : "refit";
}

} // namespace

void print_lazy_table(const VerifiedInput& input, const VerifyOptions& options, const VerifyTotals& totals,
                      const LazyTotals& lazy, const Provenance& from)
{
    print_note(completeness_of(totals));
    for (const std::string& line : input.report)
        fmt::print("{}\n", line);
    const std::size_t k = static_cast<std::size_t>(options.kdop), steps = totals.frames / input.bodies;
    fmt::print("update {}, method {} in {}, {}-DOP, at most {} per leaf; {} of {}\n\n", name_of(options.update),
               cinch::name_of(options.methods), cinch::name_of(options.precision), options.kdop,
               counted(options.leaf, "triangle", "triangles"), steps,
               counted(totals.frames_wanted / input.bodies, "frame", "frames"));
    std::vector<std::vector<std::string>> rows;
    for (std::size_t i = 0; i < totals.levels.size(); ++i) {
        const LevelTotals& level = totals.levels[i];
        auto ratio = [&](double x) { return level.measured ? fmt::format("{:.3f}", x) : "-"; };
        rows.push_back({std::to_string(i), grouped(level.bvs),
                        fmt::format("{:.1f}", share(static_cast<double>((level.proven + level.violated) / k), steps)),
                        grouped(level.proven), grouped(level.violated), ratio(share(level.ratio_sum, level.measured)),
                        ratio(level.ratio_max)});
    }
    fmt::print("{}\n", table({"level", "BVs", "current", "proven", "violated", "ratio", "max"}, rows));
    fmt::print("current: BVs per frame that stand when the query ends. ratio, max: bound\n"
               "radius / true radius.\n\n");
    print_examples(totals, options.kdop);
    fmt::print("{} of triangles found; per frame {:.1f} BVs by the methods, {:.1f} merged,\n{:.1f} leaves from their "
               "vertices; {:.1f} left alone\n",
               counted(lazy.pairs, "pair", "pairs"), share(static_cast<double>(lazy.by_methods), steps),
               share(static_cast<double>(lazy.merged), steps), share(static_cast<double>(lazy.from_vertices), steps),
               share(static_cast<double>(lazy.left), steps));
    if (totals.infinite)
        fmt::print("{} infinite: something overflows the arithmetic\n",
                   counted(totals.infinite, "bound is", "bounds are"));
    fmt::print("{} bounds, {} proven, {} violated{}\n", grouped(totals.bounds), grouped(totals.proven),
               grouped(totals.violated), partial_mark(input.missing));
    fmt::print("{}\n{}\n", duration(totals.seconds), describe(from));
}

std::vector<nlohmann::ordered_json> lazy_records_of(const VerifiedInput& input, const VerifyOptions& options,
                                                    const VerifyTotals& totals, const LazyTotals& lazy)
{
    using json = nlohmann::ordered_json;
    std::vector<json> records;
    auto base = [&] {
        return json{{"experiment", "verify"},
                    {"input", input.name},
                    {"update", name_of(options.update)},
                    {"method", cinch::name_of(options.methods)},
                    {"precision", cinch::name_of(options.precision)},
                    {"kdop", options.kdop},
                    {"rest", options.rest_shape == RestShape::obb ? "obb" : "aabb"}};
    };
    for (std::size_t i = 0; i < totals.levels.size(); ++i) {
        const LevelTotals& level = totals.levels[i];
        json record = base();
        record.update({{"level", i},
                       {"bvs", level.bvs},
                       {"proven", level.proven},
                       {"violated", level.violated},
                       {"mean_ratio", level.measured ? json(share(level.ratio_sum, level.measured)) : json()},
                       {"max_ratio", level.measured ? json(level.ratio_max) : json()}});
        records.push_back(std::move(record));
    }
    for (const auto& example : totals.examples) {
        json record = base();
        record.update({{"frame", example.frame},
                       {"level", example.level},
                       {"bv", example.violation.bv},
                       {"direction", example.violation.direction},
                       {"violated_statement", exact::name_of(example.violation.statement)},
                       {"detail", example.violation.detail}});
        records.push_back(std::move(record));
    }
    json record = base();
    record.update({{"leaf_triangles", options.leaf},
                   {"bodies", input.bodies},
                   {"pairs", lazy.pairs},
                   {"by_methods", lazy.by_methods},
                   {"merged", lazy.merged},
                   {"from_vertices", lazy.from_vertices},
                   {"left", lazy.left},
                   {"bounds", totals.bounds},
                   {"proven", totals.proven},
                   {"violated", totals.violated},
                   {"infinite", totals.infinite},
                   {"seconds", totals.seconds},
                   {"load_report", input.report}});
    records.push_back(std::move(record));
    return records;
}

} // namespace cinch
