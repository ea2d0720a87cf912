// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bake/bake_rows.hpp"

#include <cmath>

#include "experiments/input_checksum.hpp"
#include "experiments/records/json_number.hpp"

namespace cinch {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const BakedFigures& f)
{
    return {{"time_mean", f.time_mean},    {"time_max", or_null(f.time_max)}, {"root", or_null(f.root)},
            {"leaves", or_null(f.leaves)}, {"missed_30fps", f.missed_30fps},  {"missed_keys", f.missed_keys},
            {"missed", f.missed_by_us},    {"key_segments", f.key_segments},  {"intervals", f.intervals},
            {"length_s", f.length_s}};
}

BakedFigures figures_of(const Json& f)
{
    return {number_or(f.at("time_mean"), HUGE_VAL),
            number_or(f.at("time_max"), HUGE_VAL),
            number_or(f.at("root"), HUGE_VAL),
            number_or(f.at("leaves"), HUGE_VAL),
            f.at("missed_30fps"),
            f.at("missed_keys"),
            f.at("missed"),
            f.at("key_segments"),
            f.at("intervals"),
            f.at("length_s")};
}

Json to_json(const Range& r) { return {or_null(r.value), or_null(r.low), or_null(r.high)}; }

Range range_of(const Json& r)
{
    if (r.at(0).is_null())
        return std::nan("");
    return {number_or(r.at(0), HUGE_VAL), number_or(r.at(1), HUGE_VAL), number_or(r.at(2), HUGE_VAL)};
}

} // namespace

Rows rows_of(const BakedClip& clip)
{
    Json head{{"clip", clip.name}, {"t0", clip.first_s}, {"t1", clip.last_s}};
    if (clip.verdict)
        head["verdict"] = {clip.verdict->bounds, clip.verdict->violated, clip.verdict->undecided, clip.verdict->pieces};
    if (!clip.worst.empty())
        head["worst"] = clip.worst;
    if (clip.figures)
        head["figures"] = to_json(*clip.figures);
    if (clip.cost)
        head["refits"] = {to_json(clip.cost->bend), to_json(clip.cost->norms)};
    Rows rows{std::move(head)};
    for (const BakedInterval& interval : clip.intervals) {
        Json supports = Json::array();
        for (const double s : interval.supports)
            supports.push_back(or_null(s));
        rows.push_back({{"t0", interval.first_s},
                        {"t1", interval.last_s},
                        {"intervals", interval.intervals},
                        {"supports", std::move(supports)}});
    }
    return rows;
}

BakedClip baked_clip_of(const Rows& rows)
{
    const Json& head = rows.front();
    BakedClip clip{head.at("clip"), head.at("t0"), head.at("t1"), {}, {}, head.value("worst", ""), {}, {}};
    if (head.contains("verdict")) {
        const Json& v = head.at("verdict");
        clip.verdict = {v.at(0), v.at(1), v.at(2), v.at(3), {}};
    }
    if (head.contains("figures"))
        clip.figures = figures_of(head.at("figures"));
    if (head.contains("refits"))
        clip.cost = {range_of(head.at("refits").at(0)), range_of(head.at("refits").at(1))};
    for (std::size_t i = 1; i < rows.size(); ++i) {
        BakedInterval interval{rows[i].at("t0"), rows[i].at("t1"), {}, rows[i].at("intervals")};
        for (const Json& s : rows[i].at("supports"))
            interval.supports.push_back(number_or(s, HUGE_VAL));
        clip.intervals.push_back(std::move(interval));
    }
    return clip;
}

exact::TimeVerdict verdict_of_clips(const Merged& all)
{
    exact::TimeVerdict verdict;
    for (const Rows& cell : all.cells)
        if (!cell.empty())
            if (const auto own = baked_clip_of({cell.front()}).verdict)
                verdict.add(*own);
    return verdict;
}

int status_of(const exact::TimeVerdict& verdict) { return verdict.violated || verdict.undecided ? 1 : 0; }

Json to_json(const BakedBody& body)
{
    return {{"input", body.name},    {"report", body.report},   {"missing", body.missing}, {"fields", body.fields},
            {"levels", body.levels}, {"written", body.written}, {"clips", body.clips}};
}

Json plan_of_bodies(const std::vector<TimedBody>& bodies, const std::vector<BakedBody>& said)
{
    Json all = Json::array();
    std::uint64_t sum = checksum_of_nothing;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        all.push_back(to_json(said[i]));
        sum = checksum_of(bodies[i], sum);
    }
    return {{"bodies", all}, {"checksum", sum}};
}

BakedBody baked_body_of(const Json& from)
{
    return {from.at("input"),  from.at("report"),  from.at("missing"), from.at("fields"),
            from.at("levels"), from.at("written"), from.at("clips")};
}

} // namespace cinch
