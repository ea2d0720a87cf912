// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/verify_rows.hpp"

#include <algorithm>

#include "experiments/certificate_parts.hpp"
#include "experiments/input_checksum.hpp"
#include "experiments/records/run_campaign.hpp"
#include "experiments/verify_report.hpp"

namespace cinch {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const exact::Loss& loss) { return {loss.box, loss.interval, loss.corner, loss.rounding}; }

exact::Loss loss_of(const Json& sums) { return {sums[0], sums[1], sums[2], sums[3]}; }

void add(const exact::Loss& more, exact::Loss& sum)
{
    sum.box += more.box;
    sum.interval += more.interval;
    sum.corner += more.corner;
    sum.rounding += more.rounding;
}

VerifyTotals totals_of(const Merged& all)
{
    VerifyTotals totals;
    totals.frames_wanted = all.cells.size();
    for (const Rows& cell : all.cells)
        for (const Json& row : cell)
            add_row(row, totals);
    finish(totals);
    return totals;
}

int verdict_of(const VerifyTotals& totals) { return totals.violated || !totals.ladder.holds() ? 1 : 0; }

} // namespace

int verdict_of(const Merged& all) { return verdict_of(totals_of(all)); }

VerifiedInput verified(const Inputs& inputs)
{
    VerifiedInput out{
        inputs.name, inputs.bodies[0].clip.name, inputs.report, inputs.missing(), inputs.bodies.size(), 0, 0,
        0,           fields_of(inputs)};
    for (const Input& body : inputs.bodies) {
        out.vertices += body.surface.mesh.vertices.size();
        out.triangles += body.surface.mesh.triangles.size();
        out.nodes += body.surface.weights.node_count;
    }
    return out;
}

Json verify_plan(const Inputs& inputs, const VerifyOptions& o)
{
    const VerifiedInput input = verified(inputs);
    Json frames = Json::array();
    for (const Input& body : inputs.bodies)
        frames.push_back(body.clip.frame_count());
    return {{"input", input.name},
            {"motion", input.motion},
            {"frames", frames},
            {"seed", o.input.seed},
            {"checksum", checksum_of(inputs)},
            {"method", name_of(o.methods)},
            {"precision", name_of(o.precision)},
            {"passes", o.passes},
            {"kdop", o.kdop},
            {"rest", o.rest_shape == RestShape::obb ? "obb" : "aabb"},
            {"leaf", o.leaf},
            {"volume", o.volume},
            {"sabotage", static_cast<int>(o.sabotage)},
            {"certificate", o.certificate},
            {"transforms", o.certificate.empty() ? "" : exact::hash_of_transforms(inputs.bodies[0].clip)},
            {"vertices", input.vertices},
            {"triangles", input.triangles},
            {"nodes", input.nodes},
            {"bodies", input.bodies},
            {"report", input.report},
            {"missing", input.missing},
            {"fields", input.fields}};
}

VerifiedInput input_of_plan(const Json& plan)
{
    return {plan.at("input"),    plan.at("motion"),    plan.at("report"), plan.at("missing"), plan.at("bodies"),
            plan.at("vertices"), plan.at("triangles"), plan.at("nodes"),  plan.at("fields")};
}

VerifyOptions options_of_plan(const Json& plan)
{
    VerifyOptions o;
    o.methods = named_methods(plan.at("method").get<std::string>()).value_or(Method::best);
    o.precision = plan.at("precision") == name_of(Precision::float64) ? Precision::float64 : Precision::float32;
    o.passes = plan.at("passes");
    o.kdop = plan.at("kdop");
    o.rest_shape = plan.at("rest") == "obb" ? RestShape::obb : RestShape::aabb;
    o.leaf = plan.at("leaf");
    o.volume = plan.at("volume");
    o.input.seed = plan.at("seed");
    return o;
}

Json frame_row(std::size_t body, std::size_t frame, const VerifyTotals& t)
{
    Json levels = Json::array(), volumes = Json::array(), root = Json::array(), examples = Json::array();
    for (const LevelTotals& l : t.levels)
        levels.push_back({{"bvs", l.bvs},
                          {"nodes", l.nodes},
                          {"proven", l.proven},
                          {"violated", l.violated},
                          {"measured", l.measured},
                          {"ratio_sum", l.ratio_sum},
                          {"ratio_max", l.ratio_max},
                          {"loss", to_json(l.loss)}});
    for (const VolumeTotals& v : t.volumes)
        volumes.push_back({v.measured, v.flat, v.ratio_sum, v.ratio_max, v.redundant});
    for (const auto& r : t.root)
        root.push_back({{"direction", r.direction},
                        {"bound", r.bound},
                        {"loss", {r.loss.box, r.loss.interval, r.loss.corner, r.loss.rounding, r.loss.total}}});
    for (const auto& e : t.examples)
        examples.push_back({{"level", e.level},
                            {"bv", e.violation.bv},
                            {"direction", e.violation.direction},
                            {"statement", static_cast<int>(e.violation.statement)},
                            {"detail", e.violation.detail}});
    return {{"body", body},
            {"frame", frame},
            {"levels", levels},
            {"volumes", volumes},
            {"root", root},
            {"examples", examples},
            {"ladder", {t.ladder.compared, t.ladder.broken, t.ladder.defaults, t.ladder.above, t.ladder.clearly}},
            {"infinite", t.infinite},
            {"unbounded_nodes", t.unbounded_nodes},
            {"decided_by_filter", t.decided_by_filter},
            {"packed_bytes", t.packed_bytes},
            {"rest_bytes", t.rest_bytes},
            {"seconds", t.seconds}};
}

void add_row(const Json& row, VerifyTotals& totals)
{
    const bool is_first = row.at("frame") == 0; // of its body
    const Json& levels = row.at("levels");
    totals.levels.resize(std::max(totals.levels.size(), levels.size()));
    for (std::size_t i = 0; i < levels.size(); ++i) {
        LevelTotals& level = totals.levels[i];
        const Json& more = levels[i];
        if (is_first) {
            level.bvs += more.at("bvs").get<std::size_t>();
            level.nodes += more.at("nodes").get<double>();
        }
        level.proven += more.at("proven").get<std::size_t>();
        level.violated += more.at("violated").get<std::size_t>();
        level.measured += more.at("measured").get<std::size_t>();
        level.ratio_sum += more.at("ratio_sum").get<double>();
        level.ratio_max = std::max(level.ratio_max, more.at("ratio_max").get<double>());
        add(loss_of(more.at("loss")), level.loss);
    }
    const Json& volumes = row.at("volumes");
    totals.volumes.resize(std::max(totals.volumes.size(), volumes.size()));
    for (std::size_t i = 0; i < volumes.size(); ++i) {
        VolumeTotals& v = totals.volumes[i];
        v.measured += volumes[i][0].get<std::size_t>();
        v.flat += volumes[i][1].get<std::size_t>();
        v.ratio_sum += volumes[i][2].get<double>();
        v.ratio_max = std::max(v.ratio_max, volumes[i][3].get<double>());
        v.redundant += volumes[i][4].get<std::size_t>();
    }
    for (const Json& r : row.at("root")) {
        const Json& loss = r.at("loss");
        totals.root.push_back({r.at("direction"), r.at("bound"), {loss[0], loss[1], loss[2], loss[3], loss[4]}});
    }
    for (const Json& e : row.at("examples"))
        if (totals.examples.size() < 10)
            totals.examples.push_back({totals.frames,
                                       e.at("level"),
                                       {e.at("bv"), e.at("direction"),
                                        static_cast<exact::Statement>(e.at("statement").get<int>()), e.at("detail")}});
    const Json& ladder = row.at("ladder");
    totals.ladder.compared += ladder[0].get<std::size_t>();
    totals.ladder.broken += ladder[1].get<std::size_t>();
    totals.ladder.defaults += ladder[2].get<std::size_t>();
    totals.ladder.above += ladder[3].get<std::size_t>();
    totals.ladder.clearly += ladder[4].get<std::size_t>();
    totals.infinite += row.at("infinite").get<std::size_t>();
    totals.unbounded_nodes += row.at("unbounded_nodes").get<std::size_t>();
    totals.decided_by_filter += row.at("decided_by_filter").get<std::size_t>();
    if (is_first) {
        totals.packed_bytes += row.at("packed_bytes").get<std::size_t>();
        totals.rest_bytes += row.at("rest_bytes").get<std::size_t>();
    }
    totals.seconds += row.at("seconds").get<double>();
    ++totals.frames;
}

// The end of a certificate whose frames are all there.
void end_certificate(const Merged& all, const std::string& folder)
{
    const Json& plan = all.campaign.plan;
    exact::BoundCounts counts;
    for (const Rows& cell : all.cells)
        for (const Json& row : cell) {
            counts.proven += row.at("certificate")[0].get<std::size_t>();
            counts.infinite += row.at("certificate")[1].get<std::size_t>();
            counts.violated += row.at("certificate")[2].get<std::size_t>();
        }
    CertificateParts(std::filesystem::path(folder) / plan.at("certificate").get<std::string>())
        .write_end(all.cells.size(), counts, plan.at("transforms"));
}

int print_verify(const Merged& all, const OutputOptions& output_options, const std::string& folder)
{
    const Json& plan = all.campaign.plan;
    const VerifiedInput input = input_of_plan(plan);
    VerifyOptions options = options_of_plan(plan);
    options.output = output_options;
    Provenance from = provenance_of(all.campaign);
    from.seed = options.input.seed;
    RecordOutput output(output_options, from);
    output.describe(input.fields);
    const VerifyTotals totals = totals_of(all);
    output.set(completeness_of(totals));
    output.add_all(records_of(input, options, totals));
    output.finish();
    if (!output_options.records_only())
        print_table(input, options, totals, from);
    if (completeness_of(totals).complete && !plan.at("certificate").get<std::string>().empty())
        end_certificate(all, folder);
    return verdict_of(totals);
}

} // namespace cinch
