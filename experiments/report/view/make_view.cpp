// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>

#include <fmt/format.h>

#include "cinch/bounds.hpp"
#include "cinch/deform.hpp"
#include "cinch/refit.hpp"
#include "cinch/surface.hpp"
#include "experiments/bake/swept.hpp"
#include "experiments/baselines/engines/engine_character.hpp"
#include "experiments/input.hpp"
#include "experiments/report/interrupt.hpp"
#include "experiments/report/or_leave.hpp"
#include "experiments/report/progress.hpp"
#include "experiments/report/view.hpp"
#include "experiments/report/view/contacts.hpp"
#include "experiments/report/view/grid.hpp"
#include "experiments/report/view/pack.hpp"
#include "experiments/simulation/find_scene.hpp"
#include "toolkit/deform/parallel.hpp"
#include "toolkit/hierarchy/bounder.hpp"

namespace cinch {
namespace {

using Json = nlohmann::ordered_json;

const std::string all_times = "all times"; // beside the names of methods

// Positions of all drawn vertices of all bodies, frame after frame; refuses those that are not finite.
std::vector<std::vector<Vec3>> evaluate(const std::vector<DrawnBody>& bodies, std::size_t frames,
                                        const std::string& scene)
{
    std::vector<std::vector<Vec3>> all(frames);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        const DrawnBody& body = bodies[b];
        const SurfaceEvaluator<double> evaluator(body.input.surface);
        std::vector<Vec3> positions(body.input.surface.mesh.vertices.size());
        for (std::size_t f = 0; f < frames; ++f) {
            throw_if_interrupted();
            if (const std::vector<double> weights = body.input.clip.weights(f); weights.empty()) {
                evaluator(body.input.clip.frame(f), positions);
            } else {
                positions = body.input.surface.mesh.vertices;
                displace(body.input.targets, weights, positions);
                cinch::evaluate(positions, body.input.surface.weights, body.input.clip.frame(f), positions);
            }
            for (const std::uint32_t v : body.vertex) {
                if (!positions[v].allFinite())
                    throw InputError::in_file(scene,
                                              fmt::format("{}: vertex {} is not finite in frame {}; it cannot be drawn",
                                                          body.input.name, v, f));
                all[f].push_back(positions[v]);
            }
        }
    }
    return all;
}

Grid grid_of(const std::vector<std::vector<Vec3>>& frames, int bits)
{
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (const auto& frame : frames)
        for (const Vec3& v : frame) {
            low = low.cwiseMin(v);
            high = high.cwiseMax(v);
        }
    return Grid::make(low, high, bits);
}

// The corners of all triangles of all bodies.
std::vector<std::uint32_t> corners_of(const std::vector<DrawnBody>& bodies)
{
    std::vector<std::uint32_t> out;
    std::uint32_t first = 0;
    for (const DrawnBody& body : bodies) {
        for (const std::uint32_t v : body.corner)
            out.push_back(first + v);
        first += static_cast<std::uint32_t>(body.vertex.size());
    }
    return out;
}

// As how far each lies below the next vertex not used yet: mostly 0 and little more.
Json pack_corners(const std::vector<std::uint32_t>& corners)
{
    std::vector<std::int32_t> out;
    std::uint32_t next = 0;
    for (const std::uint32_t v : corners) {
        out.push_back(static_cast<std::int32_t>(next - v));
        next = std::max(next, v + 1);
    }
    return pack(out, out.size(), 1, 1);
}

Json pack_positions(const std::vector<std::vector<Vec3>>& frames, const Grid& grid,
                    const std::vector<std::uint32_t>& corners)
{
    std::vector<std::int32_t> out;
    out.reserve(frames.size() * frames[0].size() * 3);
    for (const auto& frame : frames)
        for (const Vec3& v : frame)
            for (const std::int32_t x : grid.point(v))
                out.push_back(x);
    return pack(out, frames.size(), frames[0].size(), 3, parallelograms(corners, frames[0].size()));
}

// Where the maps take the rest positions of the simulation nodes, of the bodies that have some. What is not finite or
// far away is drawn nowhere.
Json pack_nodes(const std::vector<DrawnBody>& bodies, std::size_t frames, const Grid& grid)
{
    std::vector<std::int32_t> out;
    for (std::size_t f = 0; f < frames; ++f)
        for (const DrawnBody& body : bodies) {
            const Clip::Frame maps = body.input.nodes.empty() ? Clip::Frame() : body.input.clip.frame(f);
            for (std::size_t j = 0; j < body.input.nodes.size(); ++j) {
                const AffineMap& map = maps[j];
                const Vec3& x = body.input.nodes[j];
                Vec3 p;
                for (int r = 0; r < 3; ++r)
                    p[r] = map.m[r][0] * x[0] + map.m[r][1] * x[1] + map.m[r][2] * x[2] + map.m[r][3];
                const bool near = ((p / grid.step).array().abs() < 0x1p52).all();
                const auto g = near ? grid.point(p)
                                    : std::array<std::int32_t, 3>{Grid::unbounded, Grid::unbounded, Grid::unbounded};
                out.insert(out.end(), g.begin(), g.end());
            }
        }
    return pack(out, frames, out.size() / 3 / frames, 3);
}

// The BVs of all bodies, level by level: in each, body by body.
struct DrawnBvs {
    std::vector<std::uint32_t> level = {0}, first, count, body; ///< first, count: triangles of all bodies
    std::vector<std::uint32_t> bv;                              ///< in the body's BVH

    DrawnBvs(const std::vector<DrawnBody>& bodies, std::size_t levels)
    {
        for (std::size_t l = 0; l < levels; ++l) {
            std::uint32_t base = 0;
            for (std::uint32_t b = 0; b < bodies.size(); ++b) {
                const Bvh& bvh = bodies[b].bvh;
                for (std::uint32_t i = bodies[b].bvs(l); i < bodies[b].bvs(l + 1); ++i) {
                    first.push_back(base + bvh.bvs[i].first_triangle);
                    count.push_back(bvh.bvs[i].triangle_count);
                    body.push_back(b);
                    bv.push_back(i);
                }
                base += static_cast<std::uint32_t>(bvh.triangle.size());
            }
            if (first.size() == level.back())
                break;
            level.push_back(static_cast<std::uint32_t>(first.size()));
        }
    }
};

// Bounds of the first `frames` frames by one method, on the grid.
std::vector<std::int32_t> bounds_by(Method method, const ViewRequest& request, const std::vector<DrawnBody>& bodies,
                                    const DrawnBvs& bvs, const Grid& grid, std::size_t frames)
{
    const auto k = static_cast<std::size_t>(request.kdop);
    const auto axes = axes_of(request.kdop);
    std::vector<std::int32_t> out(frames * bvs.bv.size() * k);
    RefitOptions options;
    options.methods = method;
    options.kdop = request.kdop;
    for (std::uint32_t b = 0; b < bodies.size(); ++b) {
        throw_if_interrupted();
        const Input& input = bodies[b].input;
        std::optional<Refitter> displaced;
        if (input.clip.displaces())
            displaced.emplace(bodies[b].bvh, input.surface, options, input.targets);
        Bounder bounder(bodies[b].bvh, input.surface, options, Bounder::Leaves::included);
        std::vector<double> supports((displaced ? bodies[b].bvh.bvs.size() : bodies[b].bvs(bvs.level.size() - 1)) * k);
        for (std::size_t f = 0; f < frames; ++f) {
            throw_if_interrupted();
            const Clip::Frame maps = input.clip.frame(f);
            if (displaced) {
                (*displaced)(maps, input.clip.weights(f), supports);
            } else {
                bounder.begin(maps);
                parallel_blocks(supports.size() / k, 1, [&](std::size_t first, std::size_t last) {
                    bounder.bound(first, last, std::span(supports).subspan(first * k, (last - first) * k));
                });
            }
            for (std::size_t i = 0; i < bvs.bv.size(); ++i)
                for (std::size_t d = 0; bvs.body[i] == b && d < k; ++d)
                    out[(f * bvs.bv.size() + i) * k + d] =
                        grid.support(axes[d / 2], d % 2 == 1, supports[bvs.bv[i] * k + d]);
        }
    }
    return out;
}

// The same of intervals of time around the frames.
std::vector<std::int32_t> swept_on_grid(const ViewRequest& request, const std::vector<TimedBody>& timed,
                                        const std::vector<DrawnBody>& bodies, const DrawnBvs& bvs, const Grid& grid,
                                        std::size_t frames)
{
    const auto k = static_cast<std::size_t>(request.kdop);
    const auto axes = axes_of(request.kdop);
    std::vector<std::int32_t> out(frames * bvs.bv.size() * k);
    for (std::uint32_t b = 0; b < bodies.size(); ++b) {
        const std::vector<double> supports = swept_bounds(timed[b], bodies[b].input, bodies[b].bvh, request.kdop);
        for (std::size_t f = 0; f < frames; ++f)
            for (std::size_t i = 0; i < bvs.bv.size(); ++i)
                for (std::size_t d = 0; bvs.body[i] == b && d < k; ++d)
                    out[(f * bvs.bv.size() + i) * k + d] = grid.support(
                        axes[d / 2], d % 2 == 1, supports[(f * bodies[b].bvh.bvs.size() + bvs.bv[i]) * k + d]);
    }
    return out;
}

// Of the roots alone, by a formula of engines.
std::vector<std::int32_t> roots_by_formula(const std::string& name, const ViewRequest& request,
                                           const std::vector<TimedBody>& timed, const std::vector<DrawnBody>& bodies,
                                           const DrawnBvs& bvs, const Grid& grid, std::size_t frames)
{
    const auto k = static_cast<std::size_t>(request.kdop);
    const auto axes = axes_of(request.kdop);
    std::vector<std::int32_t> out(frames * bvs.bv.size() * k, Grid::unbounded);
    for (std::uint32_t b = 0; b < bodies.size(); ++b) {
        const ReadyFormula formula = ready_formula(name, timed[b], timed[b].clips.front());
        for (std::size_t f = 0; f < frames; ++f) {
            throw_if_interrupted();
            const EngineBound bound = formula.at(bodies[b].input.clip.frame(f));
            for (std::size_t i = 0; i < bvs.bv.size(); ++i)
                for (std::size_t d = 0; bvs.body[i] == b && bvs.bv[i] == 0 && d < k; ++d) {
                    double support = 0; // of the box, or of the ball
                    for (std::size_t r = 0; r < 3; ++r)
                        if (const int c = d % 2 ? -axes[d / 2][r] : axes[d / 2][r]; c != 0)
                            support += c > 0 ? c * bound.high[static_cast<int>(r)] : c * bound.low[static_cast<int>(r)];
                    out[(f * bvs.bv.size() + i) * k + d] = grid.support(axes[d / 2], d % 2 == 1, support);
                }
        }
    }
    return out;
}

Json shown_first(const ViewRequest& request, std::size_t frames, std::size_t levels)
{
    return {{"method", request.formula_first ? request.formulas.front()
                       : request.swept       ? all_times
                                             : std::string(name_of(request.method))},
            {"level", std::min(request.level, levels - 1)},
            {"frame", static_cast<std::size_t>(
                          std::llround(std::clamp(request.time, 0.0, 1.0) * static_cast<double>(frames - 1)))},
            {"surface", request.surface},
            {"nodes", request.show_nodes},
            {"bounds", request.show_bounds},
            {"azimuth", request.azimuth},
            {"elevation", request.elevation}};
}

void require_valid(const ViewRequest& request)
{
    if (request.frames < 1 || request.levels < 1 || request.bits < 8 || request.bits > 16 || !is_kdop(request.kdop) ||
        request.methods.empty())
        throw std::invalid_argument("view: frames and levels of at least 1, 8 to 16 bits, k = " + kdop_names() +
                                    ", and a method are needed");
    if (std::find(request.methods.begin(), request.methods.end(), request.method) == request.methods.end())
        throw std::invalid_argument("view: the method shown first is not among the methods");
}

} // namespace

nlohmann::ordered_json make_view(const ViewRequest& request)
{
    require_valid(request);
    InputOptions what;
    what.input = request.scene;
    what.first_frame = request.frames > 1 && is_scene(request.scene);
    what.frames = request.frames - (what.first_frame ? 1 : 0);
    what.nodes = request.nodes;
    what.seed = request.seed;
    what.partial = request.partial;
    what.weights = request.weights;
    what.transforms = request.transforms;
    what.clip = request.clip;
    what.morph_frames = true;
    std::vector<TimedBody> timed;
    const Inputs inputs = request.swept || !request.formulas.empty() ? with_all_times(what, request.frames, timed)
                                                                     : or_leave([what] { return load_inputs(what); });
    const std::vector<Method>& methods = request.methods;

    std::vector<DrawnBody> bodies;
    bodies.reserve(inputs.bodies.size());
    for (const Input& body : inputs.bodies) {
        throw_if_interrupted();
        bodies.emplace_back(body);
    }
    const std::size_t frames = inputs.bodies[0].clip.frame_count();
    std::vector<double> times;
    for (std::size_t f = 0; f < frames; ++f)
        times.push_back(inputs.bodies[0].clip.time_s(f));
    const DrawnBvs bvs(bodies, request.levels);
    Json view{{"title", request.title.empty() ? inputs.name : request.title},
              {"text", request.text},
              {"scene", request.scene}};
    view["up"] = is_character_file(request.scene) ? "y" : "z"; // as the glTF specification has it
    view["missing"] = inputs.missing();
    view["methods"] = methods.size() + request.formulas.size() + (request.swept ? 1 : 0);
    view["first"] = shown_first(request, frames, bvs.level.size() - 1);
    view["time_s"] = times;
    view["bodies"] = Json::array();
    for (const DrawnBody& body : bodies)
        view["bodies"].push_back({{"name", body.input.name},
                                  {"vertices", body.vertex.size()},
                                  {"triangles", body.bvh.triangle.size()},
                                  {"nodes", body.input.surface.weights.node_count},
                                  {"drawn_nodes", body.input.nodes.size()}});
    view["kdop"] = request.kdop;
    const auto all = axes_of(request.kdop);
    for (const int k : kdops) { // those that the bounds have all axes of
        const auto axes = axes_of(k);
        if (std::all_of(axes.begin(), axes.end(),
                        [&](const Axis& axis) { return std::find(all.begin(), all.end(), axis) != all.end(); }))
            view["axes"][std::to_string(k)] = std::vector(axes.begin(), axes.end());
    }
    view["bvs"] = {{"level", bvs.level}, {"first", bvs.first}, {"count", bvs.count}};
    {
        const auto positions = evaluate(bodies, frames, request.scene);
        const Grid grid = grid_of(positions, request.bits);
        view["step"] = grid.step;
        view["origin"] = grid.origin;
        const std::vector<std::uint32_t> corners = corners_of(bodies);
        view["corners"] = pack_corners(corners);
        view["positions"] = pack_positions(positions, grid, corners);
        view["nodes"] = pack_nodes(bodies, frames, grid);
        view["bounds"] = Json::object();
        if (request.swept)
            view["bounds"][all_times] = pack(swept_on_grid(request, timed, bodies, bvs, grid, frames), frames,
                                             bvs.bv.size(), static_cast<std::size_t>(request.kdop));
        for (const std::string& formula : request.formulas)
            view["bounds"][formula] = pack(roots_by_formula(formula, request, timed, bodies, bvs, grid, frames), frames,
                                           bvs.bv.size(), static_cast<std::size_t>(request.kdop));
        Progress progress(fmt::format("{}: bounds for the view", request.scene), methods.size());
        std::size_t done = 0;
        for (const Method method : methods) {
            try {
                view["bounds"][std::string(name_of(method))] =
                    pack(bounds_by(method, request, bodies, bvs, grid, frames), frames, bvs.bv.size(),
                         static_cast<std::size_t>(request.kdop));
            } catch (const Interrupted&) {
                if (done == 0)
                    throw;
                break;
            }
            progress.done(++done);
        }
    }
    Contacts found;
    try {
        found = contacts(bodies, frames);
    } catch (const Interrupted&) { // the view is whole but for these, and says nothing of them
    }
    if (!found.pairs_in_frame.empty())
        view["contacts"] = {{"pairs", found.pairs_in_frame},
                            {"count", found.triangles_in_frame},
                            {"triangles", pack(found.triangle, 1, found.triangle.size(), 1)}};
    return view;
}

} // namespace cinch
