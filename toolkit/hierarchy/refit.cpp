// SPDX-License-Identifier: Apache-2.0
#include "cinch/refit.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "cinch/bounds.hpp"
#include "cinch/deform.hpp"
#include "cinch/environment.hpp"
#include "toolkit/bounds/bound_vertex.hpp"
#include "toolkit/bounds/rounding.hpp"
#include "toolkit/deform/parallel.hpp"
#include "toolkit/hierarchy/bounder.hpp"
#include "toolkit/hierarchy/morph_boxes.hpp"

namespace cinch {
namespace {

constexpr std::size_t block = 64; // BVs per task

void bound_from_vertices(const Bvh& bvh, const DeformableSurface& surface, std::span<const Vec3> rest,
                         std::span<const AffineMap> maps, const RefitOptions& options, std::span<double> supports)
{
    const auto k = static_cast<std::size_t>(options.kdop);
    const auto& mesh = surface.mesh;
    std::vector<double> vertex(rest.size() * k);
    parallel_blocks(rest.size(), 512, [&](std::size_t first, std::size_t last) {
        for (std::size_t v = first; v < last; ++v)
            bound_vertex(rest[v], surface.weights.of(v), maps, options.rounding, axes_of(options.kdop),
                         std::span(vertex).subspan(v * k, k));
    });
    std::vector<double> bounds(supports.size(), -infinite);
    for (std::size_t i = bvh.bvs.size(); i-- > 0;) { // children before parents
        const Bv& bv = bvh.bvs[i];
        auto include = [&](const double* other) {
            for (std::size_t d = 0; d < k; ++d)
                bounds[i * k + d] = std::max(bounds[i * k + d], other[d]);
        };
        if (bv.is_leaf()) {
            for (std::uint32_t t = 0; t < bv.triangle_count; ++t)
                for (std::uint32_t v : mesh.triangles[bvh.triangle[bv.first_triangle + t]])
                    include(&vertex[v * k]);
        } else {
            include(&bounds[bv.first_child * k]);
            include(&bounds[(bv.first_child + 1) * k]);
        }
    }
    for (std::size_t i = 0; i < supports.size(); ++i)
        supports[i] = std::min(supports[i], bounds[i]);
}

} // namespace

struct Refitter::Parts {
    const Bvh& bvh;
    const DeformableSurface& surface;
    RefitOptions options;
    std::optional<Bounder> bounder; // none for the vertices alone
    std::span<const MorphTarget> targets;
    MorphBoxes morphs;
    double farthest; // of rest coordinates

    RefitReport refit(std::span<const AffineMap> maps, std::span<const double> weights, std::span<double> supports);
};

Refitter::Refitter(const Bvh& bvh, const DeformableSurface& surface, const RefitOptions& options,
                   std::span<const MorphTarget> targets)
    : parts_(new Parts{bvh, surface, options, {}, targets, MorphBoxes(bvh, surface, targets), 0})
{
    for (const Vec3& v : surface.mesh.vertices)
        parts_->farthest = std::max(parts_->farthest, v.cwiseAbs().maxCoeff());
    if (!is_kdop(options.kdop))
        throw std::invalid_argument("k must be " + kdop_names());
    require_default_arithmetic();
    if (options.methods.contains(Method::vertices) &&
        std::any_of(targets.begin(), targets.end(), [](const MorphTarget& target) { return !target.half.empty(); }))
        throw std::invalid_argument("refit: by its vertices no surface is bounded whose displacements are boxes");
    if (options.methods == Method::vertices)
        return;
    RefitOptions others = options;
    others.methods = options.methods.without(Method::vertices); // which come from the leaves upward
    parts_->bounder.emplace(bvh, surface, others, Bounder::Leaves::included);
}

Refitter::~Refitter() = default;
Refitter::Refitter(Refitter&&) noexcept = default;

std::size_t Refitter::bytes() const { return parts_->bounder ? parts_->bounder->bytes() : 0; }

RefitReport Refitter::operator()(std::span<const AffineMap> maps, std::span<double> supports)
{
    return parts_->refit(maps, {}, supports);
}

RefitReport Refitter::operator()(std::span<const AffineMap> maps, std::span<const double> weights,
                                 std::span<double> supports)
{
    if (!weights.empty() && weights.size() != parts_->targets.size())
        throw std::invalid_argument("refit: one weight per morph target is needed, or none");
    return parts_->refit(maps, weights, supports);
}

RefitReport Refitter::Parts::refit(std::span<const AffineMap> maps, std::span<const double> weights,
                                   std::span<double> supports)
{
    const auto k = static_cast<std::size_t>(options.kdop);
    if (maps.size() != surface.weights.node_count)
        throw std::invalid_argument("refit: one transform per simulation node is needed");
    if (supports.size() != bvh.bvs.size() * k)
        throw std::invalid_argument("refit: supports needs k places per BV");
    require_default_arithmetic();

    RefitReport report;
    if (bounder) {
        report.unbounded_nodes = bounder->begin(maps);
        parallel_blocks(bvh.bvs.size(), block, [&](std::size_t first, std::size_t last) {
            bounder->bound(first, last, supports.subspan(first * k, (last - first) * k));
        });
    } else {
        std::fill(supports.begin(), supports.end(), infinite);
        report.unbounded_nodes = static_cast<std::size_t>(
            std::count_if(maps.begin(), maps.end(), [](const AffineMap& map) { return !is_finite(map); }));
    }
    const MorphBoxes::Term term{weights, maps};
    if (!weights.empty())
        morphs.add({&term, 1}, options.kdop, supports);
    if (options.methods.contains(Method::vertices)) {
        std::vector<Vec3> displaced;
        if (!weights.empty()) {
            displaced = surface.mesh.vertices;
            displace(targets, weights, displaced);
        }
        bound_from_vertices(bvh, surface, weights.empty() ? surface.mesh.vertices : displaced, maps, options, supports);
    }
    if (!weights.empty() && options.rounding == Rounding::proven)
        morphs.add_error(term, farthest, options.kdop, supports);
    report.infinite = static_cast<std::size_t>(std::count(supports.begin(), supports.end(), infinite));
    return report;
}

RefitReport refit(const Bvh& bvh, const DeformableSurface& surface, std::span<const AffineMap> maps,
                  const RefitOptions& options, std::span<double> supports)
{
    return Refitter(bvh, surface, options)(maps, supports);
}

} // namespace cinch
