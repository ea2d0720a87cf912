// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <random>

#include "cinch/bvh.hpp"
#include "exact/formulas.hpp"
#include "tests/support.hpp"
#include "toolkit/bounds/bound_moments.hpp"
#include "toolkit/hierarchy/moments.hpp"

namespace cinch::exact {

/// What tests of the moment bound share: lifted vectors from their definition, and a scene with its rest data.
using Random = std::mt19937_64;
using ExactLifted = std::array<Exact, lifted_size>;

inline double uniform(Random& random, double most)
{
    return most * (static_cast<double>(random() >> 11) * 0x1p-52 - 1);
}
inline Exact half(const Exact& x) { return x * Exact(0.5); }

inline std::size_t place_in(const RestBv& bv, std::uint32_t node)
{
    return static_cast<std::size_t>(std::lower_bound(bv.node.begin(), bv.node.end(), node) - bv.node.begin());
}

// Of vertex k: written from the definition, d and all moments exactly.
inline ExactLifted lifted(const DeformableSurface& surface, const RestBv& bv, const RestMoments& rest, std::uint32_t k)
{
    Exact d[3], xi[3], m[3][3];
    for (int a = 0; a < 3; ++a)
        d[a] = Exact(surface.mesh.vertices[k][a]) - Exact(rest.centre[a]);
    const Weights::Row row = surface.weights.of(k);
    for (std::size_t i = 0; i < row.node.size(); ++i) {
        const std::size_t j = place_in(bv, row.node[i]);
        const Vec3& z = rest.influence[j].place;
        for (int a = 0; a < 3; ++a) {
            xi[a] = xi[a] + Exact(row.weight[i]) * Exact(z[a]);
            for (int b = 0; b < 3; ++b)
                m[a][b] = m[a][b] + Exact(row.weight[i]) * Exact(z[a]) * Exact(z[b]);
        }
    }
    const Exact per_unit(1 / rest.unit); // a power of two
    ExactLifted out{d[0], d[1], d[2], xi[0] - d[0] * per_unit, xi[1] - d[1] * per_unit, xi[2] - d[2] * per_unit};
    for (std::size_t s = 0; s < 3; ++s)
        for (std::size_t b = 0; b < 3; ++b)
            out[6 + 3 * s + b] = d[b] * xi[s] - half(Exact(rest.unit) * m[b][s]);
    return out;
}

// Any numbers: each of them up to one, or up to `only`.
inline MomentFit any_numbers(Random& random, double only)
{
    MomentFit fit;
    for (Vec3* vector : {&fit.linear, &fit.g, &fit.column[0], &fit.column[1], &fit.column[2]})
        for (double& x : *vector)
            x = uniform(random, random() % 4 == 0 ? 1 : only);
    return fit;
}

inline Exact times(const Lifted& functional, const ExactLifted& x)
{
    Exact sum(0);
    for (std::size_t c = 0; c < lifted_size; ++c)
        sum = sum + Exact(functional[c]) * x[c];
    return sum;
}

struct MomentScene {
    /// Coordinates times `scale` and linear parts of maps times `stretch`, powers of two.
    explicit MomentScene(std::size_t vertices, std::size_t nodes, std::size_t leaf, double scale = 1,
                         double stretch = 1)
        : e(scaled(test::example(vertices, nodes), scale, stretch)), bvh(build_bvh(e.surface, leaf)),
          data(rest_moments(bvh, e.surface))
    {
    }
    RestMoments moments(std::size_t bv) const { return data.of(bvh.bvs[bv], bv); }
    /// Proven 26-DOPs of all BVs, by the readable form.
    std::vector<double> bounds(std::span<const AffineMap> maps) const
    {
        std::vector<double> all(bvh.bvs.size() * 26);
        BoundScratch scratch;
        for (std::size_t bv = 0; bv < bvh.bvs.size(); ++bv)
            bound_moments(bvh.rest(bv), data.of(bvh.bvs[bv], bv), maps, Rounding::proven, axes_of(26), scratch,
                          std::span(all).subspan(bv * 26, 26));
        return all;
    }
    std::vector<std::uint32_t> vertices(std::size_t bv) const { return vertices_of(e.surface, bvh, bvh.bvs[bv]); }

    static test::Example scaled(test::Example e, double scale, double stretch)
    {
        for (auto* places : {&e.surface.mesh.vertices, &e.surface.place})
            for (Vec3& x : *places)
                x *= scale;
        for (auto& frame : e.frames)
            for (AffineMap& map : frame)
                for (auto& row : map.m)
                    for (std::size_t s = 0; s < 4; ++s)
                        row[s] *= s < 3 ? stretch : scale * stretch;
        return e;
    }

    test::Example e;
    Bvh bvh;
    MomentData data;
};

} // namespace cinch::exact
