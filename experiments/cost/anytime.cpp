// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include "cinch/deform.hpp"
#include "experiments/cost/cost.hpp"
#include "experiments/report/number.hpp"

namespace cinch {
namespace {

// The vertices' supports, as a program that does not bound takes them: by the fast evaluation, without a proof.
struct AllVertices {
    SurfaceEvaluator<double> evaluate;
    std::vector<Vec3> position;

    explicit AllVertices(const DeformableSurface& surface) : evaluate(surface), position(surface.mesh.vertices) {}
    void operator()(std::span<const AffineMap> maps, int kdop, std::span<double> supports)
    {
        evaluate(maps, position);
        const auto axes = axes_of(kdop);
        std::fill(supports.begin(), supports.end(), -INFINITY);
        for (const Vec3& x : position)
            for (std::size_t a = 0; a < axes.size(); ++a) {
                const double along = axes[a][0] * x[0] + axes[a][1] * x[1] + axes[a][2] * x[2];
                supports[2 * a] = std::max(supports[2 * a], along);
                supports[2 * a + 1] = std::max(supports[2 * a + 1], -along);
            }
    }
};

} // namespace

std::vector<CostContestant> anytime_contestants(const CostSample& sample, int kdop, const AnytimeLimits& limits)
{
    std::vector<CostContestant> all;
    const auto bounder = std::make_shared<AnytimeBounder>(sample.bvh, sample.surface, RefitOptions{Method::best, kdop});
    bounder->begin(sample.maps);
    const auto add = [&](const std::string& until, auto&& refine) {
        all.push_back({"anytime", until, "proven", true, [bounder, refine](std::span<double> supports) {
                           bounder->begin(0);
                           refine(*bounder);
                           std::ranges::copy(bounder->supports(), supports.begin());
                       }});
    };
    add("one bound", [](AnytimeBounder&) {});
    for (const double ns : limits.budgets_ns)
        add(grouped(static_cast<std::size_t>(ns)) + " ns",
            [ns](AnytimeBounder& b) { b.refine_for(std::chrono::nanoseconds(static_cast<std::int64_t>(ns))); });
    for (const double tolerance : limits.tolerances)
        add(tolerance == 0 ? "true box" : fmt::format("within {:g} %", 100 * tolerance),
            [tolerance](AnytimeBounder& b) { b.refine_to(tolerance); });
    all.push_back(
        {"vertices", "double, proven", "proven", true,
         [&sample, refitter = std::make_shared<AnytimeBounder>(
                       sample.bvh, sample.surface, RefitOptions{Method::vertices, kdop})](std::span<double> supports) {
             refitter->begin(sample.maps);
             refitter->begin(0);
             std::ranges::copy(refitter->supports(), supports.begin());
         }});
    all.push_back({"vertices", "double kernel", "none", false,
                   [&sample, kdop, vertices = std::make_shared<AllVertices>(sample.surface)](
                       std::span<double> supports) { (*vertices)(sample.maps, kdop, supports); }});
    return all;
}

} // namespace cinch
