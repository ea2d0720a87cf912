// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "cinch/io.hpp"
#include "toolkit/time/polynomial.hpp"

namespace cinch {

/// Which piece of a curve holds at a time: from which key on, and whether it waits there (before the first key, past
/// the last one, and between keys of a STEP curve).
struct CurvePiece {
    std::size_t key;
    bool constant;
};
inline CurvePiece piece_of(std::span<const double> time_s, Curve::Interpolation interpolation, double t)
{
    const auto next = std::upper_bound(time_s.begin(), time_s.end(), t);
    if (next == time_s.begin())
        return {0, true};
    const auto key = static_cast<std::size_t>(next - time_s.begin() - 1);
    return {key, next == time_s.end() || interpolation == Curve::Interpolation::step};
}

/// The time whose piece gives a curve's value at the end of an interval about `middle_s`: the end itself where the
/// curve does not jump there, so that the next interval begins with the same bits; else the middle.
inline double end_of(std::span<const double> time_s, Curve::Interpolation interpolation, double middle_s, double end_s)
{
    const auto [first, last] = std::equal_range(time_s.begin(), time_s.end(), end_s);
    return interpolation != Curve::Interpolation::step && last - first == 1 ? end_s : middle_s;
}

/// The piece as a polynomial of the time since its key; LINEAR and CUBICSPLINE of the glTF specification, appendix C.
/// `value(i)`: the curve's i-th, tangents counted.
template <std::size_t N, class F> Polynomial<N>
polynomial_of(std::span<const double> time_s, Curve::Interpolation interpolation, const CurvePiece& piece, F&& value)
{
    const bool cubic = interpolation == Curve::Interpolation::cubic_spline;
    const std::size_t k = piece.key;
    const std::array<double, N> v0 = value(cubic ? 3 * k + 1 : k);
    Polynomial<N> path{v0};
    if (piece.constant)
        return path;
    const double d = time_s[k + 1] - time_s[k];
    if (!cubic) {
        const std::array<double, N> v1 = value(k + 1);
        path.c.resize(2);
        for (std::size_t n = 0; n < N; ++n)
            path.c[1][n] = (v1[n] - v0[n]) / d;
        return path;
    }
    const std::array<double, N> out = value(3 * k + 2), in = value(3 * k + 3), v1 = value(3 * k + 4);
    path.c.resize(4);
    for (std::size_t n = 0; n < N; ++n) {
        path.c[1][n] = out[n];
        path.c[2][n] = (3 * (v1[n] - v0[n]) / d - (2 * out[n] + in[n])) / d;
        path.c[3][n] = (2 * (v0[n] - v1[n]) / d + (out[n] + in[n])) / d / d;
    }
    return path;
}

/// A path as a function of the time since a key.
template <class Path> struct Since {
    double key_s = 0, length_s = 0; ///< of that key, and to the next one
    Path path;
};

/// Suprema on [a, b] of `size` of derivatives 0 to 3, rounded up, and what derivatives 0 to 2 are rounded against.
/// `size` of a path on [0, 1]: at least its greatest value there, but for rounding.
template <std::size_t N, class F> void suprema(const Since<Polynomial<N>>& of, double a_s, double b_s, F&& size,
                                               std::array<double, 4>& sup, std::array<double, 3>& magnitude)
{
    // Rounded sums and products of non-negative terms, a few hundred of them at most: 2^-40 covers them.
    constexpr double rounded_up = 1 + 0x1p-40;
    const double h = b_s - a_s;
    Polynomial<N> piece = of.path.over(a_s - of.key_s, b_s - of.key_s);
    double unit = 1;
    for (std::size_t k = 0; k < 4; ++k) {
        const double against = of.path.magnitude(k, of.length_s);
        const double own = unit > 0 ? size(piece) / unit * rounded_up : k > 0 ? against : size(piece) * rounded_up;
        sup[k] = of.path.degree() < k ? 0 : own + 0x1p-44 * against;
        if (k < 3)
            magnitude[k] = against;
        piece = piece.slope();
        unit *= h;
    }
}

} // namespace cinch
