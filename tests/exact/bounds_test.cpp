// SPDX-License-Identifier: GPL-3.0-or-later
// The toolkit's doubles against exact arithmetic on random and hard families.
#include <random>

#include <catch2/catch.hpp>

#include "cinch/deform.hpp"
#include "exact/formulas.hpp"
#include "exact/optimum.hpp"
#include "toolkit/bounds/bound_vertex.hpp"
#include "toolkit/deform/dyadic.hpp"

using namespace cinch;
using namespace cinch::exact;

namespace {

// Some vertices in a box with dyadic weights, and maps from a family.
struct Case {
    std::vector<Vec3> rest;
    std::vector<std::vector<double>> weight; // per vertex, dense over the nodes
    std::vector<AffineMap> maps;
    std::vector<std::uint32_t> node;
    std::vector<double> l, h;
    Vec3 centre, half;
};

enum Family {
    generic,
    large_translation,
    subnormal,
    coincident,
    near_singular,
    reflected,
    single_node,
    huge,
    family_count
};

Case draw(Family family, std::mt19937_64& random)
{
    auto uniform = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
    Case c;
    const std::size_t n = family == single_node ? 1 : 2 + random() % 7, vertices = 1 + random() % 4;
    for (std::size_t j = 0; j < n; ++j) {
        c.node.push_back(static_cast<std::uint32_t>(j));
        AffineMap m;
        for (int r = 0; r < 3; ++r)
            for (int s = 0; s < 4; ++s) {
                m.m[r][s] = uniform(-2, 2);
                if (family == large_translation)
                    m.m[r][s] = s == 3 ? 1e8 + uniform(-1e-3, 1e-3) : (r == s) + uniform(-1e-3, 1e-3);
                if (family == subnormal)
                    m.m[r][s] *= s == 3 ? 0x1p-1070 : 0x1p-530;
                if (family == coincident)
                    m.m[r][s] = std::round(m.m[r][s]);
                if (family == near_singular && r == 2)
                    m.m[r][s] = m.m[1][s] * (1 + 0x1p-50);
                if (family == reflected && s == 0)
                    m.m[r][s] = r == 0 ? -1 : 0;
                if (family == huge)
                    m.m[r][s] *= 0x1p1000;
            }
        c.maps.push_back(m);
    }
    const double scale = family == subnormal ? 0x1p-530 : family == large_translation ? 1e-3 : 1;
    Vec3 low, high;
    for (std::size_t k = 0; k < vertices; ++k) {
        Vec3 p = scale * Vec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
        if (family == coincident)
            p = Vec3(std::round(p.x()), std::round(p.y()), std::round(p.z()));
        c.rest.push_back(p);
        low = k ? Vec3(low.cwiseMin(p)) : p;
        high = k ? Vec3(high.cwiseMax(p)) : p;
        std::vector<double> w;
        for (std::size_t j = 0; j < n; ++j)
            w.push_back(random() % 4 ? uniform(0, 1) : 0);
        w[random() % n] += 0.1;
        round_dyadic(w);
        for (std::size_t j = 0; j < n; ++j) {
            c.l.resize(n, 2);
            c.h.resize(n, -1);
            c.l[j] = std::min(c.l[j], w[j]);
            c.h[j] = std::max(c.h[j], w[j]);
        }
        c.weight.push_back(w);
    }
    c.centre = 0.5 * low + 0.5 * high;
    for (int a = 0; a < 3; ++a) { // as tight as a double can be: exact containment, no slack beyond one step
        c.half[a] = std::max(high[a] - c.centre[a], c.centre[a] - low[a]);
        while (Exact(c.half[a]) < Exact(high[a]) - Exact(c.centre[a]) ||
               Exact(c.half[a]) < Exact(c.centre[a]) - Exact(low[a]))
            c.half[a] = std::nextafter(c.half[a], 1.0);
    }
    return c;
}

struct Count {
    std::size_t checked = 0, below = 0;
};

// How often the bound fell below the exact optimum, a deformed vertex, or a computed vertex.
Count below_exact(const Case& c, Method method, Rounding rounding)
{
    Count count;
    BoundScratch scratch;
    std::vector<double> supports(26);
    bound_box({{c.centre, c.half},
               c.node,
               {c.l, c.h},
               {},
               {},
               Vec3::Zero(),
               {},
               {},
               0,
               static_cast<std::uint32_t>(c.node.size())},
              c.maps, method, rounding, axes_of(26), scratch, supports);
    for (std::size_t d = 0; d < 26; ++d) {
        if (std::isinf(supports[d])) {
            ++count.checked;
            continue;
        }
        const Exact bound(supports[d]);
        const Axis& axis = axes_of(26)[d / 2];
        std::vector<Exact> b;
        for (const AffineMap& map : c.maps) {
            const auto both = extremum<Exact>(c.centre, c.half, map, axis);
            b.push_back(d % 2 ? both.minus : both.plus);
        }
        bool below = bound < optimum({c.l, c.h}, b)->value;
        for (std::size_t k = 0; k < c.rest.size(); ++k) {
            const Weights::Row row{c.node, c.weight[k]};
            below |= bound < along(deformed<Exact>(c.rest[k], row, c.maps), axis, d % 2);
            if (rounding == Rounding::proven)
                below |= bound < along(as_point<Exact>(evaluate_vertex(c.rest[k], row, c.maps)), axis, d % 2);
        }
        ++count.checked;
        count.below += below;
    }
    return count;
}

} // namespace

TEST_CASE("proven bounds are never below the exact optimum, the exact vertices or the computed vertices")
{
    std::mt19937_64 random(11);
    for (int family = 0; family < family_count; ++family)
        for (int trial = 0; trial < 150; ++trial) {
            const Case c = draw(static_cast<Family>(family), random);
            for (Method method : ladder_methods) {
                INFO("family " << family << ", trial " << trial << ", " << name_of(method));
                REQUIRE(below_exact(c, method, Rounding::proven).below == 0);
            }
        }
}

TEST_CASE("without the rounding terms the same check does find bounds below the exact value")
{
    std::mt19937_64 random(11);
    Count total;
    for (int trial = 0; trial < 100; ++trial) {
        const Count count = below_exact(draw(generic, random), Method::limited, Rounding::plain);
        total.checked += count.checked;
        total.below += count.below;
    }
    CHECK(total.below > total.checked / 20);
}

TEST_CASE("finite cases get finite bounds")
{
    std::mt19937_64 random(3);
    BoundScratch scratch;
    std::vector<double> supports(26);
    for (Family family : {generic, large_translation, subnormal, near_singular, huge})
        for (int trial = 0; trial < 50; ++trial) {
            const Case c = draw(family, random);
            bound_box({{c.centre, c.half}, c.node, {c.l, c.h}, {}, {}, Vec3::Zero(), {}, {}, 0, 8}, c.maps,
                      Method::limited, Rounding::proven, axes_of(26), scratch, supports);
            for (double s : supports)
                REQUIRE(std::isfinite(s));
        }
}

TEST_CASE("translations of 1e8 on an extent of 1e-3 inflate the bound by about 1e-7 at most")
{
    std::mt19937_64 random(5);
    BoundScratch scratch;
    std::vector<double> supports(6);
    for (int trial = 0; trial < 50; ++trial) {
        const Case c = draw(large_translation, random);
        bound_box({{c.centre, c.half},
                   c.node,
                   {c.l, c.h},
                   {},
                   {},
                   Vec3::Zero(),
                   {},
                   {},
                   0,
                   static_cast<std::uint32_t>(c.node.size())},
                  c.maps, Method::limited, Rounding::proven, axes_of(6), scratch, supports);
        for (std::size_t d = 0; d < 6; ++d) {
            std::vector<Exact> b;
            for (const AffineMap& map : c.maps) {
                const auto both = extremum<Exact>(c.centre, c.half, map, axes_of(6)[d / 2]);
                b.push_back(d % 2 ? both.minus : both.plus);
            }
            CHECK(CGAL::to_double(Exact(supports[d]) - optimum({c.l, c.h}, b)->value) < 4e-7);
        }
    }
}

TEST_CASE("bound_vertex contains the exact and the computed vertex")
{
    std::mt19937_64 random(13);
    std::vector<double> supports(26);
    for (int family = 0; family < family_count; ++family)
        for (int trial = 0; trial < 100; ++trial) {
            const Case c = draw(static_cast<Family>(family), random);
            for (std::size_t k = 0; k < c.rest.size(); ++k) {
                const Weights::Row row{c.node, c.weight[k]};
                bound_vertex(c.rest[k], row, c.maps, Rounding::proven, axes_of(26), supports);
                const auto exact = deformed<Exact>(c.rest[k], row, c.maps);
                const auto computed = as_point<Exact>(evaluate_vertex(c.rest[k], row, c.maps));
                for (std::size_t d = 0; d < 26; ++d)
                    if (!std::isinf(supports[d])) {
                        REQUIRE(along(exact, axes_of(26)[d / 2], d % 2) <= Exact(supports[d]));
                        REQUIRE(along(computed, axes_of(26)[d / 2], d % 2) <= Exact(supports[d]));
                    }
            }
        }
}
