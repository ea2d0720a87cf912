// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/explain.hpp"

#include <cmath>
#include <stdexcept>

#include "exact/formulas.hpp"
#include "exact/optimum.hpp"
#include "exact/rest_data.hpp"

namespace cinch::exact {
namespace {

struct Extrema {
    RestBv rest;
    const Axis& axis;
    bool against;
    std::vector<Exact> b;
};

Extrema extrema_of(const OneBound& place)
{
    const Vec3& half = place.bvh.bvs[place.bv].box.half;
    if (!(std::isfinite(half[0]) && std::isfinite(half[1]) && std::isfinite(half[2])))
        throw std::invalid_argument("no finite bound follows from an infinite rest box");
    Extrema out{place.bvh.rest(place.bv),
                axes_of(place.kdop)[static_cast<std::size_t>(place.direction / 2)],
                place.direction % 2 == 1,
                {}};
    for (std::uint32_t node : out.rest.node) {
        const auto both = extremum<Exact>(out.rest.box.centre, out.rest.box.half, place.maps[node], out.axis);
        out.b.push_back(out.against ? both.minus : both.plus);
    }
    return out;
}

Exact method_value(Methods methods, const Extrema& e, const Exact& best)
{
    if (methods.contains(Method::limited))
        return best;
    if (methods == Method::corners)
        return best_corner(e.rest.space, e.b);
    std::vector<Exact> sorted = e.b;
    std::sort(sorted.begin(), sorted.end(), [](const Exact& x, const Exact& y) { return y < x; });
    return !methods.contains(Method::eq12) || sorted.size() == 1 ? sorted[0] : dual_value(e.rest.space, e.b, sorted[1]);
}

// The vertices that may be the farthest along the direction: all others lie behind one of them, by interval arithmetic.
std::vector<std::uint32_t> farthest(const OneBound& place, const std::vector<std::uint32_t>& vertices, const Axis& axis,
                                    bool against)
{
    const DirectedRounding upward;
    std::vector<Interval> support;
    for (std::uint32_t k : vertices)
        support.push_back(
            along(deformed<Interval>(place.surface.mesh.vertices[k], place.surface.weights.of(k), place.maps), axis,
                  against));
    double reached = support[0].inf();
    for (const Interval& s : support)
        reached = std::max(reached, s.inf());
    std::vector<std::uint32_t> out;
    for (std::size_t i = 0; i < vertices.size(); ++i)
        if (!(support[i].sup() < reached)) // NaN stays in
            out.push_back(vertices[i]);
    return out;
}

} // namespace

ExactLoss exact_loss(const OneBound& place)
{
    const Exact bound(place.bound), zero(0);
    const auto vertices = vertices_of(place.surface, place.bvh, place.bv);
    const Axis& axis = axes_of(place.kdop)[static_cast<std::size_t>(place.direction / 2)];
    const bool against = place.direction % 2 == 1;
    const std::vector<std::uint32_t> ahead = farthest(place, vertices, axis, against);
    auto support_of = [&](std::uint32_t k) {
        return along(deformed<Exact>(place.surface.mesh.vertices[k], place.surface.weights.of(k), place.maps), axis,
                     against);
    };
    Exact truth = support_of(ahead[0]);
    for (std::uint32_t k : ahead)
        truth = maximum(truth, support_of(k));
    if (!place.methods.within(box_methods))
        return {as_fraction(zero), as_fraction(zero), as_fraction(zero), as_fraction(bound - truth),
                as_fraction(bound - truth)};

    const Extrema e = extrema_of(place);
    const auto best = optimum(e.rest.space, e.b);
    if (!best)
        throw std::invalid_argument("exact_loss: the weight space is empty");
    bool first = true;
    Exact boxes(0);
    for (std::uint32_t k : vertices) {
        const Weights::Row row = place.surface.weights.of(k);
        Exact blended(0);
        for (std::size_t i = 0; i < row.node.size(); ++i) {
            const auto j = std::lower_bound(e.rest.node.begin(), e.rest.node.end(), row.node[i]) - e.rest.node.begin();
            blended = blended + Exact(row.weight[i]) * e.b[static_cast<std::size_t>(j)];
        }
        boxes = first ? blended : maximum(boxes, blended);
        first = false;
    }
    const Exact value = method_value(place.methods, e, best->value);
    return {as_fraction(boxes - truth), as_fraction(best->value - boxes), as_fraction(value - best->value),
            as_fraction(bound - value), as_fraction(bound - truth)};
}

std::string vipr(const OneBound& place)
{
    const Extrema e = extrema_of(place);
    const auto best = optimum(e.rest.space, e.b);
    if (!best || !place.methods.within(box_methods))
        throw std::invalid_argument("vipr: there is no weight space to bound over");
    const std::size_t n = e.b.size();
    auto numbers = [&](auto&& value) {
        std::string line = std::to_string(n);
        for (std::size_t j = 0; j < n; ++j)
            line += " " + std::to_string(j) + " " + value(j);
        return line;
    };
    std::string out = "% BV " + std::to_string(place.bv) + ", direction " + std::to_string(place.direction) +
                      "\nVER 1.0\nVAR " + std::to_string(n) + "\n";
    for (std::uint32_t node : e.rest.node)
        out += "w" + std::to_string(node) + "\n";
    out += "INT 0\n\nOBJ max\n" + numbers([&](std::size_t j) { return as_fraction(e.b[j]); }) + "\n\n";
    out += "CON " + std::to_string(2 * n + 1) + " " + std::to_string(2 * n) + "\n";
    out += "sum E 1 " + numbers([](std::size_t) { return std::string("1"); }) + "\n";
    for (std::size_t j = 0; j < n; ++j) {
        const std::string name = std::to_string(e.rest.node[j]), at = " 1 " + std::to_string(j) + " 1\n";
        out += "l" + name + " G " + as_fraction(Exact(e.rest.space.l[j])) + at;
        out += "h" + name + " L " + as_fraction(Exact(e.rest.space.h[j])) + at;
    }
    // b_j = λ + (b_j − λ): λ times the sum, and b_j − λ times w_j ≤ h_j where it is positive, w_j ≥ l_j where it is
    // negative.
    out += "\nRTP range -inf " + as_fraction(Exact(place.bound)) + "\n\nSOL 0\n\nDER 1\n";
    out += "dual L " + as_fraction(best->value) + " OBJ { lin " + std::to_string(n + 1) + " 0 " +
           as_fraction(best->lambda);
    for (std::size_t j = 0; j < n; ++j) {
        const Exact above = e.b[j] - best->lambda;
        out += " " + std::to_string(1 + 2 * j + (above > Exact(0) ? 1 : 0)) + " " + as_fraction(above);
    }
    return out + " } -1\n";
}

} // namespace cinch::exact
