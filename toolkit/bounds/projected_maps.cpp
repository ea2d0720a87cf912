// SPDX-License-Identifier: Apache-2.0
#include "toolkit/bounds/projected_maps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "toolkit/bounds/directions.hpp"
#include "toolkit/bounds/rounding.hpp"

namespace cinch {
namespace {

// A row of A, and d = A·o + t − O. The compensated sum [Ogita, Rump, Oishi 2005, Dot2] is within u|d| + 2^-98·(Σ|A o| + |t| + |O|).
struct Row {
    double a[3], d, lost;
};

Row shifted_row(const double (&m)[4], const Vec3& rest_origin, double origin)
{
    Row row{{m[0], m[1], m[2]}, m[3], 0};
    double compensation = 0, magnitude = std::abs(m[3]) + std::abs(origin);
    auto add = [&](double x) { // TwoSum
        const double sum = row.d + x, part = sum - row.d;
        compensation += (row.d - (sum - part)) + (x - part);
        row.d = sum;
    };
    add(-origin);
    for (int s = 0; s < 3; ++s) {
        const double product = m[s] * rest_origin[s];
        add(product);
        compensation += std::fma(m[s], rest_origin[s], -product);
        magnitude += std::abs(product);
    }
    row.d += compensation;
    row.lost = magnitude * 0x1p-98;
    return row;
}

// The median image of the rest origin, on a grid so coarse that a few nodes do not move it, and (0, 0, 0) where it is near.
Vec3 body_origin(std::span<const AffineMap> maps, const RestExtent& rest)
{
    const double grid = std::exp2(std::ceil(std::log2(rest.about_origin.maxCoeff()))) * 4;
    Vec3 origin = Vec3::Zero();
    if (!(grid > 0) || !std::isfinite(grid))
        return origin;
    std::vector<double> image;
    for (int r = 0; r < 3; ++r) {
        image.clear();
        for (const AffineMap& map : maps) {
            const auto& m = map.m[r];
            const double x = ((m[0] * rest.origin[0] + m[1] * rest.origin[1]) + m[2] * rest.origin[2]) + m[3];
            if (std::isfinite(x))
                image.push_back(x);
        }
        if (image.empty())
            continue;
        const auto middle = image.begin() + static_cast<std::ptrdiff_t>(image.size() / 2);
        std::nth_element(image.begin(), middle, image.end());
        const double cells = *middle / grid;
        if (std::abs(cells) < 0x1p50)
            origin[r] = std::round(cells) * grid;
    }
    return origin;
}

double safe_norm(double x, double y, double z) // squares neither overflow nor vanish
{
    const double most = std::max({std::abs(x), std::abs(y), std::abs(z)});
    if (!(most > 0x1p-500 && most < 0x1p500))
        return std::abs(x) + std::abs(y) + std::abs(z);
    return std::sqrt(x * x + y * y + z * z);
}

template <class T> T rounded_up(double x)
{
    const T t = static_cast<T>(x);
    return static_cast<double>(t) >= x ? t : std::nextafter(t, std::numeric_limits<T>::infinity());
}

} // namespace

template <class T>
void project(std::span<const AffineMap> maps, const RestExtent& rest, int kdop, Rounding rounding, ProjectedMaps<T>& out)
{
    const auto axes = axes_of(kdop);
    const std::size_t record = 4 * projected_rows(axes.size());
    out.kdop = kdop;
    out.unbounded = 0;
    out.vertex_error = 0;
    out.origin = maps.empty() ? Vec3::Zero() : body_origin(maps, rest);
    out.value.assign(maps.size() * record, 0);
    for (std::size_t j = 0; j < maps.size(); ++j) {
        const Row rows[3] = {shifted_row(maps[j].m[0], rest.origin, out.origin[0]), shifted_row(maps[j].m[1], rest.origin, out.origin[1]),
                             shifted_row(maps[j].m[2], rest.origin, out.origin[2])};
        T* const q = out.value.data() + j * record;
        double error = 0, vertex_error = 0;
        bool bounded = rest.about_origin.maxCoeff() <= static_cast<double>(magnitude_limit<T>); // else rest data may overflow T
        for (std::size_t a = 0; a < axes.size(); ++a) {
            double along[4] = {0, 0, 0, 0}, magnitude[4] = {0, 0, 0, 0}, lost = 0, world = 0;
            for (std::size_t r = 0; r < 3; ++r) {
                if (axes[a][r] == 0)
                    continue;
                for (std::size_t s = 0; s < 3; ++s) {
                    along[s] += axes[a][r] * rows[r].a[s];
                    magnitude[s] += std::abs(rows[r].a[s]);
                }
                along[3] += axes[a][r] * rows[r].d;
                magnitude[3] += std::abs(rows[r].d);
                lost += rows[r].lost;
                world += std::abs(maps[j].m[r][3]);
            }
            double about = magnitude[3];
            for (std::size_t s = 0; s < 3; ++s) {
                about += magnitude[s] * rest.about_origin[static_cast<int>(s)];
                world += magnitude[s] * rest.absolute[static_cast<int>(s)];
            }
            for (std::size_t s = 0; s < 4; ++s)
                q[4 * a + s] = static_cast<T>(along[s]);
            // Of q as stored: 3 products, 2 sums and a root, 4 roundings and half of one.
            const double x = static_cast<double>(q[4 * a]), y = static_cast<double>(q[4 * a + 1]), z = static_cast<double>(q[4 * a + 2]);
            q[4 * axes.size() + a] = rounded_up<T>(safe_norm(x, y, z) * (1 + 8 * unit_roundoff));
            bounded &= about <= static_cast<double>(magnitude_limit<T>); // false for NaN
            for (double component : along) // whatever it meets may be 0, which would hide it from `about`
                bounded &= std::abs(component) <= static_cast<double>(magnitude_limit<T>);
            error = std::max(error, node_error<T>(about, rest.about_origin.sum(), lost) + evaluation_error(rest.influences, world));
            vertex_error = std::max(vertex_error, succ(4 * lost + evaluation_error(rest.influences, world)));
        }
        T& charge = q[record - 1];
        charge = rounding == Rounding::proven ? rounded_up<T>(succ(error)) : T(0);
        if (!bounded || !(charge < std::numeric_limits<T>::infinity())) {
            std::fill_n(q, record, T(0));
            charge = std::numeric_limits<T>::infinity();
            ++out.unbounded;
        } else {
            out.vertex_error = std::max(out.vertex_error, vertex_error);
        }
    }
    out.octet.assign((maps.size() + 7) / 8 * 8 * record, T(0));
    for (std::size_t j = 0; j < maps.size(); ++j)
        for (std::size_t p = 0; p < record; ++p)
            out.octet[(j / 8 * record + p) * 8 + j % 8] = out.value[j * record + p];
}

template void project(std::span<const AffineMap>, const RestExtent&, int, Rounding, ProjectedMaps<float>&);
template void project(std::span<const AffineMap>, const RestExtent&, int, Rounding, ProjectedMaps<double>&);

} // namespace cinch
