// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>

#include <Eigen/Core>

namespace cinch {

/// Norms whose squares do not vanish where the numbers do not: below 2^-450 they are taken of numbers that are 2^600
/// times as large. A chain of bones may scale up again what was that small.
template <std::size_t N> double norm_of(const std::array<double, N>& numbers)
{
    double square = 0;
    for (const double x : numbers)
        square += x * x;
    if (!(square < 0x1p-900))
        return std::sqrt(square);
    square = 0;
    for (const double x : numbers)
        square += (x * 0x1p600) * (x * 0x1p600);
    return std::sqrt(square) * 0x1p-600;
}
/// Frobenius's of a matrix, not less than that of any direction.
template <class Derived> double norm_of(const Eigen::MatrixBase<Derived>& numbers)
{
    const double norm = numbers.norm();
    return norm < 0x1p-450 ? (numbers * 0x1p600).norm() * 0x1p-600 : norm;
}

} // namespace cinch
