// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "cinch/bounds.hpp"
#include "experiments/fuzz/fuzz_case.hpp"
#include "toolkit/deform/dyadic.hpp"
#include "toolkit/deform/sample_nodes.hpp"
#include "toolkit/surface/shapes.hpp"
#include "toolkit/surface/triangle_mesh.hpp"

namespace cinch {
namespace {

/// SplitMix64: tiny state, so that every case has a generator of its own.
class Random {
public:
    explicit Random(std::uint64_t state) : state_(state) {}
    std::uint64_t bits()
    {
        std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return z ^ (z >> 31);
    }
    std::size_t below(std::size_t n) { return static_cast<std::size_t>(bits() % n); }
    double uniform(double a, double b) { return a + (b - a) * static_cast<double>(bits() >> 11) * 0x1p-53; }
    double signed_magnitude(int low, int high)
    {
        return (bits() % 2 ? 1 : -1) *
               std::ldexp(uniform(1, 2), low + static_cast<int>(below(static_cast<std::size_t>(high - low + 1))));
    }

private:
    std::uint64_t state_;
};

using Draw = void (*)(Random&, FuzzCase&);

void add_weight(FuzzCase& c, double l, double h)
{
    c.space.l.push_back(std::clamp(std::min(l, h), 0.0, 1.0));
    c.space.h.push_back(std::clamp(std::max(l, h), 0.0, 1.0));
}

// Extrema of several kinds: plain, with ties, offset so that they cancel, widely scaled.
void add_extrema(Random& r, FuzzCase& c)
{
    std::vector<double> b;
    const std::size_t kind = r.below(5);
    const double offset = r.signed_magnitude(0, 30);
    for (std::size_t j = 0; j < c.space.l.size(); ++j)
        b.push_back(kind == 0   ? r.uniform(-1, 1)
                    : kind == 1 ? static_cast<double>(r.below(4))
                    : kind == 2 ? offset + r.uniform(-1, 1)
                    : kind == 3 ? r.signed_magnitude(-40, 40)
                                : offset);
    c.space.b = {b};
}

std::size_t small_n(Random& r) { return 1 + r.below(16); }

void generic(Random& r, FuzzCase& c)
{
    const std::size_t n = small_n(r);
    for (std::size_t j = 0; j < n; ++j)
        add_weight(c, r.uniform(0, 1.0 / static_cast<double>(n)), r.uniform(0, 1));
    add_extrema(r, c);
}

void zero_l(Random& r, FuzzCase& c)
{
    for (std::size_t j = small_n(r); j > 0; --j)
        add_weight(c, 0, r.uniform(0, 1));
    add_extrema(r, c);
}

void narrow(Random& r, FuzzCase& c)
{
    const std::size_t n = small_n(r);
    const double mean = 1.0 / static_cast<double>(n), width = std::ldexp(1, -static_cast<int>(r.below(50)));
    for (std::size_t j = 0; j < n; ++j)
        add_weight(c, mean * (1 - width * r.uniform(0, 1)), mean * (1 + width * r.uniform(0, 1)));
    add_extrema(r, c);
}

void hypersimplex(Random& r, FuzzCase& c)
{
    const std::size_t n = 2 + r.below(15);
    const double h = std::min(1.0, static_cast<double>(1 + r.below(n)) / static_cast<double>(n));
    for (std::size_t j = 0; j < n; ++j)
        add_weight(c, 0, h);
    add_extrema(r, c);
}

void hypersimplex_rounded(Random& r, FuzzCase& c)
{
    hypersimplex(r, c);
    for (double& h : c.space.h)
        h = std::min(1.0, r.below(2) ? std::nextafter(h, r.below(2) ? 0.0 : 1.0) : h);
}

void coincident_sums(Random& r, FuzzCase& c)
{
    const int bits = 2 + static_cast<int>(r.below(3));
    const std::size_t n = small_n(r);
    for (std::size_t j = 0; j < n; ++j)
        add_weight(c, std::ldexp(static_cast<double>(r.below(2)), -bits),
                   std::ldexp(static_cast<double>(r.below(std::size_t{1} << bits)), -bits));
    add_extrema(r, c);
}

std::vector<double> dyadic_weights(Random& r, std::size_t n)
{
    std::vector<double> w;
    for (std::size_t j = 0; j < n; ++j)
        w.push_back(r.below(4) ? r.uniform(0, 1) : 0);
    w[r.below(n)] += 0.25;
    round_dyadic(w);
    return w;
}

void fixed_weights(Random& r, FuzzCase& c)
{
    for (double w : dyadic_weights(r, small_n(r)))
        add_weight(c, w, r.below(4) ? w : r.uniform(w, 1));
    add_extrema(r, c);
}

// Exactly one unit of room.
void ulp_slack(Random& r, FuzzCase& c)
{
    for (double w : dyadic_weights(r, 2 + r.below(15)))
        add_weight(c, w, w);
    const std::size_t j = r.below(c.space.l.size()), k = (j + 1) % c.space.l.size();
    c.space.l[j] = std::max(0.0, c.space.l[j] - weight_unit);
    c.space.h[k] = std::max(c.space.l[k], std::min(1.0, c.space.h[k] + weight_unit));
    add_extrema(r, c);
}

void ulp_infeasible(Random& r, FuzzCase& c)
{
    for (double w : dyadic_weights(r, small_n(r)))
        add_weight(c, w, w);
    for (std::size_t j = 0; j < c.space.l.size(); ++j)
        if (c.space.h[j] >= weight_unit) { // Σ h = 1 − 2^-53
            c.space.h[j] -= weight_unit;
            c.space.l[j] = c.space.h[j];
            break;
        }
    add_extrema(r, c);
}

void subnormal_extrema(Random& r, FuzzCase& c)
{
    generic(r, c);
    for (double& b : c.space.b[0])
        b = std::ldexp(r.uniform(-1, 1), -1060 - static_cast<int>(r.below(15)));
}

void subnormal_weights(Random& r, FuzzCase& c)
{
    const std::size_t n = small_n(r);
    for (std::size_t j = 0; j < n; ++j)
        add_weight(c, std::ldexp(r.uniform(0, 1), -1070), r.below(2) ? 1 : std::ldexp(r.uniform(0, 1), -1060));
    add_extrema(r, c);
}

void huge_extrema(Random& r, FuzzCase& c)
{
    generic(r, c);
    for (double& b : c.space.b[0])
        b = r.signed_magnitude(1000, 1023);
}

AffineMap random_map(Random& r, double size, double translation)
{
    AffineMap map;
    for (auto& row : map.m)
        for (int s = 0; s < 4; ++s)
            row[s] = (s < 3 ? size : translation) * r.uniform(-2, 2);
    return map;
}

// Up to six vertices and sixteen nodes; `scale` of the rest positions.
void surface(Random& r, FuzzCase& c, double scale)
{
    static constexpr int kdops[] = {6, 6, 6, 14, 18, 26};
    c.kdop = kdops[r.below(6)];
    const std::size_t n = 1 + r.below(16), vertices = 1 + r.below(6);
    for (std::size_t j = 0; j < n; ++j)
        c.maps.push_back(random_map(r, 1, 1));
    for (std::size_t k = 0; k < vertices; ++k) {
        c.rest.emplace_back(scale * r.uniform(-1, 1), scale * r.uniform(-1, 1), scale * r.uniform(-1, 1));
        c.weights.push_back(dyadic_weights(r, n));
    }
}

void surface_generic(Random& r, FuzzCase& c) { surface(r, c, 1); }

void surface_translated(Random& r, FuzzCase& c)
{
    surface(r, c, 1e-3);
    for (AffineMap& map : c.maps)
        for (int row = 0; row < 3; ++row)
            for (int s = 0; s < 4; ++s)
                map.m[row][s] = s == 3 ? 1e8 + r.uniform(-1e-3, 1e-3) : (row == s) + r.uniform(-1e-3, 1e-3);
}

void surface_singular(Random& r, FuzzCase& c)
{
    surface(r, c, 1);
    for (AffineMap& map : c.maps)
        for (int s = 0; s < 3; ++s)
            map.m[2][s] = map.m[1][s] * (1 + std::ldexp(r.uniform(-1, 1), -static_cast<int>(r.below(60))));
}

void surface_reflected(Random& r, FuzzCase& c)
{
    surface(r, c, 1);
    for (AffineMap& map : c.maps)
        for (int row = 0; row < 3; ++row)
            for (int s = 0; s < 3; ++s)
                map.m[row][s] = row == s ? (row == 0 ? -1 : 1) : r.uniform(-1e-9, 1e-9);
}

void surface_single_vertex(Random& r, FuzzCase& c)
{
    surface(r, c, 1);
    c.rest.resize(1);
    c.weights.resize(1);
}

void surface_tiny(Random& r, FuzzCase& c)
{
    surface(r, c, 0x1p-530);
    for (AffineMap& map : c.maps)
        for (auto& row : map.m)
            for (int s = 0; s < 4; ++s)
                row[s] *= s == 3 ? 0x1p-1072 : 0x1p-540;
}

void surface_huge(Random& r, FuzzCase& c)
{
    surface(r, c, 1);
    for (AffineMap& map : c.maps)
        for (auto& row : map.m)
            for (double& x : row)
                x *= 0x1p1020;
}

void surface_integer(Random& r, FuzzCase& c) // ties and exact coincidences
{
    surface(r, c, 3);
    for (AffineMap& map : c.maps)
        for (auto& row : map.m)
            for (double& x : row)
                x = std::round(x);
    for (Vec3& p : c.rest)
        p = Vec3(std::round(p.x()), std::round(p.y()), std::round(p.z()));
}

// Vertices and weights of a shipped scene, under random maps.
void scene_weights(Random& r, FuzzCase& c)
{
    static const TriangleMesh mesh = [] {
        TriangleMesh m = brain(3500);
        centre_and_scale(m, 1.2);
        return m;
    }();
    static const Weights weights = kernel_weights(mesh, sample_nodes(mesh, 200, 0), 2);
    const Triangle& t = mesh.triangles[r.below(mesh.triangles.size())];
    std::vector<std::uint32_t> nodes;
    for (std::uint32_t v : t)
        nodes.insert(nodes.end(), weights.of(v).node.begin(), weights.of(v).node.end());
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    for (std::uint32_t v : t) {
        c.rest.push_back(mesh.vertices[v]);
        std::vector<double> dense(nodes.size(), 0);
        const auto row = weights.of(v);
        for (std::size_t i = 0; i < row.node.size(); ++i)
            dense[static_cast<std::size_t>(std::lower_bound(nodes.begin(), nodes.end(), row.node[i]) - nodes.begin())] =
                row.weight[i];
        c.weights.push_back(dense);
    }
    const double wildness = std::ldexp(1, -static_cast<int>(r.below(30)));
    for (std::size_t j = 0; j < nodes.size(); ++j) {
        AffineMap map = random_map(r, wildness, wildness);
        for (int i = 0; i < 3; ++i)
            map.m[i][i] += 1;
        c.maps.push_back(map);
    }
}

void times(Random& r, FuzzCase& c)
{
    c.drawn = r.bits();
    c.trial = static_cast<std::uint32_t>(r.below(6));
    c.passes = static_cast<int>(r.below(2));
    c.kdop = kdops[r.below(kdops.size())];
}

struct Family {
    std::string_view name;
    Draw draw;
};

constexpr Family families[] = {
    {"generic", generic},
    {"zero-l", zero_l},
    {"narrow", narrow},
    {"hypersimplex", hypersimplex},
    {"hypersimplex-rounded", hypersimplex_rounded},
    {"coincident-sums", coincident_sums},
    {"fixed", fixed_weights},
    {"ulp-slack", ulp_slack},
    {"ulp-infeasible", ulp_infeasible},
    {"subnormal-extrema", subnormal_extrema},
    {"subnormal-weights", subnormal_weights},
    {"huge-extrema", huge_extrema},
    {"surface", surface_generic},
    {"surface-translated", surface_translated},
    {"surface-singular", surface_singular},
    {"surface-reflected", surface_reflected},
    {"surface-single-vertex", surface_single_vertex},
    {"surface-tiny", surface_tiny},
    {"surface-huge", surface_huge},
    {"surface-integer", surface_integer},
    {"scene-weights", scene_weights},
    {"times", times},
};
constexpr std::size_t in_turn = std::size(families) - 1; // all but the last

} // namespace

std::vector<std::string_view> fuzz_families()
{
    std::vector<std::string_view> names;
    for (const Family& family : families)
        names.push_back(family.name);
    return names;
}

FuzzCase draw_case(std::uint64_t seed, std::uint64_t index, std::string_view wanted)
{
    const Family* family = &families[index % in_turn];
    for (const Family& f : families)
        if (f.name == wanted)
            family = &f;
    Random random(seed ^ Random(index).bits());
    FuzzCase out;
    out.family = family->name;
    family->draw(random, out);
    if (out.is_surface()) {
        out.trial = 1 + static_cast<std::uint32_t>(random.below(surface_trials));
        out.passes = static_cast<int>(random.below(4));
    }
    return out;
}

} // namespace cinch
