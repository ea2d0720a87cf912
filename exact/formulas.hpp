// SPDX-License-Identifier: GPL-3.0-or-later
// Internal to exact/: the mathematics of the guarantee, written once for any number type N that is exact or
// encloses the exact value. Shares data with the toolkit, no algorithm.
#pragma once

#include <vector>

#include "cinch/surface.hpp"
#include "exact/number.hpp"
#include "toolkit/bounds/bound_box.hpp"

namespace cinch::exact {

template <class N> using Point = std::array<N, 3>;

/// v = Σ_j w_j (A_j x + t_j), Eq. 3.
template <class N> Point<N> deformed(const Point<N>& rest, Weights::Row row, std::span<const AffineMap> maps)
{
    Point<N> v{N(0), N(0), N(0)};
    for (std::size_t i = 0; i < row.node.size(); ++i)
        for (int r = 0; r < 3; ++r) {
            const auto& m = maps[row.node[i]].m[r];
            N image = N(m[3]);
            for (int s = 0; s < 3; ++s)
                image = image + N(m[s]) * rest[static_cast<std::size_t>(s)];
            v[static_cast<std::size_t>(r)] = v[static_cast<std::size_t>(r)] + N(row.weight[i]) * image;
        }
    return v;
}

template <class N> Point<N> as_point(const Vec3& v) { return {N(v[0]), N(v[1]), N(v[2])}; }

template <class N> Point<N> deformed(const Vec3& rest, Weights::Row row, std::span<const AffineMap> maps)
{
    return deformed(as_point<N>(rest), row, maps);
}

/// γ·v for γ = axis, or −axis where `against`.
template <class N> N along(const Point<N>& v, const Axis& axis, bool against)
{
    N sum(0);
    for (std::size_t r = 0; r < 3; ++r)
        if (axis[r] != 0)
            sum = (axis[r] > 0) != against ? sum + v[r] : sum - v[r];
    return sum;
}

/// Extremum of the deformed rest box: max { γ·T x : x ∈ centre ± half } = γ·T c + Σ_s |γ·A e_s| half_s, both ways.
template <class N> struct Extremum {
    N plus, minus;
};
template <class N> Extremum<N> extremum(const Vec3& centre, const Vec3& half, const AffineMap& map, const Axis& axis)
{
    N position(0), radius(0);
    for (int s = 0; s < 4; ++s) {
        N column(0);
        for (std::size_t r = 0; r < 3; ++r)
            if (axis[r] != 0)
                column = axis[r] > 0 ? column + N(map.m[r][s]) : column - N(map.m[r][s]);
        position = position + (s < 3 ? column * N(centre[s]) : column);
        if (s < 3)
            radius = radius + absolute(column) * N(half[s]);
    }
    return {position + radius, radius - position};
}

/// Aᵀγ in places 0 to 2 and γ·t in place 3, and γ·T x from it.
template <class N> using Column = std::array<N, 4>;
template <class N> Column<N> column_of(const AffineMap& map, const Axis& axis)
{
    Column<N> column{N(0), N(0), N(0), N(0)};
    for (std::size_t s = 0; s < 4; ++s)
        for (std::size_t r = 0; r < 3; ++r)
            if (axis[r] != 0)
                column[s] = axis[r] > 0 ? column[s] + N(map.m[r][s]) : column[s] - N(map.m[r][s]);
    return column;
}
template <class N> N image_along(const Column<N>& column, const Vec3& x)
{
    N image = column[3];
    for (int s = 0; s < 3; ++s)
        image = image + column[static_cast<std::size_t>(s)] * N(x[s]);
    return image;
}

/// The greatest of the n(n − 1) corners of §5.2.2 of the paper, each listed: h at i, 1 − Σ of the rest at j, l
/// elsewhere.
template <class N> N best_corner(WeightSpace space, const std::vector<N>& b)
{
    if (b.size() == 1)
        return b[0];
    N base(0), slack(1);
    for (std::size_t k = 0; k < b.size(); ++k) {
        base = base + N(space.l[k]) * b[k];
        slack = slack - N(space.l[k]);
    }
    bool first = true;
    N best(0);
    for (std::size_t i = 0; i < b.size(); ++i)
        for (std::size_t j = 0; j < b.size(); ++j) {
            if (i == j)
                continue;
            const N raised = N(space.h[i]) - N(space.l[i]), value = base + raised * b[i] + (slack - raised) * b[j];
            best = first ? value : maximum(best, value);
            first = false;
        }
    return best;
}

/// D(λ) = λ + Σ_j [ l_j (b_j − λ) + (h_j − l_j) max(b_j − λ, 0) ] ≥ max over W', for every λ.
template <class N> N dual_value(WeightSpace space, const std::vector<N>& b, const N& lambda)
{
    N sum = lambda;
    for (std::size_t j = 0; j < b.size(); ++j) {
        const N above = b[j] - lambda;
        sum = sum + N(space.l[j]) * above + (N(space.h[j]) - N(space.l[j])) * maximum(above, N(0));
    }
    return sum;
}

} // namespace cinch::exact
