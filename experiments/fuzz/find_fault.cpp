// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "cinch/refit.hpp"
#include "exact/check_space.hpp"
#include "exact/verifier.hpp"
#include "experiments/fuzz/fuzz_case.hpp"
#include "toolkit/bounds/weight_space.hpp"
#include "toolkit/deform/dyadic.hpp"

namespace cinch {
namespace {

// What the toolkit sees of a weight space: the truth, or with a defect.
struct Seen {
    std::vector<double> l, h, b;
};

std::string space_fault(const Case& problem, Defect defect)
{
    Seen seen{problem.l, problem.h, problem.b[0]};
    if (defect == Defect::lower_h)
        seen.h[0] = std::max(0.0, seen.h[0] - weight_unit);
    if (defect == Defect::sum_order)
        for (auto* values : {&seen.l, &seen.h, &seen.b})
            std::reverse(values->begin(), values->end());
    const Rounding rounding = defect == Defect::no_rounding ? Rounding::plain : Rounding::proven;
    const WeightSpace space{seen.l, seen.h};

    static thread_local std::vector<std::pair<double, double>> scratch;
    const double greatest = *std::max_element(seen.b.begin(), seen.b.end()),
                 least = *std::min_element(seen.b.begin(), seen.b.end());
    const double second = second_largest(seen.b);
    double best = best_lambda(space, seen.b, scratch);
    if (defect == Defect::wrong_lambda)
        best = best - 0.5 * (greatest - best) - 1;
    const double middle = 0.5 * greatest + 0.5 * least;
    const double convex = greatest, at_second = dual_bound(space, seen.b, second, rounding),
                 at_best = dual_bound(space, seen.b, best, rounding);
    const double eq12 = std::min(convex, at_second), limited = std::min(eq12, at_best);
    const exact::ClaimedBound claims[] = {
        {"convex", convex},
        {"eq12", eq12},
        {"limited", limited},
        {"D at the second-largest b", at_second, true, second},
        {"D at the best lambda", at_best, std::isfinite(best), best},
        {"D at the middle", dual_bound(space, seen.b, middle, rounding), true, middle}};
    std::string fault = exact::space_fault(problem.space(), problem.b[0], claims);
    if (fault.empty() && problem.l.size() <= 6)
        fault = exact::corner_fault(problem.space(), problem.b[0]);
    return fault;
}

DeformableSurface surface_of(const FuzzCase& problem)
{
    DeformableSurface surface;
    surface.mesh.vertices = problem.rest;
    surface.weights.node_count = static_cast<std::uint32_t>(problem.maps.size());
    for (std::uint32_t k = 0; k < problem.rest.size(); ++k) {
        surface.mesh.triangles.push_back({k, k, k});
        for (std::uint32_t j = 0; j < problem.maps.size(); ++j)
            if (problem.weights[k][j] > 0) {
                surface.weights.node.push_back(j);
                surface.weights.weight.push_back(problem.weights[k][j]);
            }
        surface.weights.row.push_back(static_cast<std::uint32_t>(surface.weights.node.size()));
    }
    return surface;
}

void damage(Bvh& bvh, const DeformableSurface& surface, Defect defect)
{
    if (defect == Defect::lower_h)
        bvh.h[0] -= weight_unit;
    if (defect ==
        Defect::small_box) { // build_bvh adds a step or two to the computed half; one ulp below it is too small
        double& half = bvh.bvs[0].box.half[0];
        double computed = 0;
        for (const Vec3& p : surface.mesh.vertices)
            computed = std::max(computed, std::abs(p[0] - bvh.bvs[0].box.centre[0]));
        half = std::nextafter(computed, -1.0);
    }
}

std::string surface_fault(const FuzzCase& problem, Defect defect)
{
    const DeformableSurface surface = surface_of(problem);
    Bvh bvh = build_bvh(surface, problem.rest.size()); // one BV
    damage(bvh, surface, defect);
    Bvh seen = bvh;
    if (defect == Defect::sum_order) {
        std::reverse(seen.node.begin(), seen.node.end());
        std::reverse(seen.l.begin(), seen.l.end());
        std::reverse(seen.h.begin(), seen.h.end());
        std::reverse(seen.local.begin(), seen.local.end());
        std::reverse(seen.radius.begin(), seen.radius.end());
        std::reverse(seen.model.begin(), seen.model.end());
    }
    const exact::Verifier verifier(surface, bvh);
    const Rounding rounding = defect == Defect::no_rounding ? Rounding::plain : Rounding::proven;
    const auto k = static_cast<std::size_t>(problem.kdop);
    auto bounds_of = [&](Methods methods, Precision precision, int passes, RestShape shape = RestShape::aabb) {
        std::vector<double> supports(k);
        refit(seen, surface, problem.maps, {methods, problem.kdop, rounding, precision, passes, shape}, supports);
        return supports;
    };
    auto fault_of = [&](Methods methods, Precision precision, std::span<const double> supports,
                        RestShape shape = RestShape::aabb) -> std::string {
        const exact::FrameVerdict verdict = verifier.check(problem.maps, methods, problem.kdop, supports, shape);
        if (verdict.examples.empty())
            return {};
        const exact::Violation& v = verdict.examples.front();
        return name_of(methods) + " in " + std::string(name_of(precision)) + ", direction " +
               std::to_string(v.direction) + ", " + exact::name_of(v.statement) + ": " + v.detail;
    };
    std::uint32_t trial = 0;
    auto wanted = [&] { return ++trial == problem.trial || problem.trial == 0; };
    for (const Precision precision : {Precision::float64, Precision::float32}) {
        if (wanted()) {
            std::vector<double> looser;
            for (const Method method : ladder_methods) {
                const std::vector<double> supports = bounds_of(method, precision, 1);
                if (std::string fault = fault_of(method, precision, supports); !fault.empty())
                    return fault;
                for (std::size_t d = 0; d < looser.size(); ++d)
                    if (!(supports[d] <= looser[d]))
                        return std::string(name_of(method)) + ", direction " + std::to_string(d) +
                               ": looser than the method before it";
                looser = supports;
            }
        }
        if (wanted())
            for (const Method method : ladder_methods)
                if (std::string fault =
                        fault_of(method, precision, bounds_of(method, precision, 1, RestShape::obb), RestShape::obb);
                    !fault.empty())
                    return "oriented boxes: " + fault;
        for (const Method method : kernel_methods.without(ladder_methods)) {
            if (!wanted())
                continue;
            if (std::string fault = fault_of(method, precision, bounds_of(method, precision, problem.passes));
                !fault.empty())
                return fault;
        }
        if (!wanted())
            continue;
        const auto both = bounds_of(Method::support | Method::linear, precision, 1),
                   support = bounds_of(Method::support, precision, 1), linear = bounds_of(Method::linear, precision, 1);
        for (std::size_t d = 0; d < k; ++d)
            if (both[d] != std::min(support[d], linear[d]))
                return "support+linear, direction " + std::to_string(d) + ": not the lesser of the two";
    }
    for (const Method method : {Method::corners, Method::sphere, Method::vertices})
        if (wanted())
            if (std::string fault = fault_of(method, Precision::float64, bounds_of(method, Precision::float64, 1));
                !fault.empty())
                return fault;
    return {};
}

} // namespace

std::string find_fault(const FuzzCase& problem, Defect defect)
{
    try {
        if (problem.is_of_times())
            return time_fault(problem, defect);
        return problem.is_surface() ? surface_fault(problem, defect) : space_fault(problem.space, defect);
    } catch (const std::exception& error) {
        return std::string("exception: ") + error.what();
    }
}

} // namespace cinch
