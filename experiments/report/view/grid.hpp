// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "cinch/bounds.hpp"
#include "toolkit/surface/triangle_mesh.hpp"

namespace cinch {

/// The grid of a view: integer coordinates g stand for the point (g + origin)·step. Step is a power of two, so that v /
/// step is exact (but for overflow and underflow, from which make() stays away) and all rounding is the one to whole
/// numbers.
class Grid {
public:
    /// The finest one whose coordinates of all points in [low, high] are in [0, 2^bits). The points are finite.
    static Grid make(const Vec3& low, const Vec3& high, int bits)
    {
        Grid g;
        const double extent = std::max((high - low).maxCoeff(), 1e-300),
                     most = std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff());
        int exponent = std::ilogb(extent) - bits;
        exponent = std::max(exponent, std::ilogb(std::max(most, 1e-300)) - 52); // coordinates that long long holds
        for (;; ++exponent) {
            g.step = std::ldexp(1.0, exponent);
            bool fits = true;
            for (int r = 0; r < 3; ++r) {
                g.origin[static_cast<std::size_t>(r)] = std::llround(low[r] / g.step);
                fits &= std::llround(high[r] / g.step) - g.origin[static_cast<std::size_t>(r)] < (1 << bits);
            }
            if (fits)
                return g;
        }
    }

    std::array<std::int32_t, 3> point(const Vec3& v) const
    {
        std::array<std::int32_t, 3> out{};
        for (std::size_t r = 0; r < 3; ++r)
            out[r] = static_cast<std::int32_t>(std::llround(v[static_cast<int>(r)] / step) - origin[r]);
        return out;
    }

    /// A whole number that axis·point(v) does not exceed for any v with axis·v ≤ support, or `unbounded`.
    ///
    /// Rounding moves each coordinate by 1/2 at most, so axis·(point(v) + origin) ≤ ⌈support / step⌉ + |axis|₁ / 2.
    /// Being whole it is ≤ ⌈support / step⌉ + ⌊|axis|₁ / 2⌋; one coordinate alone (|axis|₁ = 1) is rounded
    /// monotonically.
    std::int32_t support(const Axis& axis, bool against, double value) const
    {
        const double above = std::ceil(value / step);
        if (!(std::abs(above) < 0x1p62))
            return unbounded;
        long long shift = 0, length = 0;
        for (std::size_t r = 0; r < 3; ++r) {
            shift += (against ? -axis[r] : axis[r]) * origin[r];
            length += std::abs(axis[r]);
        }
        const long long whole = static_cast<long long>(above) + length / 2 - shift;
        return whole < unbounded && whole > -unbounded ? static_cast<std::int32_t>(whole) : unbounded;
    }

    static constexpr std::int32_t unbounded = 1 << 29;
    double step = 1;
    std::array<long long, 3> origin{};
};

} // namespace cinch
