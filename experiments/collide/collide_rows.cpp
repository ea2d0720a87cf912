// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/collide/collide_rows.hpp"

#include <algorithm>
#include <string>

#include <fmt/format.h>

namespace cinch {
namespace {

using Json = nlohmann::ordered_json;

// The fields of each by name, in both directions.
template <class M, class Field> void fields_of_measured(M& m, const Field& field)
{
    field("backend", m.backend);
    field("evaluate_ms", m.evaluate_ms);
    field("update_ms", m.update_ms);
    field("query_ms", m.query_ms);
    field("total_ms", m.total_ms);
    field("total_ms_low", m.total_ms_low);
    field("total_ms_high", m.total_ms_high);
    field("pairs", m.pairs);
    field("frames_done", m.frames);
    field("frames", m.frames_wanted);
    field("rounds_done", m.rounds);
    field("rounds", m.rounds_wanted);
    field("differing", m.differing);
    field("megabytes", m.megabytes);
    field("counts", m.counts);
    field("total_ms_of_frame", m.total_of_frame);
    field("pairs_of_frame", m.pairs_of_frame);
    field("body_pairs", m.sums.body_pairs);
    field("box_tests", m.sums.box_tests);
    field("leaf_pairs", m.sums.leaf_pairs);
    field("triangle_tests", m.sums.triangle_tests);
    field("in_double", m.sums.in_double);
    field("in_exact", m.sums.in_exact);
    field("bounds", m.sums.updates.bounds);
    field("leaves", m.sums.updates.leaves);
    field("updated_vertices", m.sums.updates.vertices);
    field("merged", m.sums.updates.merged);
}

template <class R, class Field> void fields_of_scene(R& r, const Field& field)
{
    field("scene", r.scene);
    field("bodies", r.bodies);
    field("vertices", r.vertices);
    field("nodes", r.nodes);
    field("backends_wanted", r.backends_wanted);
}

} // namespace

Json to_json(const SceneResult& result)
{
    Json row, backends = Json::array();
    fields_of_scene(result, [&](const char* name, const auto& value) { row[name] = value; });
    for (const Measured& m : result.backends) {
        Json one;
        fields_of_measured(m, [&](const char* name, const auto& value) { one[name] = value; });
        backends.push_back(std::move(one));
    }
    row["backends"] = std::move(backends);
    return row;
}

SceneResult scene_result_of(const Json& row)
{
    SceneResult result;
    fields_of_scene(result, [&](const char* name, auto& value) { row.at(name).get_to(value); });
    for (const Json& one : row.at("backends")) {
        Measured m;
        fields_of_measured(m, [&](const char* name, auto& value) { one.at(name).get_to(value); });
        result.backends.push_back(std::move(m));
    }
    return result;
}

Json record(const SceneResult& r, const Measured& m, bool cold)
{
    Json out{{"experiment", "collide"},
             {"scene", r.scene},
             {"backend", m.backend},
             {"bodies", r.bodies},
             {"vertices", r.vertices},
             {"n", r.nodes},
             {"frames_done", m.frames},
             {"frames", m.frames_wanted},
             {"rounds_done", m.rounds},
             {"rounds", m.rounds_wanted},
             {"complete", m.is_complete()},
             {"cold", cold},
             {"evaluate_ms", m.evaluate_ms},
             {"update_ms", m.update_ms},
             {"query_ms", m.query_ms},
             {"total_ms", m.total_ms},
             {"total_ms_low", m.total_ms_low},
             {"total_ms_high", m.total_ms_high},
             {"pairs", m.pairs},
             {"pairs_differing", m.differing},
             {"megabytes_per_body", m.megabytes}};
    if (const Measured* full = r.of("refit-1")) {
        const Range gain = full->total() / m.total();
        out.update({{"gain", gain.value}, {"gain_low", gain.low}, {"gain_high", gain.high}});
    }
    if (m.counts) {
        const QueryCounts& c = m.sums;
        const double frames = static_cast<double>(m.frames),
                     tests = std::max<double>(1, static_cast<double>(c.triangle_tests));
        auto mean = [&](auto x) { return static_cast<double>(x) / frames; };
        out.update({{"mean_bounds", mean(c.updates.bounds)},
                    {"mean_leaves", mean(c.updates.leaves)},
                    {"mean_vertices", mean(c.updates.vertices)},
                    {"mean_merged", mean(c.updates.merged)},
                    {"mean_box_tests", mean(c.box_tests)},
                    {"mean_leaf_pairs", mean(c.leaf_pairs)},
                    {"mean_triangle_tests", mean(c.triangle_tests)},
                    {"share_double", static_cast<double>(c.in_double) / tests},
                    {"share_exact", static_cast<double>(c.in_exact) / tests}});
    }
    auto rounded = [](const std::vector<double>& all) { // six digits say it
        Json list = Json::array();
        for (const double x : all)
            list.push_back(std::stod(fmt::format("{:.6g}", x)));
        return list;
    };
    out.update({{"pairs_of_frame", rounded(m.pairs_of_frame)}, {"total_ms_of_frame", rounded(m.total_of_frame)}});
    return out;
}

} // namespace cinch
