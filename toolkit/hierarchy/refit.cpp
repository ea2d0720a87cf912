// SPDX-License-Identifier: Apache-2.0
#include "toolkit/hierarchy/refit.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <stdexcept>

#include <tbb/enumerable_thread_specific.h>

#include "toolkit/bounds/bound_box.hpp"
#include "toolkit/bounds/bound_vertex.hpp"
#include "toolkit/bounds/rounding.hpp"
#include "toolkit/deform/arithmetic.hpp"
#include "toolkit/deform/parallel.hpp"
#include "toolkit/hierarchy/packed_bvh.hpp"
#include "toolkit/hierarchy/spheres.hpp"

namespace cinch {
namespace {

constexpr std::size_t block = 64; // BVs per task

// Lowers each support to the other where that is less.
void intersect(std::span<double> supports, std::span<const double> other)
{
    for (std::size_t i = 0; i < supports.size(); ++i)
        supports[i] = std::min(supports[i], other[i]);
}

// One method with kernels, in one arithmetic.
template <class T> struct KernelPart {
    PackedBvh<T> packed;
    ProjectedMaps<T> maps;
    std::vector<T> remembered;
    std::size_t bvs;
    tbb::enumerable_thread_specific<KernelScratch<T>> scratch;

    KernelPart(const Bvh& bvh, const DeformableSurface& surface, Method method, const RefitOptions& options)
        : packed(pack<T>(bvh, surface, choose_kinds(bvh, surface, method, options.rest_shape))), bvs(bvh.bvs.size())
    {
        if (options.remember)
            remembered.assign(packed.bvs.size() * static_cast<std::size_t>(options.kdop), std::numeric_limits<T>::quiet_NaN());
    }

    std::size_t bound(std::span<const AffineMap> frame, const RefitOptions& options, std::span<double> supports)
    {
        const auto k = static_cast<std::size_t>(options.kdop);
        project(frame, packed.rest, options.kdop, options.rounding, maps);
        const KernelInput<T> input{packed.bvs, packed.node, packed.value, &maps, options.rounding, options.passes,
                                   remembered.empty() ? nullptr : remembered.data()};
        parallel_blocks(bvs, block, [&](std::size_t first, std::size_t last) {
            double own[block * 26];
            for (; first < last; first += block) {
                const std::size_t end = std::min(last, first + block);
                const std::span<double> bounds = std::span(own).first((end - first) * k);
                bound_packed<T>(input, first, end, scratch.local(), bounds);
                intersect(supports.subspan(first * k, bounds.size()), bounds);
            }
        });
        return maps.unbounded;
    }
};

void bound_from_vertices(const Bvh& bvh, const DeformableSurface& surface, std::span<const AffineMap> maps, const RefitOptions& options,
                         std::span<double> supports)
{
    const auto k = static_cast<std::size_t>(options.kdop);
    const auto& mesh = surface.mesh;
    std::vector<double> vertex(mesh.vertices.size() * k);
    parallel_blocks(mesh.vertices.size(), 512, [&](std::size_t first, std::size_t last) {
        for (std::size_t v = first; v < last; ++v)
            bound_vertex(mesh.vertices[v], surface.weights.of(v), maps, options.rounding, axes_of(options.kdop),
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
    intersect(supports, bounds);
}

} // namespace

struct Refitter::Parts {
    const Bvh& bvh;
    const DeformableSurface& surface;
    RefitOptions options;
    std::vector<std::unique_ptr<KernelPart<float>>> single;
    std::vector<std::unique_ptr<KernelPart<double>>> twice;
    std::optional<RestSpheres> spheres;
    tbb::enumerable_thread_specific<BoundScratch> scratch;
};

Refitter::Refitter(const Bvh& bvh, const DeformableSurface& surface, const RefitOptions& options)
    : parts_(new Parts{bvh, surface, options, {}, {}, {}, {}})
{
    if (!is_kdop(options.kdop))
        throw std::invalid_argument("refit: k must be 6, 14, 18 or 26");
    require_default_arithmetic();
    for (const Method method : {Method::convex, Method::eq12, Method::limited, Method::local, Method::support, Method::linear, Method::best}) {
        if (!options.methods.contains(method))
            continue;
        if (options.precision == Precision::float32)
            parts_->single.push_back(std::make_unique<KernelPart<float>>(bvh, surface, method, options));
        else
            parts_->twice.push_back(std::make_unique<KernelPart<double>>(bvh, surface, method, options));
    }
    if (options.methods.contains(Method::sphere))
        parts_->spheres = rest_spheres(bvh, surface);
}

Refitter::~Refitter() = default;
Refitter::Refitter(Refitter&&) noexcept = default;

std::size_t Refitter::bytes() const
{
    std::size_t bytes = 0;
    for (const auto& part : parts_->single)
        bytes += part->packed.bytes();
    for (const auto& part : parts_->twice)
        bytes += part->packed.bytes();
    return bytes;
}

RefitReport Refitter::operator()(std::span<const AffineMap> maps, std::span<double> supports)
{
    Parts& p = *parts_;
    const auto k = static_cast<std::size_t>(p.options.kdop);
    if (maps.size() != p.surface.weights.node_count)
        throw std::invalid_argument("refit: one transform per simulation node is needed");
    if (supports.size() != p.bvh.bvs.size() * k)
        throw std::invalid_argument("refit: supports needs k places per BV");
    require_default_arithmetic();

    RefitReport report;
    std::fill(supports.begin(), supports.end(), infinite);
    for (auto& part : p.single)
        report.unbounded_nodes = std::max(report.unbounded_nodes, part->bound(maps, p.options, supports));
    for (auto& part : p.twice)
        report.unbounded_nodes = std::max(report.unbounded_nodes, part->bound(maps, p.options, supports));
    auto each_bv = [&](auto&& bound) { // by a function of one BV
        parallel_blocks(p.bvh.bvs.size(), block, [&](std::size_t first, std::size_t last) {
            double own[26];
            for (std::size_t i = first; i < last; ++i) {
                bound(i, std::span(own).first(k));
                intersect(supports.subspan(i * k, k), std::span(own).first(k));
            }
        });
    };
    const auto axes = axes_of(p.options.kdop);
    if (p.options.methods.contains(Method::corners))
        each_bv([&](std::size_t i, std::span<double> out) {
            bound_box(p.bvh.rest(i), maps, Method::corners, p.options.rounding, axes, p.scratch.local(), out);
        });
    if (p.spheres)
        each_bv([&](std::size_t i, std::span<double> out) {
            const Bv& bv = p.bvh.bvs[i];
            bound_sphere(p.spheres->of(bv, i), p.spheres->place, maps, bv.vertex_influences, p.options.rounding, axes, out);
        });
    if (p.options.methods.contains(Method::vertices))
        bound_from_vertices(p.bvh, p.surface, maps, p.options, supports);
    report.infinite = static_cast<std::size_t>(std::count(supports.begin(), supports.end(), infinite));
    return report;
}

RefitReport refit(const Bvh& bvh, const DeformableSurface& surface, std::span<const AffineMap> maps, const RefitOptions& options,
                  std::span<double> supports)
{
    return Refitter(bvh, surface, options)(maps, supports);
}

} // namespace cinch
