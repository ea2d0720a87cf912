// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/verify_report.hpp"

#include <fmt/format.h>

#include "cinch/bounds.hpp"
#include "experiments/report/number.hpp"
#include "experiments/report/table.hpp"

namespace cinch {
namespace {

double rate(std::size_t part, std::size_t whole)
{
    return whole ? static_cast<double>(part) / static_cast<double>(whole) : 0;
}

struct LevelMeans {
    double n, ratio, box, interval, corner, rounding;
};

LevelMeans means(const LevelTotals& level)
{
    const double m = level.measured ? static_cast<double>(level.measured) : 1;
    return {level.bvs ? level.nodes / static_cast<double>(level.bvs) : 0,
            level.ratio_sum / m,
            level.loss.box / m,
            level.loss.interval / m,
            level.loss.corner / m,
            level.loss.rounding / m};
}

std::string direction_name(int kdop, int direction)
{
    if (direction < 0)
        return "all directions";
    const Axis& axis = axes_of(kdop)[static_cast<std::size_t>(direction / 2)];
    const int sign = direction % 2 ? -1 : 1;
    return fmt::format("direction ({}, {}, {})", sign * axis[0], sign * axis[1], sign * axis[2]);
}

} // namespace

void print_examples(const VerifyTotals& totals, int kdop)
{
    for (const auto& example : totals.examples)
        fmt::print("violated: frame {}, level {}, BV {}, {}: {}: {}\n", example.frame, example.level,
                   example.violation.bv, direction_name(kdop, example.violation.direction),
                   exact::name_of(example.violation.statement), example.violation.detail);
    if (!totals.examples.empty())
        fmt::print("\n");
}

void print_table(const VerifiedInput& input, const VerifyOptions& options, const VerifyTotals& totals,
                 const Provenance& from)
{
    print_note(completeness_of(totals));
    for (const std::string& line : input.report)
        fmt::print("{}\n", line);
    fmt::print("method {} in {}, {}-DOP, at most {} per leaf; {} of {}\n\n", name_of(options.methods),
               name_of(options.precision), options.kdop, counted(options.leaf, "triangle", "triangles"), totals.frames,
               counted(totals.frames_wanted, "frame", "frames"));

    const bool boxes = options.methods.within(box_methods) && options.rest_shape == RestShape::aabb;
    std::vector<std::vector<std::string>> rows;
    for (std::size_t i = 0; i < totals.levels.size(); ++i) {
        const LevelTotals& level = totals.levels[i];
        const LevelMeans mean = means(level);
        auto share = [&](double x) { return level.measured ? fmt::format("{:.3f}", x) : "-"; };
        rows.push_back({std::to_string(i), grouped(level.bvs), fmt::format("{:.1f}", mean.n), grouped(level.proven),
                        grouped(level.violated), share(mean.ratio), share(level.ratio_max), share(mean.box),
                        share(mean.interval), share(mean.corner),
                        level.measured && (boxes || options.methods == Method::vertices)
                            ? fmt::format("{:.0e}", mean.rounding)
                            : "-"});
    }
    fmt::print("{}\n", table({"level", "BVs", "n", "proven", "violated", "ratio", "max", "box", "interval",
                              boxes ? "corner" : "method", "rounding"},
                             rows));
    fmt::print("n: simulation nodes per BV, mean. ratio, max: bound radius / true radius.\n"
               "box, interval, {}: what the bound gives away per direction, and\n"
               "why, as a mean share of the true radius{}.\n\n",
               boxes ? "corner, rounding" : "method",
               boxes ? "" : ";\nmethod: all that is neither, negative where it knows more than weight intervals");

    if (!totals.volumes.empty()) {
        std::vector<std::vector<std::string>> volumes;
        for (std::size_t i = 0; i < totals.volumes.size(); ++i) {
            const VolumeTotals& v = totals.volumes[i];
            volumes.push_back({std::to_string(i), grouped(v.measured), grouped(v.flat),
                               v.measured ? fmt::format("{:.3f}", v.ratio_sum / static_cast<double>(v.measured)) : "-",
                               v.measured ? fmt::format("{:.3f}", v.ratio_max) : "-",
                               fmt::format("{:.2f}", rate(v.redundant, v.measured + v.flat))});
        }
        fmt::print("{}\n", table({"level", "measured", "flat", "volume ratio", "max", "redundant planes"}, volumes));
        fmt::print("volume ratio: exact volume of the bound / exact volume of the true {}-DOP, on a sample\n"
                   "of each level; flat: BVs whose true {}-DOP has no volume.\n\n",
                   options.kdop, options.kdop);
    }
    print_examples(totals, options.kdop);
    if (totals.ladder.broken)
        fmt::print("order of the ladder: limited <= eq12 <= convex broken {} times in {}\n",
                   grouped(totals.ladder.broken), grouped(totals.ladder.compared));
    else
        fmt::print("order of the ladder: limited <= eq12 <= convex in all of {} comparisons\n",
                   grouped(totals.ladder.compared));
    if (totals.ladder.defaults)
        fmt::print("default above eq12 in {} of {} ({:.1f} %), by over 1 % of its width in {}\n",
                   grouped(totals.ladder.above), grouped(totals.ladder.defaults),
                   100 * rate(totals.ladder.above, totals.ladder.defaults),
                   totals.ladder.clearly ? grouped(totals.ladder.clearly) : "none");
    if (options.stats)
        fmt::print(
            "memory: {:.1f} MB streamed by the kernels ({:.0f} bytes per BV), {:.1f} MB of rest data\n",
            static_cast<double>(totals.packed_bytes) / 1e6,
            rate(totals.packed_bytes,
                 totals.bounds / std::max<std::size_t>(1, totals.frames * static_cast<std::size_t>(options.kdop))),
            static_cast<double>(totals.rest_bytes) / 1e6);
    if (totals.infinite)
        fmt::print("{} infinite: something overflows the arithmetic\n",
                   counted(totals.infinite, "bound is", "bounds are"));
    fmt::print("{} bounds, {} proven, {} violated{}\n", grouped(totals.bounds), grouped(totals.proven),
               grouped(totals.violated), partial_mark(input.missing));
    fmt::print("{}, filter hit rate {:.4f}\n{}\n", duration(totals.seconds),
               rate(totals.decided_by_filter, totals.bounds), describe(from));
}

std::vector<nlohmann::ordered_json> records_of(const VerifiedInput& input, const VerifyOptions& options,
                                               const VerifyTotals& totals)
{
    using json = nlohmann::ordered_json;
    std::vector<json> records;
    auto base = [&] {
        return json{{"experiment", "verify"},
                    {"input", input.name},
                    {"method", name_of(options.methods)},
                    {"precision", name_of(options.precision)},
                    {"kdop", options.kdop},
                    {"rest", options.rest_shape == RestShape::obb ? "obb" : "aabb"}};
    };
    for (std::size_t i = 0; i < totals.levels.size(); ++i) {
        const LevelTotals& level = totals.levels[i];
        const LevelMeans mean = means(level);
        json record = base();
        auto share = [&](double x) { return level.measured ? json(x) : json(); }; // null where nothing has a size
        record.update({{"level", i},
                       {"bvs", level.bvs},
                       {"mean_n", mean.n},
                       {"proven", level.proven},
                       {"violated", level.violated},
                       {"mean_ratio", share(mean.ratio)},
                       {"max_ratio", share(level.ratio_max)},
                       {"box_loss", share(mean.box)},
                       {"interval_loss", share(mean.interval)},
                       {"corner_loss", share(mean.corner)},
                       {"rounding_loss", share(mean.rounding)}});
        if (!totals.volumes.empty()) {
            const VolumeTotals& v = totals.volumes[i];
            record.update(
                {{"volume_measured", v.measured},
                 {"volume_flat", v.flat},
                 {"mean_volume_ratio", v.measured ? json(v.ratio_sum / static_cast<double>(v.measured)) : json()},
                 {"max_volume_ratio", v.measured ? json(v.ratio_max) : json()},
                 {"redundant_planes", v.redundant}});
        }
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
    for (const auto& root : totals.root) {
        json record = base();
        record.update({{"attribution", "exact"},
                       {"frame", totals.frames - 1},
                       {"bv", 0},
                       {"direction", root.direction},
                       {"bound", fmt::format("{:a}", root.bound)},
                       {"box_loss", root.loss.box},
                       {"interval_loss", root.loss.interval},
                       {"corner_loss", root.loss.corner},
                       {"rounding_loss", root.loss.rounding},
                       {"total_loss", root.loss.total}});
        records.push_back(std::move(record));
    }
    json record = base();
    record.update({{"leaf_triangles", options.leaf},
                   {"vertices", input.vertices},
                   {"triangles", input.triangles},
                   {"nodes", input.nodes},
                   {"bodies", input.bodies},
                   {"motion", input.motion},
                   {"bounds", totals.bounds},
                   {"proven", totals.proven},
                   {"violated", totals.violated},
                   {"infinite", totals.infinite},
                   {"ladder_compared", totals.ladder.compared},
                   {"ladder_broken", totals.ladder.broken},
                   {"default_compared", totals.ladder.defaults},
                   {"default_above_eq12", totals.ladder.above},
                   {"default_clearly_above_eq12", totals.ladder.clearly},
                   {"filter_hit_rate", rate(totals.decided_by_filter, totals.bounds)},
                   {"seconds", totals.seconds},
                   {"packed_bytes", totals.packed_bytes},
                   {"rest_bytes", totals.rest_bytes},
                   {"load_report", input.report}});
    records.push_back(std::move(record));
    return records;
}

} // namespace cinch
