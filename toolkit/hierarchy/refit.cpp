// SPDX-License-Identifier: Apache-2.0
#include "toolkit/hierarchy/refit.hpp"

#include <algorithm>
#include <stdexcept>

#include <tbb/enumerable_thread_specific.h>

#include "toolkit/bounds/bound_vertex.hpp"
#include "toolkit/bounds/rounding.hpp"
#include "toolkit/deform/arithmetic.hpp"
#include "toolkit/deform/parallel.hpp"

namespace cinch {
namespace {

void refit_from_vertices(const Bvh& bvh, const DeformableSurface& surface, std::span<const AffineMap> maps,
                         const RefitOptions& options, std::span<double> supports)
{
    const auto k = static_cast<std::size_t>(options.kdop);
    const auto& mesh = surface.mesh;
    std::vector<double> vertex(mesh.vertices.size() * k);
    parallel_blocks(mesh.vertices.size(), 512, [&](std::size_t first, std::size_t last) {
        for (std::size_t v = first; v < last; ++v)
            bound_vertex(mesh.vertices[v], surface.weights.of(v), maps, options.rounding, axes_of(options.kdop),
                         std::span(vertex).subspan(v * k, k));
    });
    for (std::size_t i = bvh.bvs.size(); i-- > 0;) { // children before parents
        const Bv& bv = bvh.bvs[i];
        const auto out = supports.subspan(i * k, k);
        std::fill(out.begin(), out.end(), -infinite);
        auto include = [&](const double* other) {
            for (std::size_t d = 0; d < k; ++d)
                out[d] = std::max(out[d], other[d]);
        };
        if (bv.is_leaf()) {
            for (std::uint32_t t = 0; t < bv.triangle_count; ++t)
                for (std::uint32_t v : mesh.triangles[bvh.triangle[bv.first_triangle + t]])
                    include(&vertex[v * k]);
        } else {
            include(&supports[bv.first_child * k]);
            include(&supports[(bv.first_child + 1) * k]);
        }
    }
}

} // namespace

void refit(const Bvh& bvh, const DeformableSurface& surface, std::span<const AffineMap> maps, const RefitOptions& options,
           std::span<double> supports)
{
    if (!is_kdop(options.kdop))
        throw std::invalid_argument("refit: k must be 6, 14, 18 or 26");
    if (maps.size() != surface.weights.node_count)
        throw std::invalid_argument("refit: one transform per simulation node is needed");
    const auto k = static_cast<std::size_t>(options.kdop);
    if (supports.size() != bvh.bvs.size() * k)
        throw std::invalid_argument("refit: supports needs k places per BV");
    require_default_arithmetic();

    if (options.method == Method::vertices)
        return refit_from_vertices(bvh, surface, maps, options, supports);
    tbb::enumerable_thread_specific<BoundScratch> scratch;
    parallel_blocks(bvh.bvs.size(), 64, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
            bound_box(bvh.rest(i), maps, options.method, options.rounding, axes_of(options.kdop), scratch.local(), supports.subspan(i * k, k));
    });
}

} // namespace cinch
