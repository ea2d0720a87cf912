// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include "toolkit/simulate/effects/effects.hpp"

namespace cinch {
namespace {

// Shares of the nodes by mass; they sum to 1.
std::vector<double> by_mass(const MeshlessBody& body, const std::vector<std::uint32_t>& nodes)
{
    std::vector<double> share;
    double sum = 0;
    for (const std::uint32_t i : nodes)
        sum += body.mass[i];
    for (const std::uint32_t i : nodes)
        share.push_back(body.mass[i] / sum);
    return share;
}

class Force : public Effect {
public:
    Force(const MeshlessBody& body, PullingForce pull)
        : Effect("pulling"), pull_(std::move(pull)), share_(by_mass(body, pull_.nodes))
    {
    }

    double energy(const Configuration& c) const override
    {
        const Vec3 f = now(c.time_s);
        Vec3 moved = Vec3::Zero(), rest = Vec3::Zero(); // as in gravity.cpp
        for (std::size_t k = 0; k < share_.size(); ++k) {
            moved += share_[k] * at(c.u, pull_.nodes[k]);
            rest += share_[k] * (c.body.rest[pull_.nodes[k]] - c.reference.centre);
        }
        return -f.dot(moved) - f.dot(c.reference.rotation * rest - c.datum);
    }
    void add_forces(const Configuration& c, Forces out) const override
    {
        const Vec3 f = now(c.time_s);
        for (std::size_t k = 0; k < share_.size(); ++k)
            at(out.force, pull_.nodes[k]) += share_[k] * f;
    }

private:
    Vec3 now(double t) const
    {
        if (t < pull_.start_s || t > pull_.end_s)
            return Vec3::Zero();
        return pull_.period_s > 0
                   ? Vec3(std::sin(2 * std::numbers::pi * (t - pull_.start_s) / pull_.period_s) * pull_.force)
                   : pull_.force;
    }
    PullingForce pull_;
    std::vector<double> share_;
};

class Target : public Effect {
public:
    Target(const MeshlessBody& body, PullingTarget pull)
        : Effect("pulling"), pull_(std::move(pull)), share_(by_mass(body, pull_.nodes))
    {
    }

    double energy(const Configuration& c) const override
    {
        double sum = 0;
        for (std::size_t k = 0; k < share_.size(); ++k)
            sum += 0.5 * pull_.stiffness * share_[k] * way(c, k).squaredNorm();
        return sum;
    }
    void add_forces(const Configuration& c, Forces out) const override
    {
        for (std::size_t k = 0; k < share_.size(); ++k)
            at(out.force, pull_.nodes[k]) -= pull_.stiffness * share_[k] * way(c, k);
    }
    void add_curvature(const Configuration&, Curvature out) const override
    {
        for (std::size_t k = 0; k < share_.size(); ++k)
            out.block[pull_.nodes[k]].diagonal().array() += pull_.stiffness * share_[k];
    }

private:
    Vec3 way(const Configuration& c, std::size_t k) const
    {
        return at(c.x, pull_.nodes[k]) - (pull_.target(k, c.time_s) + c.reference.relative(pull_.origin));
    }

    PullingTarget pull_;
    std::vector<double> share_;
};

} // namespace

std::unique_ptr<Effect> make_pulling(const MeshlessBody& body, PullingForce pull)
{
    return std::make_unique<Force>(body, std::move(pull));
}
std::unique_ptr<Effect> make_pulling(const MeshlessBody& body, PullingTarget pull)
{
    return std::make_unique<Target>(body, std::move(pull));
}

} // namespace cinch
