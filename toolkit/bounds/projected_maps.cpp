// SPDX-License-Identifier: Apache-2.0
#include "toolkit/bounds/projected_maps.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "toolkit/bounds/kernel/project_kernel.hpp"

namespace cinch {
namespace {

// The median image of the rest origin over a sample of the nodes: a few of them do not move it.
Vec3 median_image(std::span<const AffineMap> maps, const RestExtent& rest)
{
    constexpr std::size_t sample = 16;
    const std::size_t step = (maps.size() + sample - 1) / sample;
    Vec3 median = Vec3::Zero();
    for (int r = 0; r < 3; ++r) {
        std::array<double, sample> image;
        auto end = image.begin();
        for (std::size_t j = 0; j < maps.size(); j += step) {
            const auto& m = maps[j].m[r];
            const double x = ((m[0] * rest.origin[0] + m[1] * rest.origin[1]) + m[2] * rest.origin[2]) + m[3];
            if (std::isfinite(x))
                *end++ = x;
        }
        if (end == image.begin())
            continue;
        const auto middle = image.begin() + (end - image.begin()) / 2;
        std::nth_element(image.begin(), middle, end);
        median[r] = *middle;
    }
    return median;
}

} // namespace

Vec3 on_grid(const Vec3& image, const RestExtent& rest)
{
    const double grid = std::exp2(std::ceil(std::log2(rest.about_origin.maxCoeff()))) * 4;
    Vec3 origin = Vec3::Zero();
    for (int r = 0; r < 3; ++r)
        if (const double cells = image[r] / grid; grid > 0 && std::isfinite(grid) && std::abs(cells) < 0x1p50)
            origin[r] = std::round(cells) * grid;
    return origin;
}

template <class T> void project(std::span<const AffineMap> maps, const RestExtent& rest, int kdop, Rounding rounding,
                                ProjectedMaps<T>& out, Octets octets)
{
    const auto axes = axes_of(kdop);
    const std::size_t record = 4 * projected_rows(axes.size());
    out.kdop = kdop;
    out.origin = maps.empty() ? Vec3::Zero() : on_grid(median_image(maps, rest), rest);
    out.value.resize(maps.size() * record);
    const ProjectionReport report =
        project_nodes(maps, rest, axes, rounding == Rounding::proven, out.origin, out.value.data());
    out.unbounded = report.unbounded;
    out.vertex_error = report.vertex_error;
    if (octets == Octets::wanted)
        to_octets<T>(out.value, record, out.octet);
    else
        out.octet.clear();
}

template void project(std::span<const AffineMap>, const RestExtent&, int, Rounding, ProjectedMaps<float>&, Octets);
template void project(std::span<const AffineMap>, const RestExtent&, int, Rounding, ProjectedMaps<double>&, Octets);

} // namespace cinch
