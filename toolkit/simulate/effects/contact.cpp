// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/effects/contact.hpp"

#include <cmath>
#include <limits>

#include "toolkit/simulate/stream.hpp"
#include "toolkit/simulate/surface_force.hpp"

namespace cinch {
namespace {

Vec3 normal_of(const Contact& c) { return Eigen::Map<const Vec3>(c.normal.data()); }

// `origin`: that of the plane, seen from the reference's.
double depth(const Configuration& at, const Contact& c, const Vec3& origin)
{
    Vec3 p = -origin;
    for (std::size_t i = 0; i < 3; ++i)
        p += c.share[i] * point(at, c.corner[i]);
    return c.offset - normal_of(c).dot(p);
}

void push(const Configuration& at, const Contact& c, double size, Forces out)
{
    for (std::size_t i = 0; i < 3; ++i)
        if (c.share[i] > 0)
            add_point_force(at, c.corner[i], c.share[i] * size * normal_of(c), out);
}

template <class Visit> void each_weight(const Configuration& at, const Contact& c, const Visit& visit)
{
    for (std::size_t i = 0; i < 3; ++i) {
        const Weights::Row row = at.surface->weights.of(c.corner[i]);
        for (std::size_t e = 0; e < row.node.size(); ++e)
            visit(row.node[e], c.share[i] * row.weight[e]);
    }
}

} // namespace

double BodyContact::energy(const Configuration& at) const
{
    const Vec3 origin = at.reference.relative(origin_);
    double sum = 0;
    for (const Contact& c : contacts_)
        if (const double d = depth(at, c, origin); d > 0)
            sum += 0.5 * c.stiffness * d * d;
    return sum;
}

void BodyContact::add_forces(const Configuration& at, Forces out) const
{
    const Vec3 origin = at.reference.relative(origin_);
    for (const Contact& c : contacts_)
        if (const double d = depth(at, c, origin); d > 0)
            push(at, c, c.stiffness * d, out);
}

void BodyContact::prepare_product(const Configuration& at, bool worst)
{
    const Vec3 origin = at.reference.relative(origin_);
    touching_.clear();
    for (std::size_t k = 0; k < contacts_.size(); ++k)
        if (worst || depth(at, contacts_[k], origin) > 0)
            touching_.push_back(k);
}

void BodyContact::add_product(const Configuration& at, const Field& dx, const MatrixField& dj, Forces out) const
{
    for (const std::size_t k : touching_) {
        const Contact& c = contacts_[k];
        double along = 0;
        for (std::size_t i = 0; i < 3; ++i)
            if (c.share[i] > 0)
                along += c.share[i] * normal_of(c).dot(point_change(at, c.corner[i], dx, dj));
        push(at, c, -c.stiffness * along, out);
    }
}

void BodyContact::add_diagonal(const Configuration& at, std::vector<Mat3>& block) const
{
    for (const std::size_t k : touching_) {
        const Contact& c = contacts_[k];
        const Mat3 along = c.stiffness * normal_of(c) * normal_of(c).transpose();
        each_weight(at, c, [&](std::uint32_t node, double weight) { block[node] += weight * weight * along; });
    }
}

/// ω Δt ≤ 1, ω² = k / m by rows: shares and weights sum to 1, and the 4 is for what acts through J. The stiffness that
/// the explicit integrator looks at now and then may be of other contacts.
double BodyContact::longest_step(const Configuration& at) const
{
    std::vector<double> load(at.body.size(), 0);
    for (const Contact& c : contacts_)
        each_weight(at, c, [&](std::uint32_t node, double weight) { load[node] += 4 * weight * c.stiffness; });
    double longest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < load.size(); ++i)
        if (load[i] > 0)
            longest = std::min(longest, std::sqrt(at.body.mass[i] / load[i]));
    return longest;
}

void BodyContact::save(std::ostream& out) const
{
    write_list(out, contacts_);
    write_raw<double>(out, {origin_.data(), 3});
}
void BodyContact::restore(std::istream& in)
{
    read_list(in, contacts_);
    read_raw<double>(in, {origin_.data(), 3});
}

} // namespace cinch
