// SPDX-License-Identifier: Apache-2.0
// No #pragma once: compiled anew for every target.
#if defined(CINCH_MOMENTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CINCH_MOMENTS_INL
#undef CINCH_MOMENTS_INL
#else
#define CINCH_MOMENTS_INL
#endif

#include "toolkit/bounds/kernel/support-inl.hpp"
#include "toolkit/bounds/packed_moments.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

/// The numbers of the moment bound for four axes, one a row, relative to the mean map q̄, θ̄ (bound_moments.hpp): with
/// d_j = (q_j − q̄, θ_j − θ̄), the columns of G are Σ_j f_js d_j, and g_s the same of (q_j − q̄)·c + θ_j − θ̄ + σ
/// z_jᵀGz_j/2, whose quadratic parts are sums over rest data. φ likewise with the mean weights. l − g/σ = q̄.
template <class T> struct MomentNumbers {
    Rows<T> column[3];   ///< G's, with g in the fourth place
    Rows<T> phi;         ///< everywhere
    Rows<T> function[4]; ///< of the lifted vector, placed as moment_place says
    bool bounded;        ///< no product with a place overflows
};

/// Of the chunk `c` of axes; nodes alternately in two sums.
template <class T, std::size_t kAxes>
HWY_INLINE MomentNumbers<T> moment_numbers(const PackedBv<T>& bv, const ProjectedMaps<T>& maps,
                                           const std::uint32_t* node, const T* head, const T* value,
                                           const Rows<T>& mean, std::size_t c)
{
    using R = Rows<T>;
    const R zero = R::all(0);
    R sum[2][3] = {{zero, zero, zero}, {zero, zero, zero}};
    for (std::size_t j = 0; j < bv.count; ++j) {
        const R d = R::load(map_of<T, kAxes>(maps, node[j]) + 16 * c) - mean;
        for (std::size_t s = 0; s < 3; ++s)
            sum[j % 2][s] = fma(R::all(value[j * moment_values + s]), d, sum[j % 2][s]);
    }
    R column[3];
    for (std::size_t s = 0; s < 3; ++s)
        column[s] = sum[0][s] + sum[1][s];
    auto over = [&](const T* rows) HWY_ATTR {
        return row_sum(fma(column[0], each_row<T>(rows),
                           fma(column[1], each_row<T>(rows + 4), column[2] * each_row<T>(rows + 8))));
    };
    HWY_ALIGN static constexpr T unit[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
    MomentNumbers<T> out;
    R g[3], all_g = zero;
    for (std::size_t s = 0; s < 3; ++s) {
        g[s] = over(head + moment_head_g + 12 * s);
        all_g = fma(g[s], each_row<T>(unit[s]), all_g);
        out.column[s] = with_fourth(column[s], g[s]);
    }
    out.phi = over(head + moment_head_phi);
    const auto last = [&](std::size_t b) HWY_ATTR { return row_sum(column[2] * each_row<T>(unit[b])); };
    out.function[0] = with_fourth(mean + all_g * R::all(head[moment_head_reach + 3]), last(0));
    out.function[1] = with_fourth(all_g, last(1));
    out.function[2] = with_fourth(column[0], last(2));
    out.function[3] = with_fourth(column[1], zero);
    const R limit = R::all(static_cast<T>(magnitude_limit<T>));
    R reach = magnitude(out.phi);
    for (std::size_t s = 0; s < 3; ++s)
        reach = fma(magnitude(out.column[s]), R::all(head[moment_head_reach + s]), reach);
    out.bounded = true;
    for (std::size_t i = 0; i < R::vectors; ++i)
        out.bounded &= hn::AllTrue(typename R::D(), hn::Le(reach.v[i], limit.v[i])); // false for NaN
    return out;
}

/// Adds to `along` and `against` the support of the lifted functional over the points and the slack, and q̄·c + θ̄ + φ.
template <class T> HWY_INLINE void add_lifted_support(const PackedBv<T>& bv, const T* point, const T* head,
                                                      const Rows<T>& mean, const MomentNumbers<T>& numbers,
                                                      Rounding rounding, Rows<T>& along, Rows<T>& against)
{
    using R = Rows<T>;
    const auto at = [&](const T* lifted) HWY_ATTR {
        return fma(
            numbers.function[0], each_row<T>(lifted),
            fma(numbers.function[1], each_row<T>(lifted + 4),
                fma(numbers.function[2], each_row<T>(lifted + 8), numbers.function[3] * each_row<T>(lifted + 12))));
    };
    auto most = R::all(-infinity_of<T>), most_against = most;
    for (std::size_t i = 0; i < bv.points; i += 2) { // the last one stands twice where their number is odd
        const auto two = row_sums(at(point + i * moment_point), at(point + (i + 1) * moment_point));
        most = greater(two, most);
        most_against = greater(R::all(0) - two, most_against);
    }
    const auto greatest = [&](const R& x) HWY_ATTR { return column<0>(greater(x, exchange_sides(x))); };
    const T* half = head + moment_head_slack;
    const auto slack = row_sum(fma(magnitude(numbers.function[0]), each_row<T>(half),
                                   fma(magnitude(numbers.function[1]), each_row<T>(half + 4),
                                       fma(magnitude(numbers.function[2]), each_row<T>(half + 8),
                                           magnitude(numbers.function[3]) * each_row<T>(half + 12)))));
    const auto position = column<0>(row_sum(mean * each_row<T>(bv.pivot))), phi = column<0>(numbers.phi),
               off = column<0>(slack);
    const auto sum = [&](const R& points, const R& own, const R& centre) HWY_ATTR {
        return up(up(greatest(points) + off, rounding) + up(own + centre, rounding), rounding);
    };
    along = up(along + sum(most, phi, position), rounding);
    against = up(against + sum(most_against, R::all(0) - phi, R::all(0) - position), rounding);
}

/// b̂_j of every simulation node along and against the axes, into b as support_extrema: greatest s_j + r_j·d over its
/// own box Y ± e about the rest origin. With w = G z_j, and φ + g·z_j in the fourth place,
///   s_j + r_j·d = (q_j − q̄)·Y + θ_j − θ̄ + w·(σz_j/2 − y) − (φ + g·z_j),  y = Y − c, and |q_j − q̄ − w|·e about it.
template <class T, std::size_t kAxes>
HWY_INLINE void moment_extrema(const PackedBv<T>& bv, const ProjectedMaps<T>& maps, const std::uint32_t* node,
                               const T* head, const T* value, const Rows<T>& mean, const MomentNumbers<T>& numbers,
                               std::size_t c, T* b, RowExtrema<T, kAxes>& out)
{
    using R = Rows<T>;
    HWY_ALIGN static constexpr T less[4] = {0, 0, 0, -1};
    const auto one = R::all(1), zero = R::all(0), half = R::all(T(0.5) / head[moment_head_reach + 3]),
               centre = each_row<T>(bv.pivot), fourth = each_row<T>(less);
    const auto start = with_fourth(zero, numbers.phi);
    auto most = R::all(-infinity_of<T>), sum = zero;
    for (std::size_t j = 0; j < bv.count; ++j, b += 16, value += moment_values) {
        const auto d = R::load(map_of<T, kAxes>(maps, node[j]) + 16 * c) - mean;
        const T* z = value + moment_z;
        const auto w = fma(numbers.column[0], R::all(z[0]),
                           fma(numbers.column[1], R::all(z[1]), fma(numbers.column[2], R::all(z[2]), start)));
        const auto y = each_row<T>(value + moment_box);
        const auto lever = with_fourth(fma(half, each_row<T>(z), centre - y), fourth);
        const auto position = fma(d, with_fourth(y, one), w * lever),
                   radius = magnitude(d - w) * each_row<T>(value + moment_box + 4);
        const auto sides = row_sums(radius + position, radius - position);
        sides.store(b);
        most = greater(sides, most);
        sum = fma(R::all(value[moment_r]), sides, sum);
    }
    out.greatest[c] = most;
    out.mean[c] = bv.sum_r > 0 ? sum * R::all(1 / bv.sum_r) : most;
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
