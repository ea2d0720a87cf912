// SPDX-License-Identifier: Apache-2.0
#include "toolkit/hierarchy/packed_bvh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace cinch {
namespace {

// On a grid so coarse that it is (0, 0, 0) unless the surface lies far from there.
Vec3 rest_origin(const RestBox& root)
{
    const double grid = std::exp2(std::ceil(std::log2(root.half.maxCoeff()))) * 4;
    Vec3 origin = Vec3::Zero();
    for (int s = 0; s < 3; ++s)
        if (grid > 0 && std::isfinite(grid) && std::abs(root.centre[s] / grid) < 0x1p50)
            origin[s] = std::round(root.centre[s] / grid) * grid;
    return origin;
}

} // namespace

RestExtent rest_extent(const Bvh& bvh, const DeformableSurface& surface, RestShape shape)
{
    RestExtent rest;
    if (bvh.bvs.empty())
        return rest;
    rest.origin = rest_origin(bvh.bvs[0].box);
    for (const Bv& bv : bvh.bvs) {
        // Room for rounding to float and for local boxes, which may reach past the BV's by their own; pivots lie
        // inside.
        rest.about_origin =
            rest.about_origin.cwiseMax(((bv.box.centre - rest.origin).cwiseAbs() + bv.box.half) * (1 + 0x1p-20));
        if (shape == RestShape::obb)
            rest.about_origin = rest.about_origin.cwiseMax(
                ((bv.oriented.centre - rest.origin).cwiseAbs() + bv.oriented.axis[0].cwiseAbs() +
                 bv.oriented.axis[1].cwiseAbs() + bv.oriented.axis[2].cwiseAbs()) *
                (1 + 0x1p-18));
        rest.influences = std::max(rest.influences, static_cast<double>(bv.vertex_influences));
    }
    for (const Vec3& x : surface.mesh.vertices)
        rest.absolute = rest.absolute.cwiseMax(x.cwiseAbs());
    return rest;
}

template <class T>
PackedBvh<T> pack(const Bvh& bvh, const DeformableSurface& surface, const ChosenKinds& chosen, bool leaves)
{
    const std::vector<ChosenKind>& kinds = chosen.of;
    PackedBvh<T> out;
    out.rest = rest_extent(bvh, surface, !kinds.empty() && kinds[0].oriented ? RestShape::obb : RestShape::aabb);
    const std::vector<Vec3>& x = surface.mesh.vertices;
    if (!leaves)
        out.place.assign(bvh.bvs.size(), 0);
    auto wanted = [&](std::size_t i) { return leaves || !bvh.bvs[i].is_leaf(); };
    const auto put = [&](std::size_t i, Method kind, double start, bool oriented, bool guarded) {
        const auto place = static_cast<std::uint32_t>(out.bvs.size());
        const RestMoments moments = kind == Method::moments ? chosen.moments.of(bvh.bvs[i], i) : RestMoments{};
        pack_bv<T>(bvh.rest(i), x, out.rest,
                   {kind, start, oriented ? &bvh.bvs[i].oriented : nullptr, guarded, &moments}, out);
        return place;
    };
    for (std::size_t i = 0; i < bvh.bvs.size(); ++i)
        if (wanted(i)) {
            const ChosenKind& own = kinds[i];
            const std::uint32_t place =
                put(i, own.kind, own.start, own.oriented, own.guarded && own.kind == Method::local);
            if (!leaves)
                out.place[i] = place;
        }
    const auto packed = [&](std::size_t i) -> PackedBv<T>& { return out.bvs[leaves ? i : out.place[i]]; };
    for (std::size_t i = 0; i < bvh.bvs.size(); ++i)
        if (kinds[i].also && wanted(i)) {
            const std::uint32_t place =
                put(i, *kinds[i].also, kinds[i].also_start, false, kinds[i].guarded && *kinds[i].also == Method::local);
            packed(i).also = place;
        }
    for (std::size_t i = 0; i < bvh.bvs.size(); ++i)
        if (kinds[i].guarded && kinds[i].kind != Method::local && kinds[i].also != Method::local && wanted(i)) {
            const std::uint32_t place = put(i, Method::eq12, 0, false, false);
            packed(i).guard = place;
        }
    out.bvs.shrink_to_fit();
    out.node.shrink_to_fit();
    out.value.shrink_to_fit();
    return out;
}

template PackedBvh<float> pack(const Bvh&, const DeformableSurface&, const ChosenKinds&, bool);
template PackedBvh<double> pack(const Bvh&, const DeformableSurface&, const ChosenKinds&, bool);

} // namespace cinch
