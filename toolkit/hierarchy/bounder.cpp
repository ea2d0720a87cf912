// SPDX-License-Identifier: Apache-2.0
#include "toolkit/hierarchy/bounder.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <stdexcept>

#include <hwy/cache_control.h>

#include "cinch/bounds.hpp"
#include "cinch/environment.hpp"
#include "toolkit/bounds/bound_box.hpp"
#include "toolkit/bounds/bound_vertex.hpp"
#include "toolkit/bounds/rounding.hpp"
#include "toolkit/deform/per_thread.hpp"
#include "toolkit/hierarchy/dop.hpp"
#include "toolkit/hierarchy/packed_bvh.hpp"
#include "toolkit/hierarchy/spheres.hpp"

namespace cinch {
namespace {

// Lowers each support to the other where that is less.
template <class T> void intersect(std::span<T> supports, std::span<const T> other)
{
    for (std::size_t i = 0; i < supports.size(); ++i)
        supports[i] = std::min(supports[i], other[i]);
}

// One method with kernels, in one arithmetic.
template <class T> struct KernelPart {
    PackedBvh<T> packed;
    mutable std::vector<T> remembered; // each BV's own places
    mutable PerThread<KernelScratch<T>> scratch;

    KernelPart(const Bvh& bvh, const DeformableSurface& surface, Method method, const RefitOptions& options,
               Bounder::Leaves leaves)
        : packed(pack<T>(bvh, surface,
                         choose_kinds(bvh, surface, method, options.rest_shape,
                                      leaves == Bounder::Leaves::included ? for_refits : for_queries),
                         leaves == Bounder::Leaves::included))
    {
        if (options.remember)
            remembered.assign(2 * packed.bvs.size() * static_cast<std::size_t>(options.kdop),
                              std::numeric_limits<T>::quiet_NaN());
    }
    KernelInput<T> input(const ProjectedMaps<T>& maps, const RefitOptions& options) const
    {
        return {packed.bvs,
                packed.node,
                packed.value,
                &maps,
                options.rounding,
                options.passes,
                packed.place.empty() ? nullptr : packed.place.data(),
                remembered.empty() ? nullptr : remembered.data()};
    }
};

template <class T> using KernelParts = std::vector<std::unique_ptr<KernelPart<T>>>;

// What is asked for, or doubles where a BV has too many simulation nodes for float.
Precision precision_for(const Bvh& bvh, Precision wanted)
{
    const bool fits = std::all_of(bvh.bvs.begin(), bvh.bvs.end(),
                                  [](const Bv& bv) { return bv.influence_count <= most_nodes_in_float; });
    return fits ? wanted : Precision::float64;
}

} // namespace

struct Bounder::Parts {
    const Bvh& bvh;
    const DeformableSurface& surface;
    RefitOptions options;
    RestExtent rest;
    Octets octets;
    ProjectedMaps<float> single_maps{};
    ProjectedMaps<double> double_maps{};
    KernelParts<float> single{};
    KernelParts<double> twice{};
    std::optional<RestSpheres> spheres{};
    std::span<const AffineMap> maps{};
    mutable PerThread<BoundScratch> scratch{};

    std::size_t k() const { return static_cast<std::size_t>(options.kdop); }

    // By the methods without kernels, intersected with what is in `supports`.
    void bound_otherwise(std::size_t bv, std::span<double> supports) const
    {
        const auto axes = axes_of(options.kdop);
        double other[most_directions];
        const auto own = std::span(other).first(k());
        if (options.methods.contains(Method::corners)) {
            bound_box(bvh.rest(bv), maps, Method::corners, options.rounding, axes, scratch.local(), own);
            intersect<double>(supports, own);
        }
        if (spheres) {
            bound_sphere(spheres->of(bvh.bvs[bv], bv), spheres->place, maps, bvh.bvs[bv].vertex_influences,
                         options.rounding, axes, own);
            intersect<double>(supports, own);
        }
        if (options.methods.contains(Method::vertices)) {
            double most[most_directions];
            std::fill_n(most, k(), -infinite);
            for (const std::uint32_t v : vertices_of(surface, bvh, bvh.bvs[bv])) {
                bound_vertex(surface.mesh.vertices[v], surface.weights.of(v), maps, options.rounding, axes, own);
                for (std::size_t d = 0; d < k(); ++d)
                    most[d] = std::max(most[d], own[d]);
            }
            intersect<double>(supports, std::span(most).first(k()));
        }
    }
    bool has_others() const
    {
        return spheres || options.methods.contains(Method::corners) || options.methods.contains(Method::vertices);
    }
};

Bounder::Bounder(const Bvh& bvh, const DeformableSurface& surface, const RefitOptions& options, Leaves leaves)
    : parts_(new Parts{bvh, surface, options, rest_extent(bvh, surface, options.rest_shape),
                       leaves == Leaves::included ? Octets::wanted : Octets::left_out})
{
    if (!is_kdop(options.kdop))
        throw std::invalid_argument("k must be " + kdop_names());
    require_default_arithmetic();
    if ((bvh.detail == RestDetail::boxes && need(options.methods, RestNeed::local)) ||
        (bvh.detail == RestDetail::inner && need(options.methods, RestNeed::points) && leaves == Leaves::included))
        throw std::invalid_argument(
            "refit: the BVH was built without the rest data that these methods need (RestDetail)");
    const Precision precision = precision_for(bvh, options.precision);
    for (const Method method : kernel_methods) {
        if (!options.methods.contains(method))
            continue;
        if (precision == Precision::float32)
            parts_->single.push_back(std::make_unique<KernelPart<float>>(bvh, surface, method, options, leaves));
        else
            parts_->twice.push_back(std::make_unique<KernelPart<double>>(bvh, surface, method, options, leaves));
    }
    if (options.methods.contains(Method::sphere))
        parts_->spheres = rest_spheres(bvh, surface);
}

Bounder::~Bounder() = default;
Bounder::Bounder(Bounder&&) noexcept = default;

const ProjectedMaps<float>& Bounder::maps() const { return parts_->single_maps; }
const RestExtent& Bounder::rest() const { return parts_->rest; }

std::size_t Bounder::bytes() const
{
    std::size_t bytes = 0;
    for (const auto& part : parts_->single)
        bytes += part->packed.bytes();
    for (const auto& part : parts_->twice)
        bytes += part->packed.bytes();
    return bytes;
}

std::size_t Bounder::begin(std::span<const AffineMap> maps)
{
    Parts& p = *parts_;
    if (maps.size() != p.surface.weights.node_count)
        throw std::invalid_argument("refit: one transform per simulation node is needed");
    require_default_arithmetic();
    p.maps = maps;
    project(maps, p.rest, p.options.kdop, p.options.rounding, p.single_maps, p.octets);
    if (p.twice.empty())
        return p.single_maps.unbounded;
    project(maps, p.rest, p.options.kdop, p.options.rounding, p.double_maps, p.octets);
    return p.double_maps.unbounded;
}

void Bounder::bound(std::size_t first, std::size_t last, std::span<double> supports) const
{
    const Parts& p = *parts_;
    const std::size_t k = p.k();
    std::fill(supports.begin(), supports.end(), infinite);
    constexpr std::size_t block = 64;
    double own[block * most_directions];
    auto by_kernels = [&](const auto& parts, const auto& maps) {
        for (const auto& part : parts) {
            const auto& place = part->packed.place; // without leaves a BV does not stand where it does in the tree
            const std::size_t at_once = place.empty() ? block : 1;
            for (std::size_t i = first; i < last; i += at_once) {
                const std::size_t count = std::min(last - i, at_once), at = place.empty() ? i : place[i];
                const std::span<double> bounds = std::span(own).first(count * k);
                bound_packed(part->input(maps, p.options), at, at + count, part->scratch.local(), bounds);
                intersect<double>(supports.subspan((i - first) * k, bounds.size()), bounds);
            }
        }
    };
    by_kernels(p.single, p.single_maps);
    by_kernels(p.twice, p.double_maps);
    if (p.has_others())
        for (std::size_t i = first; i < last; ++i)
            p.bound_otherwise(i, supports.subspan((i - first) * k, k));
}

void Bounder::prefetch(std::uint32_t bv) const
{
    for (const auto& part : parts_->single) {
        const auto& packed = part->packed.bvs[part->packed.place.empty() ? bv : part->packed.place[bv]];
        for (std::size_t byte = 0; byte < sizeof packed; byte += 64)
            hwy::Prefetch(reinterpret_cast<const char*>(&packed) + byte);
    }
}

void Bounder::bound(std::span<const std::uint32_t> list, float* dops) const
{
    const Parts& p = *parts_;
    const std::size_t side = dop_side(p.options.kdop);
    if (p.single.size() == 1 && p.twice.empty() && !p.has_others())
        return bound_packed(p.single[0]->input(p.single_maps, p.options), list, p.single[0]->scratch.local(), side,
                            dops);
    if (p.twice.size() == 1 && p.single.empty() && !p.has_others())
        return bound_packed(p.twice[0]->input(p.double_maps, p.options), list, p.twice[0]->scratch.local(), side, dops);
    // Several at once, or what has no kernel: in the world, and from there to the origin, rounded up at every step.
    const auto axes = axes_of(p.options.kdop);
    for (const std::uint32_t bv : list) {
        double supports[most_directions];
        bound(bv, bv + 1, std::span(supports).first(p.k()));
        for (std::size_t d = 0; d < p.k(); ++d) {
            double sum = supports[d];
            for (std::size_t r = 0; r < 3; ++r)
                if (const int sign = d % 2 == 0 ? axes[d / 2][r] : -axes[d / 2][r];
                    sign != 0 && p.single_maps.origin[static_cast<int>(r)] != 0)
                    sum = succ(sum - sign * p.single_maps.origin[static_cast<int>(r)]);
            const float support = succ(static_cast<float>(sum));
            dops[bv * 2 * side + (d % 2) * side + d / 2] =
                support < std::numeric_limits<float>::infinity() ? support : std::numeric_limits<float>::infinity();
        }
    }
}

} // namespace cinch
