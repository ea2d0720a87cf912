// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/configuration.hpp"

#include <cmath>

#include <Eigen/Geometry>

namespace cinch {
namespace {

// A unit vector perpendicular to a and b, along a × b where that is not 0; any perpendicular to the longer one otherwise.
Vec3 perpendicular(const Vec3& a, const Vec3& b)
{
    const Vec3 n = a.stableNormalized().cross(b.stableNormalized());
    if (n.squaredNorm() > 1e-24) // an angle of 1e-12; below it the direction is noise, and any will do
        return n.normalized();
    const Vec3& longer = a.squaredNorm() >= b.squaredNorm() ? a : b;
    return longer.squaredNorm() > 0 ? longer.unitOrthogonal() : Vec3::UnitZ();
}

} // namespace

NeighbourLists lists_of(const MeshlessBody& body) { return {body.row, body.neighbour, body.record}; }

void complete(const MeshlessBody& body, MatrixField& deformation, Completion completion)
{
    for (std::size_t d = 0; d < body.deficient.size(); ++d) {
        const std::size_t i = body.deficient[d];
        const Mat3& frame = body.frame[d];
        auto j = matrix_at(deformation, i);
        if (completion == Completion::off) { // the pseudo-inverse alone: I in the null directions
            for (int s = body.rank[i]; s < 3; ++s)
                j += frame.col(s) * frame.col(s).transpose();
            continue;
        }
        if (body.rank[i] == 2) {
            const Vec3 a = j * frame.col(0), b = j * frame.col(1);
            j += perpendicular(a, b) * frame.col(2).transpose();
        } else if (body.rank[i] == 1) {
            const Vec3 g = j * frame.col(0);
            const Mat3 r = g.squaredNorm() > 0 ? Eigen::Quaterniond::FromTwoVectors(frame.col(0), g).toRotationMatrix() : Mat3::Identity();
            j += r * (Mat3::Identity() - frame.col(0) * frame.col(0).transpose());
        } else {
            j = Mat3::Identity();
        }
    }
}

void complete_curvature(const MeshlessBody& body, const MatrixField& deformation, const MatrixField& stress, std::vector<Mat9>& local)
{
    for (std::size_t d = 0; d < body.deficient.size(); ++d) {
        const std::size_t i = body.deficient[d];
        const int rank = body.rank[i];
        if (rank == 0)
            continue;
        const Mat3& frame = body.frame[d];
        const Mat3 j = matrix_at(deformation, i);
        const Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 2> g = j * frame.leftCols(rank);
        const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 2, 2> metric = g.transpose() * g;
        if (!(std::abs(metric.determinant()) > 1e-12 * metric.squaredNorm()))
            continue; // collapsed: the normal has no derivative
        const Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 2> dual = g * metric.inverse();
        Mat9 l = Mat9::Identity(), curvature = Mat9::Zero();
        for (int a = rank; a < 3; ++a) {
            const Vec3 n = frame.col(a), m = j * n;
            Eigen::Matrix<double, 3, 9> turn = Eigen::Matrix<double, 3, 9>::Zero(); // stacked(dG) ↦ dm
            for (int t = 0; t < rank; ++t)
                for (int c = 0; c < 3; ++c)
                    turn.block<3, 3>(0, 3 * c) -= frame(c, t) * dual.col(t) * m.transpose();
            for (int c = 0; c < 3; ++c)
                l.block<3, 9>(3 * c, 0) += n[c] * turn;
            if (!stress.empty())
                curvature += m.dot(matrix_at(stress, i) * n) * turn.transpose() * turn; // −v P: the minus is in it
        }
        local[i] = l.transpose() * local[i] * l + curvature;
    }
}

std::vector<AffineMap> transforms(const MeshlessBody& body, const Field& x, const MatrixField& deformation)
{
    std::vector<AffineMap> maps(body.size());
    for (std::size_t i = 0; i < body.size(); ++i) {
        const Mat3 j = matrix_at(deformation, i);
        const Vec3 t = at(x, i) - j * body.rest[i];
        for (int r = 0; r < 3; ++r) {
            for (int c = 0; c < 3; ++c)
                maps[i].m[r][c] = j(r, c);
            maps[i].m[r][3] = t[r];
        }
    }
    return maps;
}

} // namespace cinch
