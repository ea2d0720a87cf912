// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/configuration.hpp"

#include <cmath>

#include <Eigen/Geometry>

namespace cinch {
namespace {

// The unit normal of (t + a, s + b) less that of (t, s), n: with w = (t + a) × (s + b) − n it is (w − n c) / (1 + c), 1
// + c = ‖n + w‖, c = (2 n·w + w²) / (‖n + w‖ + 1). Where t + a and s + b have collapsed to a line, any normal of it
// will do.
Vec3 normal_change(const Vec3& t, const Vec3& s, const Vec3& a, const Vec3& b)
{
    const Vec3 n = t.cross(s), w = a.cross(s) + t.cross(b) + a.cross(b), there = n + w;
    const Vec3 p = t + a, q = s + b;
    const double size = there.norm();
    if (size > 1e-12 * p.norm() * q.norm()) { // an angle of 1e-12; below it the direction is noise
        const double c = (2 * n.dot(w) + w.squaredNorm()) / (size + 1);
        return (w - c * n) / size;
    }
    const Vec3& longer = p.squaredNorm() >= q.squaredNorm() ? p : q;
    return (longer.squaredNorm() > 0 ? longer.unitOrthogonal() : Vec3::UnitZ()) - n;
}

} // namespace

Mat3 rotation_change(const Vec3& f, const Vec3& a)
{
    const double size = (f + a).norm();
    if (!(size > 0))
        return Mat3::Zero();
    const Vec3 v = f.cross(a) / size;
    const double cosine = (1 + f.dot(a)) / size;
    if (!(1 + cosine > 1e-12)) { // turned around: by half a turn about any axis across
        const Vec3 axis = f.unitOrthogonal();
        return 2 * (axis * axis.transpose() - Mat3::Identity());
    }
    Mat3 cross;
    cross << 0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0;
    return cross + cross * cross / (1 + cosine);
}

NeighbourLists lists_of(const MeshlessBody& body) { return {body.row, body.neighbour, body.record}; }

void complete(const MeshlessBody& body, MatrixField& strain, Completion completion)
{
    if (completion == Completion::off) // the pseudo-inverse alone: J = I in the null directions
        return;
    for (std::size_t d = 0; d < body.deficient.size(); ++d) {
        const std::size_t i = body.deficient[d];
        const Mat3& frame = body.frame[d];
        auto h = matrix_at(strain, i);
        if (body.rank[i] == 2)
            h += normal_change(frame.col(0), frame.col(1), h * frame.col(0), h * frame.col(1)) *
                 frame.col(2).transpose();
        else if (body.rank[i] == 1)
            h += rotation_change(frame.col(0), h * frame.col(0)) *
                 (Mat3::Identity() - frame.col(0) * frame.col(0).transpose());
    }
}

void measure(const MeshlessBody& body, const Mat3& rotation, const Field& u, Completion completion,
             MatrixField& gradient, MatrixField& strain, MatrixField& deformation)
{
    gradient.resize(12 * body.size());
    strain.assign(12 * body.size(), 0);
    deformation.assign(12 * body.size(), 0);
    gather_gradients(lists_of(body), u, gradient);
    const Mat3 back = rotation.transpose();
    for (std::size_t i = 0; i < body.size(); ++i) {
        matrix_at(strain, i).noalias() = back * matrix_at(gradient, i);
        matrix_at(deformation, i) = rotation + matrix_at(gradient, i);
    }
    if (body.deficient.empty())
        return;
    complete(body, strain, completion);
    for (const std::uint32_t i : body.deficient) {
        if (body.rank[i] == 0)
            matrix_at(deformation, i).setIdentity();
        else
            matrix_at(deformation, i) = rotation + rotation * matrix_at(strain, i);
    }
}

void complete_curvature(const MeshlessBody& body, const MatrixField& deformation, const MatrixField& stress,
                        std::vector<Mat9>& local)
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

std::vector<AffineMap> transforms(const MeshlessBody& body, const Reference& reference, const Field& u,
                                  const MatrixField& deformation, const Vec3& from)
{
    std::vector<AffineMap> maps(body.size());
    const Vec3 origin = -reference.relative(from);
    for (std::size_t i = 0; i < body.size(); ++i) {
        const Mat3 j = matrix_at(deformation, i);
        const Vec3 t =
            (origin - j * reference.centre) + (at(u, i) + (reference.rotation - j) * (body.rest[i] - reference.centre));
        for (int r = 0; r < 3; ++r) {
            for (int c = 0; c < 3; ++c)
                maps[i].m[r][c] = j(r, c);
            maps[i].m[r][3] = t[r];
        }
    }
    return maps;
}

} // namespace cinch
