// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/audit/crowd.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <memory>

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include "cinch/environment.hpp"
#include "cinch/refit.hpp"
#include "experiments/input.hpp"
#include "experiments/measure/race.hpp"
#include "experiments/report/interrupt.hpp"
#include "experiments/report/number.hpp"
#include "experiments/report/table.hpp"

namespace cinch {
namespace {

using Json = nlohmann::ordered_json;

// What bounds a crowd.
struct Contestant {
    std::string name;
    std::size_t boxes = 0, bytes = 0;
    std::function<void(std::span<Aabb>)> bound;
    Range ns = Range(std::nan("")), over_engine = Range(std::nan("")); // per body
    double area = 0;                                                   // of a body's boxes, mean over bodies
    bool holds = true; // every vertex as computed is inside, where that is claimed
};

struct Crowd {
    Input input;
    std::vector<AffineMap> maps; // of all bodies
    std::size_t nodes() const { return input.surface.weights.node_count; }
    std::size_t bodies() const { return maps.size() / nodes(); }
};

// Santas of so many simulation nodes, each in a frame of its own of a strong motion.
Crowd crowd_of(std::size_t nodes, const CrowdAuditOptions& options)
{
    InputOptions what;
    what.input = "santa";
    what.nodes = nodes;
    what.frames = 100;
    what.seed = options.seed;
    Crowd crowd{load_input(what), {}};
    const std::size_t frames = crowd.input.clip.frame_count();
    std::vector<Clip::Frame> poses;
    for (std::size_t f = 0; f < frames; ++f)
        poses.push_back(crowd.input.clip.frame(f));
    for (std::size_t i = 0; i < options.bodies; ++i) {
        const Clip::Frame& pose = poses[i * 37 % frames];
        crowd.maps.insert(crowd.maps.end(), pose.begin(), pose.end());
    }
    return crowd;
}

constexpr int level_of_64 = 6;

// A tree of 64 leaves.
Bvh tree_of_64(const DeformableSurface& surface)
{
    return build_bvh(surface, (surface.mesh.triangles.size() + 63) / 64);
}

double area_of(const Aabb& box)
{
    const Vec3 size = box.upper - box.lower;
    return 2 * (size[0] * size[1] + size[1] * size[2] + size[2] * size[0]);
}

// Our tightest, body after body: a Refitter's root, or its BVs of a level.
std::function<void(std::span<Aabb>)> by_refitter(const Crowd& crowd, const Bvh& bvh, std::size_t first,
                                                 std::size_t last)
{
    const auto refit = std::make_shared<Refitter>(bvh, crowd.input.surface, RefitOptions());
    const auto supports = std::make_shared<std::vector<double>>(6 * bvh.bvs.size());
    return [&crowd, refit, supports, first, last](std::span<Aabb> out) {
        for (std::size_t i = 0; i < crowd.bodies(); ++i) {
            (*refit)(std::span(crowd.maps).subspan(i * crowd.nodes(), crowd.nodes()), *supports);
            for (std::size_t b = first; b < last; ++b) {
                const double* s = &(*supports)[6 * b];
                out[i * (last - first) + b - first] = {{-s[1], -s[3], -s[5]}, {s[0], s[2], s[4]}};
            }
        }
    };
}

// Whether the boxes of a body hold its vertices as computed.
bool holds(const Crowd& crowd, std::span<const Aabb> boxes, std::size_t body)
{
    std::vector<Vec3> places(crowd.input.surface.mesh.vertices.size());
    evaluate(crowd.input.surface.mesh.vertices, crowd.input.surface.weights,
             std::span(crowd.maps).subspan(body * crowd.nodes(), crowd.nodes()), places);
    return std::all_of(places.begin(), places.end(), [&](const Vec3& x) {
        return std::any_of(boxes.begin(), boxes.end(), [&](const Aabb& box) { return box.contains(x); });
    });
}

// How much faster 64 boxes each are on all threads than on one, by the clock on the wall; the least of ten.
double gain_of_threads(const Crowd& crowd)
{
    const Bvh bvh = tree_of_64(crowd.input.surface);
    const CrowdRefitter refit(bvh, crowd.input.surface, {level_of_64, Rounding::proven});
    std::vector<Aabb> out(crowd.bodies() * refit.bvs().size());
    auto once = [&] {
        const auto start = std::chrono::steady_clock::now();
        refit(crowd.maps, out);
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    double one = HUGE_VAL, all = HUGE_VAL;
    for (int round = 0; round < 10; ++round) {
        all = std::min(all, once());
        const tbb::global_control single(tbb::global_control::max_allowed_parallelism, 1);
        one = std::min(one, once());
    }
    return one / all;
}

std::vector<Contestant> measure(const Crowd& crowd, double seconds)
{
    const Bvh one = build_bvh(crowd.input.surface, crowd.input.surface.mesh.triangles.size()),
              many = tree_of_64(crowd.input.surface);
    std::vector<Contestant> all;
    auto add_crowd = [&](std::string name, const Bvh& bvh, const CrowdOptions& options) {
        const auto refit = std::make_shared<CrowdRefitter>(bvh, crowd.input.surface, options);
        all.push_back({std::move(name), refit->bvs().size(), refit->bytes(),
                       [&crowd, refit](std::span<Aabb> out) { (*refit)(crowd.maps, out); }});
    };
    add_crowd("joint boxes, as engines", one, {0, Rounding::plain});
    add_crowd("cinch crowd", one, {0, Rounding::proven});
    all.push_back({"cinch best", 1, Refitter(one, crowd.input.surface, {}).bytes(), by_refitter(crowd, one, 0, 1)});
    add_crowd("cinch crowd", many, {level_of_64, Rounding::proven});
    const std::size_t first = many.level[level_of_64], last = many.level[level_of_64 + 1];
    all.push_back({"cinch best, and 63 BVs above", last - first, Refitter(many, crowd.input.surface, {}).bytes(),
                   by_refitter(crowd, many, first, last)});

    std::vector<std::vector<Aabb>> out;
    for (const Contestant& c : all)
        out.emplace_back(crowd.bodies() * c.boxes);
    std::vector<std::function<void()>> calls;
    for (std::size_t i = 0; i < all.size(); ++i)
        calls.emplace_back([&, i] { all[i].bound(out[i]); });
    for (std::size_t i = 0; i < all.size(); ++i) {
        calls[i]();
        for (const Aabb& box : out[i])
            all[i].area += area_of(box) / static_cast<double>(crowd.bodies());
        for (std::size_t body = 0; i > 0 && body < crowd.bodies();
             body += std::max<std::size_t>(1, crowd.bodies() / 50))
            all[i].holds =
                all[i].holds && holds(crowd, std::span(out[i]).subspan(body * all[i].boxes, all[i].boxes), body);
    }
    {
        const tbb::global_control single(tbb::global_control::max_allowed_parallelism, 1);
        const RaceTimes times = race(calls, seconds);
        const auto bodies = Range(static_cast<double>(crowd.bodies()));
        for (std::size_t i = 0; i < all.size(); ++i) {
            all[i].ns = times.of(i) / bodies;
            all[i].over_engine = times.ratio(i, 0);
        }
    }
    return all;
}

} // namespace

int audit_crowd(const CrowdAuditOptions& options)
{
    require_default_arithmetic();
    const Provenance from = provenance(1, options.seed);
    RecordOutput output(options.output, from);
    catch_interrupt();
    std::vector<Crowd> crowds;
    std::vector<double> gains;
    for (const std::size_t nodes : {std::size_t{22}, std::size_t{70}}) {
        crowds.push_back(crowd_of(nodes, options));
        gains.push_back(gain_of_threads(crowds.back())); // before this thread has one core
    }
    pin_to_one_core();
    std::vector<Figure> figures;
    for (std::size_t i = 0; i < crowds.size(); ++i) {
        const Crowd& crowd = crowds[i];
        const std::size_t nodes = crowd.nodes();
        const std::vector<Contestant> all = measure(crowd, options.seconds);
        std::vector<std::vector<std::string>> lines;
        for (const Contestant& c : all) {
            lines.push_back({c.name, std::to_string(c.boxes), fmt::format("{:.0f}{}", c.ns.value, mark(c.ns)),
                             fmt::format("{:.2f}{}", c.over_engine.value, mark(c.over_engine)),
                             fmt::format("{:.3f}", c.area / all[0].area), fmt::format("{:.1f}", 1e3 / c.ns.value),
                             grouped(c.bytes)});
            output.add({{"experiment", "audit"},
                        {"input", "santa"},
                        {"crowd", crowd.bodies()},
                        {"n", nodes},
                        {"formula", c.name},
                        {"boxes", c.boxes},
                        {"ns_per_body", c.ns.value},
                        {"ns_per_body_low", c.ns.low},
                        {"ns_per_body_high", c.ns.high},
                        {"over_engine", c.over_engine.value},
                        {"over_engine_low", c.over_engine.low},
                        {"over_engine_high", c.over_engine.high},
                        {"area_ratio", c.area / all[0].area},
                        {"violated", !c.holds},
                        {"rest_bytes", c.bytes}});
        }
        if (!options.output.records_only())
            fmt::print("{} bodies of {} simulation nodes; 64 boxes on {}: {:.2f} times as fast as on one\n\n{}\n",
                       grouped(crowd.bodies()), nodes,
                       counted(static_cast<std::size_t>(tbb::info::default_concurrency()), "thread", "threads"),
                       gains[i], table({"bounds", "boxes", "ns", "/ engine", "area", "M/s", "bytes"}, lines));
        output.add({{"experiment", "audit"},
                    {"input", "santa"},
                    {"crowd", crowd.bodies()},
                    {"n", nodes},
                    {"formula", "cinch crowd"},
                    {"boxes", all[3].boxes},
                    {"threads_gain", gains[i]}});
        const std::string of = fmt::format("{} nodes: ", nodes);
        figures.emplace_back(of + "proven root box / the formula of engines, time",
                             fmt::format("{:.2f}{}", all[1].over_engine.value, mark(all[1].over_engine)), "<= 1",
                             at_most(all[1].over_engine, 1));
        figures.emplace_back(of + "proven root box / the formula of engines, area",
                             fmt::format("{:.7f}", all[1].area / all[0].area), "<= 1.00001",
                             all[1].area <= 1.00001 * all[0].area);
        const double times_as_tight = all[0].area / all[3].area;
        figures.emplace_back(of + "64 boxes: area of one box of engines / their summed area",
                             fmt::format("{:.2f}", times_as_tight), ">= 3", times_as_tight >= 3);
        figures.emplace_back(of + "64 boxes / one box of engines, time",
                             fmt::format("{:.1f}{}", all[3].over_engine.value, mark(all[3].over_engine)), "<= 20",
                             at_most(all[3].over_engine, 20));
        figures.emplace_back(
            of + "boxes of ours that a computed vertex leaves",
            std::all_of(all.begin() + 1, all.end(), [](const Contestant& c) { return c.holds; }) ? "0" : "some", "0",
            std::all_of(all.begin() + 1, all.end(), [](const Contestant& c) { return c.holds; }));
    }
    for (const Figure& figure : figures)
        output.add(record_of(figure, "audit"));
    output.finish();
    if (!options.output.records_only()) {
        fmt::print("ns: per body, on one core, in turn; M/s: millions of bodies a second. area: of\n"
                   "all boxes of a body, over that of the engines' one. bytes: of rest data, which\n"
                   "all bodies share.\n\n");
        print(figures);
        fmt::print("\n{}\n", describe(from));
    }
    return 0;
}

} // namespace cinch
