// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/collide/collide_tables.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "experiments/report/collide_figures.hpp"
#include "experiments/report/number.hpp"
#include "experiments/report/paper_figures.hpp"
#include "experiments/report/record_output.hpp"
#include "experiments/report/table.hpp"

namespace cinch {
namespace {

using Lines = std::vector<std::vector<std::string>>;

std::string ms(double x)
{
    return x < 10 ? fmt::format("{:.3f}", x) : x < 100 ? fmt::format("{:.1f}", x) : fmt::format("{:.0f}", x);
}
std::string ms(const Traced& x) { return x.known() ? ms(x.value) : "-"; }
std::string times(double x) { return x < 10 ? fmt::format("{:.2f}", x) : fmt::format("{:.0f}", x); }

// "60", or "12 of 60" after an interrupt.
std::string frames_of(const Measured& m)
{
    return m.frames == m.frames_wanted ? grouped(m.frames)
                                       : fmt::format("{} of {}", grouped(m.frames), grouped(m.frames_wanted));
}

void print_scenes(const std::vector<SceneResult>& results)
{
    Lines rows;
    for (const SceneResult& r : results)
        rows.push_back({r.scene, grouped(r.bodies), grouped(r.vertices), grouped(r.nodes),
                        fmt::format("{:.0f}", r.backends[0].pairs),
                        fmt::format("{:.0f}", *std::max_element(r.backends[0].pairs_of_frame.begin(),
                                                                r.backends[0].pairs_of_frame.end())),
                        frames_of(r.backends[0])});
    fmt::print("Scenes (Table 2); pairs: intersecting triangles per frame\n\n{}\n",
               table({"scene", "bodies", "vertices", "nodes", "pairs: median", "most", "frames"}, rows));
}

void print_table_3(const std::vector<SceneResult>& scenes, const Results& records, bool cold)
{
    Lines rows;
    for (const SceneResult& r : scenes) {
        const CollideTimes full = collide_times(records, r.scene, "refit-1", cold),
                           hash = collide_times(records, r.scene, "hash", cold);
        if (!full.known() && !hash.known())
            continue;
        const int ring = ring_of(r.scene);
        auto paper = [&](const char* column) {
            return fmt::format("{:.0f}", paper_figure("Table 3", row_of_table_3(ring), column).value);
        };
        const double fishes =
            paper_figure("Fig. 7", "fishes", "full refit").value + paper_figure("Fig. 7", "fishes", "full query").value;
        rows.push_back({r.scene, ms(full.refit), ms(full.query), ms(full.total), ms(hash.refit), ms(hash.query),
                        ms(hash.total),
                        ring                  ? paper("total")
                        : r.scene == "fishes" ? fmt::format("{:.0f}", fishes)
                                              : "-",
                        ring ? paper("hash total") : "-"});
    }
    if (rows.empty())
        return;
    fmt::print("Full bottom-up AABBs (refit-1) and spatial hashing, ms (Table 3); refit and load\nwith the vertices' "
               "evaluation\n\n{}\n",
               table({"scene", "refit", "query", "total", "load", "query", "total", "paper", "paper"}, rows));
}

void print_table_4(const std::vector<SceneResult>& scenes, const Results& records, bool cold)
{
    Lines rows;
    for (const SceneResult& r : scenes) {
        const CollideTimes aabb = collide_times(records, r.scene, "eq12-aabb", cold),
                           obb = collide_times(records, r.scene, "eq12-obb-14", cold);
        if (!aabb.known() && !obb.known())
            continue;
        std::vector<std::string> row{r.scene};
        const int ring = ring_of(r.scene);
        for (const CollideTimes* t : {&aabb, &obb}) {
            const double gain =
                ring ? paper_figure("Table 4", std::to_string(ring), t == &aabb ? "gain" : "OBB gain").value
                : r.scene == "fishes" && t == &aabb ? paper_figure("Fig. 7", "fishes", "gain").value
                                                    : 0;
            for (const Traced& x : {t->refit, t->query, t->total})
                row.push_back(ms(x));
            row.push_back(t->gain.known() ? times(t->gain.value) : "-");
            row.push_back(gain > 0 ? times(gain) : "-");
        }
        rows.push_back(row);
    }
    if (rows.empty())
        return;
    fmt::print(
        "The paper's method, Eq. 12 with one triangle per leaf, ms (Table 4): AABB/AABB,\nthen OBB/14-DOP; gain over "
        "refit-1, here and in the paper\n\n{}\n",
        table({"scene", "refit", "query", "total", "gain", "paper", "refit", "query", "total", "gain", "paper"}, rows));
}

void print_backends(const SceneResult& r)
{
    Lines rows;
    for (const Measured& m : r.backends)
        rows.push_back(
            {m.frames == r.backends[0].frames ? m.backend : fmt::format("{} ({} frames)", m.backend, frames_of(m)),
             m.evaluate_ms < 5e-4 ? "-" : ms(m.evaluate_ms), ms(m.update_ms), ms(m.query_ms), ms(m.total_ms),
             times(m.total_ms / r.backends[0].total_ms) + mark(m.total()), fmt::format("{:.0f}", m.pairs),
             m.differing ? grouped(m.differing) : "-", fmt::format("{:.1f}", m.megabytes)});
    fmt::print("{}, ms per frame (medians over {} frames){}\n\n{}\n", r.scene, frames_of(r.backends[0]),
               r.is_complete() ? ""
                               : ", " + interrupted_after(r.backends.size() - !r.backends.back().is_complete(),
                                                          r.backends_wanted, "backends"),
               table({"", "evaluate", "update", "query", "total", "times", "pairs", "differ", "MB/body"}, rows));
}

void print_counts(const std::vector<SceneResult>& results)
{
    Lines rows;
    for (const SceneResult& r : results) {
        const Measured& m = r.backends[0];
        if (!m.counts)
            continue;
        const QueryCounts& c = m.sums;
        auto per_frame = [&](auto x) {
            return fmt::format("{:.0f}", static_cast<double>(x) / static_cast<double>(m.frames));
        };
        const double tests = std::max<double>(1, static_cast<double>(c.triangle_tests));
        rows.push_back({r.scene, per_frame(c.updates.bounds), per_frame(c.updates.leaves),
                        per_frame(c.updates.vertices), per_frame(c.box_tests), per_frame(c.leaf_pairs),
                        per_frame(c.triangle_tests),
                        fmt::format("{:.2f}", 100 * (1 - static_cast<double>(c.in_double + c.in_exact) / tests)),
                        fmt::format("{:.2f}", 100 * static_cast<double>(c.in_double) / tests),
                        fmt::format("{:.3f}", 100 * static_cast<double>(c.in_exact) / tests)});
    }
    if (rows.empty())
        return;
    fmt::print(
        "What '{}' did, means per frame; triangle pairs decided in float, double,\nexactly, %\n\n{}\n",
        results[0].backends[0].backend,
        table({"scene", "bounds", "leaves", "vertices", "boxes", "leaf p.", "triangles", "float", "double", "exact"},
              rows));
}

// Of the frames in order of the default's contacts, the quarter with the most and so on: the worst median ratio to the
// best full refit.
double worst_quarter(const SceneResult& r, const Measured& own, const std::vector<const Measured*>& full)
{
    std::vector<std::size_t> order(own.total_of_frame.size());
    for (std::size_t i = 0; i < order.size(); ++i)
        order[i] = i;
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return r.backends[0].pairs_of_frame[a] < r.backends[0].pairs_of_frame[b];
    });
    double worst = 0;
    for (std::size_t q = 0; q < 4; ++q) {
        std::vector<double> ratios;
        for (std::size_t i = q * order.size() / 4; i < (q + 1) * order.size() / 4; ++i) {
            double best = INFINITY;
            for (const Measured* m : full)
                if (m->total_of_frame.size() == order.size()) // of the same frames
                    best = std::min(best, m->total_of_frame[order[i]]);
            ratios.push_back(own.total_of_frame[order[i]] / best);
        }
        if (ratios.empty())
            continue;
        std::nth_element(ratios.begin(), ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2), ratios.end());
        worst = std::max(worst, ratios[ratios.size() / 2]);
    }
    return worst;
}

// Of the libraries of others that have been through all frames, the fastest.
const Measured* best_peer(const SceneResult& r)
{
    const Measured* best = nullptr;
    for (const char* name : {"embree", "tinybvh", "fcl", "bullet", "cgal"})
        if (const Measured* peer = r.of(name); peer && (!best || peer->total_ms < best->total_ms))
            best = peer;
    return best;
}

} // namespace

const Measured* SceneResult::of(const std::string& backend) const
{
    for (const Measured& m : backends)
        if (m.backend == backend && m.frames == m.frames_wanted)
            return &m;
    return nullptr;
}

bool SceneResult::is_complete() const
{
    return backends.size() == backends_wanted &&
           std::all_of(backends.begin(), backends.end(), [](const Measured& m) { return m.is_complete(); });
}

std::vector<Figure> figures_of(const std::vector<SceneResult>& results, bool cold)
{
    constexpr double over_peer[8] = {5, 3.3, 35, 35, 2.7, 2.7, 8, 8},
                     over_refit[8] = {2.5, 1.7, 17, 17, 1.7, 1.7, 4.5, 4.5};
    std::vector<Figure> figures;
    auto ratio = [&](const std::string& what, const Range& measured, double target) {
        figures.push_back(
            {what, times(measured.value) + mark(measured), fmt::format(">= {}", target), at_least(measured, target)});
    };
    for (const SceneResult& r : results) {
        const Measured *own = r.of("cinch"), *peer = best_peer(r), *refit = r.of("refit-16"),
                       *full = r.of("cinch-full");
        const int n = ring_of(r.scene);
        if (!own)
            continue;
        const double share = cold ? 0.5 : 1;
        if (n && peer)
            ratio(fmt::format("{}: best peer ({}) / cinch", r.scene, peer->backend), peer->total() / own->total(),
                  share * over_peer[n - 1]);
        if (n && refit)
            ratio(r.scene + ": own full refit, 16 / cinch", refit->total() / own->total(), share * over_refit[n - 1]);
        if (refit && full) {
            const double worst = worst_quarter(r, *own, {refit, full});
            figures.push_back({r.scene + ": cinch / full refit, worst 1/4", times(worst), "<= 1.1", worst <= 1.1});
        }
        if (n && r.vertices > 40000)
            figures.push_back(
                {r.scene + ": MB per body", fmt::format("{:.1f}", own->megabytes), "<= 16", own->megabytes <= 16});
    }
    return figures;
}

std::vector<Slope> slopes_of(const std::vector<SceneResult>& results)
{
    std::vector<Slope> slopes;
    auto find = [&](const std::string& scene) -> const SceneResult* {
        for (const SceneResult& r : results)
            if (r.scene == scene && r.of("cinch"))
                return &r;
        return nullptr;
    };
    auto between = [&](const char* what, const std::string& from, const std::string& to, auto size) {
        const SceneResult *a = find(from), *b = find(to);
        if (a && b)
            slopes.push_back({fmt::format("{}, {} to {}", what, from, to),
                              log_slope({static_cast<double>(size(*a)), static_cast<double>(size(*b))},
                                        {a->of("cinch")->total_ms, b->of("cinch")->total_ms})});
    };
    for (const auto& [from, to] : {std::pair("1", "3"), std::pair("2", "4"), std::pair("5", "7"), std::pair("6", "8")})
        between("vertices", std::string("santa-ring-") + from, std::string("santa-ring-") + to,
                [](const SceneResult& r) { return r.vertices; });
    for (const auto& [from, to] : {std::pair("1", "2"), std::pair("3", "4"), std::pair("5", "6"), std::pair("7", "8")})
        between("nodes", std::string("santa-ring-") + from, std::string("santa-ring-") + to,
                [](const SceneResult& r) { return r.nodes; });
    for (const auto& [from, to] : {std::pair("fishes/6", "fishes/12"), std::pair("fishes/12", "fishes")})
        between("bodies", from, to, [](const SceneResult& r) { return r.bodies; });
    for (const SceneResult& r : results)
        if (const Measured* own = r.of("cinch")) {
            std::vector<double> pairs, total;
            for (std::size_t f = 0; f < own->total_of_frame.size(); ++f)
                if (own->pairs_of_frame[f] >= 10) {
                    pairs.push_back(own->pairs_of_frame[f]);
                    total.push_back(own->total_of_frame[f]);
                }
            if (pairs.size() >= 10)
                slopes.push_back({"contacts, " + r.scene, log_slope(pairs, total)});
        }
    return slopes;
}

void print_tables(const std::vector<SceneResult>& results, const Results& records, bool cold)
{
    print_scenes(results);
    print_table_3(results, records, cold);
    print_table_4(results, records, cold);
    for (const SceneResult& r : results)
        print_backends(r);
    fmt::print(
        "times: the total over that of '{}'; differ: pairs that only one of the two\nfound. evaluate: all vertices up "
        "front, by SIMD with the bits of the exact test;\n'-' where they are evaluated on demand. {}\n"
        "On one thread times are those on a core; ~: rounds are over 10 % apart.\n\n",
        results[0].backends[0].backend,
        cold ? "Caches evicted before every frame." : "Every backend runs through all frames in turn.");
    print_counts(results);
    if (const auto figures = figures_of(results, cold); !figures.empty()) {
        print(figures);
        fmt::print("\n");
    }
    if (const auto slopes = slopes_of(results); !slopes.empty()) {
        fmt::print("exponents of the time of 'cinch'\n");
        for (const Slope& s : slopes)
            fmt::print("{:<44} {:>7.2f}\n", s.what, s.exponent);
        fmt::print("\n");
    }
}

} // namespace cinch
