// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/study/measure_cell.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "cinch/refit.hpp"
#include "experiments/report/or_leave.hpp"
#include "toolkit/hierarchy/box_radius.hpp"

namespace cinch {
namespace {

using Json = nlohmann::ordered_json;

struct Ratios {
    std::size_t count = 0;
    double sum = 0, most = 0;

    void take(double ratio)
    {
        if (!std::isfinite(ratio))
            return;
        ++count;
        sum += ratio;
        most = std::max(most, ratio);
    }
    Json mean() const { return count ? Json(sum / static_cast<double>(count)) : Json(); }
    Json greatest() const { return count ? Json(most) : Json(); }
};

double width(std::span<const double> supports)
{
    double sum = 0;
    for (const double s : supports)
        sum += s;
    return sum;
}

// What is deformed, and its true bounds; owned, as a call that is left behind goes on.
struct PreparedCell {
    PreparedCell(const InputOptions& what, std::size_t leaf)
        : input(load_input(what)), bvh(build_bvh(input.surface, leaf))
    {
    }
    Input input;
    Bvh bvh;
};

struct Contestant {
    Methods methods;
    Precision precision;
    std::size_t kdop;
    std::unique_ptr<Refitter> refit;
    Ratios root, all, width;
    std::vector<Ratios> levels;
    Rows frames, bvs;
};

Json key(const InputOptions& what, const Input& input, const Contestant& c)
{
    return {{"experiment", "study"},
            {"input", what.input},
            {"motion", input.clip.name},
            {"n", input.surface.weights.node_count},
            {"seed", what.seed},
            {"method", name_of(c.methods)},
            {"precision", name_of(c.precision)},
            {"kdop", c.kdop},
            {"frames", input.clip.frame_count()},
            {"frames_done", input.clip.frame_count()}};
}

// One frame of one contestant.
void take_frame(const Plan& plan, const InputOptions& what, const PreparedCell& scene, std::size_t frame,
                std::span<const double> truth, std::span<const double> supports, Contestant& c)
{
    const std::size_t k = c.kdop;
    Ratios here;
    const Json own = key(what, scene.input, c);
    for (std::size_t level = 0; level + 1 < scene.bvh.level.size(); ++level)
        for (std::size_t bv = scene.bvh.level[level]; bv < scene.bvh.level[level + 1]; ++bv) {
            const auto real = truth.subspan(bv * k, k), bound = supports.subspan(bv * k, k);
            const double radius = box_radius(real), ratio = box_radius(bound) / radius;
            if (!(radius > 0))
                continue; // a point: there is no ratio
            here.take(ratio);
            c.all.take(ratio);
            c.levels[level].take(ratio);
            c.width.take(width(bound) / width(real));
            if (bv == 0)
                c.root.take(ratio);
            if (plan.detail == Detail::bvs && std::isfinite(ratio)) {
                Json row = own;
                row.update({{"frame", frame}, {"level", level}, {"bv", bv}, {"ratio", ratio}});
                c.bvs.push_back(std::move(row));
            }
        }
    if (plan.detail == Detail::frames) {
        Json row = own;
        row.update({{"frame", frame},
                    {"time_s", scene.input.clip.time_s(frame)},
                    {"root_ratio", box_radius(supports.first(k)) / box_radius(truth.first(k))},
                    {"mean_ratio", here.mean()},
                    {"max_ratio", here.greatest()}});
        c.frames.push_back(std::move(row));
    }
}

void put_rows(const InputOptions& what, const PreparedCell& scene, Detail detail, Contestant& c, Rows& out)
{
    const Json own = key(what, scene.input, c);
    Json row = own;
    row.update({{"bvs", scene.bvh.bvs.size()},
                {"vertices", scene.input.surface.mesh.vertices.size()},
                {"root_ratio", c.root.mean()},
                {"root_max_ratio", c.root.greatest()},
                {"mean_ratio", c.all.mean()},
                {"max_ratio", c.all.greatest()},
                {"width_ratio", c.width.mean()}});
    out.push_back(std::move(row));
    for (std::size_t level = 0; detail == Detail::levels && level < c.levels.size(); ++level) {
        row = own;
        row.update({{"level", level},
                    {"bvs", scene.bvh.level[level + 1] - scene.bvh.level[level]},
                    {"mean_ratio", c.levels[level].mean()},
                    {"max_ratio", c.levels[level].greatest()}});
        out.push_back(std::move(row));
    }
    std::move(c.frames.begin(), c.frames.end(), std::back_inserter(out));
    std::move(c.bvs.begin(), c.bvs.end(), std::back_inserter(out));
}

} // namespace

Rows measure_cell(const Plan& plan, const InputOptions& what)
{
    const auto scene = or_leave([what, leaf = plan.leaf] { return std::make_shared<const PreparedCell>(what, leaf); });
    const Input& input = scene->input;
    std::vector<Contestant> contestants;
    for (const Methods methods : plan.methods)
        for (const Precision precision : plan.precisions)
            for (const int kdop : plan.kdops) {
                Contestant c{methods, precision, static_cast<std::size_t>(kdop), nullptr, {}, {}, {}, {}, {}, {}};
                c.refit = or_leave([=, passes = static_cast<int>(plan.passes)] {
                    return std::make_unique<Refitter>(
                        scene->bvh, scene->input.surface,
                        RefitOptions{.methods = methods, .kdop = kdop, .precision = precision, .passes = passes});
                });
                c.levels.resize(scene->bvh.level.empty() ? 0 : scene->bvh.level.size() - 1);
                contestants.push_back(std::move(c));
            }
    std::vector<double> truth, supports;
    for (const int kdop : plan.kdops) {
        const auto k = static_cast<std::size_t>(kdop);
        Refitter vertices(scene->bvh, input.surface,
                          {.methods = Method::vertices, .kdop = kdop, .rounding = Rounding::plain});
        truth.resize(scene->bvh.bvs.size() * k);
        supports.resize(truth.size());
        for (std::size_t frame = 0; frame < input.clip.frame_count() && !scene->bvh.bvs.empty(); ++frame) {
            const Clip::Frame maps = input.clip.frame(frame);
            vertices(maps, truth);
            for (Contestant& c : contestants) {
                throw_if_interrupted();
                if (c.kdop != k)
                    continue;
                (*c.refit)(maps, supports);
                take_frame(plan, what, *scene, frame, truth, supports, c);
            }
        }
    }
    Rows rows;
    for (Contestant& c : contestants)
        put_rows(what, *scene, plan.detail, c, rows);
    return rows;
}

} // namespace cinch
