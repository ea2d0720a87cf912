// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/body_state.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include "toolkit/simulate/configuration.hpp"
#include "toolkit/simulate/stream.hpp"

namespace cinch {

BodyState::BodyState(const MeshlessBody& body) : u(4 * body.size(), 0), v(u), x(u)
{
    Vec3 low = Vec3::Constant(HUGE_VAL), high = -low, mean = Vec3::Zero();
    for (const Vec3& p : body.rest) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
        mean += p / static_cast<double>(body.size());
    }
    if (mean.stableNorm() > (high - low).stableNorm())
        reference.centre = reference.origin = mean;
    update_positions(body);
}

void BodyState::refer_to(const MeshlessBody& body, const Reference& to, std::initializer_list<Field*> fields)
{
    const Mat3 turn = reference.rotation - to.rotation;
    const Vec3 way = reference.way_to(to);
    for (Field* field : fields)
        for (std::size_t i = 0; i < body.size(); ++i)
            at(*field, i) += turn * (body.rest[i] - reference.centre) - way;
    reference = to;
}

void BodyState::update_positions(const MeshlessBody& body)
{
    for (std::size_t i = 0; i < body.size(); ++i)
        at(x, i) = reference.origin + (reference.low + (reference.place(body.rest[i]) + at(u, i)));
}

double BodyState::kinetic(const MeshlessBody& body) const
{
    double sum = 0;
    for (std::size_t i = 0; i < body.size(); ++i)
        sum += 0.5 * body.mass[i] * at(v, i).squaredNorm();
    return sum;
}

bool BodyState::is_finite() const
{
    return whole(x).allFinite() && whole(v).allFinite() &&
           std::all_of(plastic_inverse.begin(), plastic_inverse.end(), [](const Mat3& p) { return p.allFinite(); });
}

void BodyState::save(std::ostream& out) const
{
    write_raw<double>(out, {&time_s, 1});
    reference.save(out);
    write_raw<double>(out, u);
    write_raw<double>(out, x);
    write_raw<double>(out, v);
    for (const Mat3& p : plastic_inverse)
        write_raw<double>(out, {p.data(), 9});
    write_list(out, slow_mode);
    for (const Memory& m : memory)
        m.save(out);
}

void BodyState::restore(std::istream& in)
{
    read_raw<double>(in, {&time_s, 1});
    reference.restore(in);
    read_raw<double>(in, u);
    read_raw<double>(in, x);
    read_raw<double>(in, v);
    for (Mat3& p : plastic_inverse)
        read_raw<double>(in, {p.data(), 9});
    read_list(in, slow_mode);
    for (Memory& m : memory)
        m.restore(in);
}

Reference fitted(const BodyModel& model, const Reference& present, const Field& u)
{
    const MeshlessBody& body = model.body;
    Reference to = present;
    if (!model.pins.empty())
        return to;
    double mass = 0;
    Vec3 mean = Vec3::Zero(), rest = Vec3::Zero();
    for (std::size_t i = 0; i < body.size(); ++i) {
        mass += body.mass[i];
        mean += body.mass[i] * at(u, i);
        rest += body.mass[i] * (body.rest[i] - present.centre);
    }
    mean /= mass;
    rest /= mass;
    Mat3 a = Mat3::Zero(); // Σ m (X − mean X) (x − mean x)ᵀ, whose polar factor is the rotation
    for (std::size_t i = 0; i < body.size(); ++i) {
        const Vec3 x = (body.rest[i] - present.centre) - rest;
        a += body.mass[i] * (present.rotation * x + (at(u, i) - mean)) * x.transpose();
    }
    const Eigen::JacobiSVD<Mat3, Eigen::NoQRPreconditioner> svd(a, Eigen::ComputeFullU | Eigen::ComputeFullV);
    if (a.allFinite() && svd.singularValues()[0] > 0) {
        const Mat3 &left = svd.matrixU(), &right = svd.matrixV(), r = left * right.transpose();
        const Vec3 along = present.rotation * right.col(0);
        Mat3 turned = r.determinant() > 0 ? r : Mat3(left * Vec3(1, 1, -1).asDiagonal() * right.transpose());
        if (!(svd.singularValues()[1] > 1e-6 * svd.singularValues()[0])) // a line: by the least turn
            turned = present.rotation + rotation_change(along, left.col(0) - along) * present.rotation;
        if ((turned - present.rotation).norm() > 0x1p-26)
            to.rotation = turned;
    }
    to.move((present.rotation - to.rotation) * rest + mean);
    return to;
}

} // namespace cinch
