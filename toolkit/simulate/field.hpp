// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>

#include "toolkit/deform/aligned.hpp"
#include "toolkit/surface/triangle_mesh.hpp"

namespace cinch {

using Mat3 = Eigen::Matrix3d;
using Mat9 = Eigen::Matrix<double, 9, 9>; ///< on 3×3 matrices stacked column by column

/// A vector per simulation node, in records of 4 doubles whose last is 0, so that dot products may run over all of
/// them.
using Field = AlignedVector<double>;
/// A 3×3 matrix per simulation node: its columns in records of 4 doubles whose last is 0.
using MatrixField = AlignedVector<double>;

inline Eigen::Map<Vec3> at(Field& f, std::size_t i) { return Eigen::Map<Vec3>(f.data() + 4 * i); }
inline Eigen::Map<const Vec3> at(const Field& f, std::size_t i) { return Eigen::Map<const Vec3>(f.data() + 4 * i); }

using MatrixAt = Eigen::Map<Mat3, 0, Eigen::OuterStride<4>>;
using ConstMatrixAt = Eigen::Map<const Mat3, 0, Eigen::OuterStride<4>>;
inline MatrixAt matrix_at(MatrixField& f, std::size_t i) { return MatrixAt(f.data() + 12 * i); }
inline ConstMatrixAt matrix_at(const MatrixField& f, std::size_t i) { return ConstMatrixAt(f.data() + 12 * i); }

inline Eigen::Map<Eigen::VectorXd> whole(Field& f) { return {f.data(), static_cast<Eigen::Index>(f.size())}; }
inline Eigen::Map<const Eigen::VectorXd> whole(const Field& f)
{
    return {f.data(), static_cast<Eigen::Index>(f.size())};
}

} // namespace cinch
