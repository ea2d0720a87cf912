// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

#include "toolkit/simulate/field.hpp"

namespace cinch {

inline constexpr const char* elastic_name = "elastic"; ///< of elastic materials, whatever their law

/// Lamé's constants, Pa, of Young's modulus E > 0 and Poisson's ratio ν in (−1, 0.5).
struct Lame {
    double lambda, mu;
};
constexpr Lame lame(double young, double poisson)
{
    return {young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 * (1 + poisson))};
}

/// ∂ det F / ∂F.
inline Mat3 cofactor(const Mat3& f)
{
    Mat3 c;
    c << f.col(1).cross(f.col(2)), f.col(2).cross(f.col(0)), f.col(0).cross(f.col(1));
    return c;
}

/// det F − 1 and cof F − I at F = I + H, without the difference: errors are relative to H.
inline double volume_change(const Mat3& h) { return h.trace() + cofactor(h).trace() + h.determinant(); }
inline Mat3 cofactor_change(const Mat3& h) { return h.trace() * Mat3::Identity() - h.transpose() + cofactor(h); }

/// Adds s ∂ cof F / ∂F, columns stacked: d(f₂×f₃) = df₂×f₃ + f₂×df₃ and so on.
inline void add_cofactor_derivative(const Mat3& f, double s, Mat9& h)
{
    auto cross = [s](const Vec3& v) {
        Mat3 m;
        m << 0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0;
        return Mat3(s * m);
    };
    const Mat3 x = cross(f.col(0)), y = cross(f.col(1)), z = cross(f.col(2));
    h.block<3, 3>(0, 3) -= z;
    h.block<3, 3>(0, 6) += y;
    h.block<3, 3>(3, 0) += z;
    h.block<3, 3>(3, 6) -= x;
    h.block<3, 3>(6, 0) -= y;
    h.block<3, 3>(6, 3) += x;
}

inline Eigen::Matrix<double, 9, 1> stacked(const Mat3& m)
{
    return Eigen::Map<const Eigen::Matrix<double, 9, 1>>(m.data());
}

/// Green's strain ½ (FᵀF − I) at F = I + H: ½ (H + Hᵀ + HᵀH).
inline Mat3 green_strain(const Mat3& h) { return 0.5 * (h + h.transpose() + h.transpose() * h); }

/// Of a stress P = F S with S = a tr(E) I + 2 b E, E the strain up to a constant: adds ∂P/∂F, given S.
inline void add_second_piola_derivative(const Mat3& f, const Mat3& s, double a, double b, Mat9& h)
{
    const Mat3 left = b * f * f.transpose();
    for (int c = 0; c < 3; ++c)
        for (int k = 0; k < 3; ++k) {
            auto block = h.block<3, 3>(3 * c, 3 * k);
            block.diagonal().array() += s(k, c);
            block += a * f.col(c) * f.col(k).transpose() + b * f.col(k) * f.col(c).transpose();
            if (c == k)
                block += left;
        }
}

} // namespace cinch
