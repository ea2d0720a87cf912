// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "toolkit/simulate/effects/effects.hpp"
#include "toolkit/simulate/stream.hpp"
#include "toolkit/simulate/surface_force.hpp"

namespace cinch {
namespace {

constexpr double slow = 5e-4; // see Ground

// ∛v of v > 0, by way of [1, 8): the library's rounding is not the same for all powers of 8.
double cube_root(double v)
{
    const int thirds = static_cast<int>(std::floor(std::ilogb(v) / 3.0));
    return std::ldexp(std::cbrt(std::ldexp(v, -3 * thirds)), thirds);
}

// What touches the ground: the vertices of the surface, or the nodes of a body that has none.
class GroundContact : public Effect {
public:
    explicit GroundContact(const Ground& ground) : Effect("ground"), ground_(ground) { ground_.normal.normalize(); }

    bool needs_deformation() const override { return !ground_.at_nodes; }
    double energy(const Configuration& given) const override
    {
        const Configuration c = seen(given);
        const Vec3 way = way_from(c);
        double sum = 0;
        each_contact(c, [&](std::size_t k, const Vec3& p, double depth) {
            sum += 0.5 * stiffness(c) * depth * depth;
            if (const double f = drag(k); f > 0)
                sum += 0.5 * f * slip(p, k, way).squaredNorm();
        });
        return sum;
    }
    void add_forces(const Configuration& given, Forces out) const override
    {
        const Configuration c = seen(given);
        const Vec3 way = way_from(c);
        each_contact(c, [&](std::size_t k, const Vec3& p, double depth) {
            Vec3 f = stiffness(c) * depth * ground_.normal;
            if (const double d = drag(k); d > 0)
                f -= d * slip(p, k, way);
            add_point_force(c, k, f, out);
        });
    }
    bool couples_nodes() const override { return true; }
    void prepare_product(const Configuration& given, bool worst) override
    {
        const Configuration c = seen(given);
        touching_.clear();
        if (worst) { // anything may touch within the steps to come
            for (std::size_t k = 0; k < points_of(c); ++k)
                touching_.push_back({k, stiffness(c), 0});
            return;
        }
        each_contact(c, [&](std::size_t k, const Vec3&, double depth) {
            touching_.push_back({k, depth > 0 ? stiffness(c) : 0, drag(k)});
        });
    }
    void add_product(const Configuration& given, const Field& dx, const MatrixField& dj, Forces out) const override
    {
        const Configuration c = seen(given);
        for (const Touch& t : touching_) {
            const Vec3 dp = point_change(c, t.point, dx, dj), along = ground_.normal * ground_.normal.dot(dp);
            add_point_force(c, t.point, -t.push * along - t.drag * (dp - along), out);
        }
    }
    void add_diagonal(const Configuration& given, std::vector<Mat3>& block) const override
    {
        const Configuration c = seen(given);
        const Mat3 along = ground_.normal * ground_.normal.transpose();
        for (const Touch& t : touching_) {
            const Mat3 push = t.push * along + t.drag * (Mat3::Identity() - along);
            if (!c.surface) {
                block[t.point] += push;
                continue;
            }
            const Weights::Row row = c.surface->weights.of(t.point);
            for (std::size_t e = 0; e < row.node.size(); ++e)
                block[row.node[e]] += row.weight[e] * row.weight[e] * push;
        }
    }
    /// As the drag does for an explicit step: force by velocity, c = μ N / speed. By rows: weights sum to 1, and the 4
    /// is for what acts through J.
    void add_damping(const Configuration& given, Curvature out) const override
    {
        const Configuration c = seen(given);
        for (std::size_t k = 0; k < before_.size() / 4; ++k) {
            const double damping = drag(k) * interval_s_;
            if (damping == 0)
                continue;
            if (!c.surface) {
                out.block[k].diagonal().array() += damping;
                continue;
            }
            const Weights::Row row = c.surface->weights.of(k);
            for (std::size_t e = 0; e < row.node.size(); ++e)
                out.block[row.node[e]].diagonal().array() += 4 * row.weight[e] * damping;
        }
    }
    /// Friction must not turn a slip around: c Δt ≤ m, m the point's share of the mass of its nodes, a quarter for what
    /// acts through J.
    double longest_step(const Configuration& given) const override
    {
        const Configuration c = seen(given);
        double longest = std::numeric_limits<double>::infinity();
        std::vector<double> load; // of each node by all points
        for (std::size_t k = 0; k < before_.size() / 4; ++k) {
            const double damping = drag(k) * interval_s_;
            if (damping == 0)
                continue;
            if (!c.surface) {
                longest = std::min(longest, c.body.mass[k] / damping);
                continue;
            }
            load.resize(c.body.size(), 0);
            const Weights::Row row = c.surface->weights.of(k);
            for (std::size_t e = 0; e < row.node.size(); ++e)
                load[row.node[e]] += 4 * row.weight[e] * damping;
        }
        for (std::size_t i = 0; i < load.size(); ++i)
            if (load[i] > 0)
                longest = std::min(longest, c.body.mass[i] / load[i]);
        return longest;
    }
    /// Friction: a drag μ N / ‖slip of the last step‖ on the slip of this one, by which it reaches Coulomb's force
    /// where things slide steadily and holds where they rest: below a slow speed.
    void remember(const Configuration& given, double dt_s) override
    {
        if (ground_.friction == 0)
            return;
        const Configuration c = seen(given);
        const std::size_t count = points_of(c);
        std::vector<double> next(4 * count, 0);
        double held = 0; // N
        interval_s_ = dt_s;
        for (std::size_t k = 0; k < count; ++k) {
            const Vec3 p = point(c, k);
            std::copy_n(p.data(), 3, next.data() + 4 * k);
            next[4 * k + 3] = std::max(0.0, depth(c, p));
            held += stiffness(c) * next[4 * k + 3];
        }
        double mass = 0, volume = 0;
        for (std::size_t i = 0; i < c.body.size(); ++i) {
            mass += c.body.mass[i];
            volume += c.body.volume[i];
        }
        const double slow_m_per_s = slow * std::sqrt(held / mass * cube_root(volume));
        const Vec3 way = way_from(c);
        for (std::size_t k = 0; k < count; ++k)
            if (double& drag = next[4 * k + 3]; drag > 0)
                drag = before_.empty() ? 0
                                       : ground_.friction * stiffness(c) * drag /
                                             std::max(slip(Eigen::Map<const Vec3>(next.data() + 4 * k), k, way).norm(),
                                                      slow_m_per_s * dt_s);
        before_ = std::move(next);
        reference_ = c.reference;
    }
    void save(std::ostream& out) const override
    {
        write_list(out, before_);
        reference_.save(out);
        write_raw<double>(out, {&interval_s_, 1});
    }
    void restore(std::istream& in) override
    {
        read_list(in, before_);
        reference_.restore(in);
        read_raw<double>(in, {&interval_s_, 1});
    }

private:
    Configuration seen(const Configuration& given) const
    {
        Configuration c = given;
        if (ground_.at_nodes)
            c.surface = nullptr;
        return c;
    }
    double depth(const Configuration& c, const Vec3& p) const
    {
        return ground_.normal.dot(c.reference.relative(ground_.point) - p);
    }
    Vec3 way_from(const Configuration& c) const
    {
        return reference_.way_to(c.reference);
    } ///< from what `before_` refers to
    // What is below the plane, and what still rubs against it: depth ≥ 0.
    template <class Visit> void each_contact(const Configuration& c, const Visit& visit) const
    {
        const std::size_t count = points_of(c);
        for (std::size_t k = 0; k < count; ++k) {
            const Vec3 p = point(c, k);
            if (const double below = depth(c, p); below > 0 || drag(k) > 0)
                visit(k, p, std::max(below, 0.0));
        }
    }
    double stiffness(const Configuration& c) const { return ground_.stiffness / static_cast<double>(points_of(c)); }
    double drag(std::size_t k) const { return before_.empty() ? 0 : before_[4 * k + 3]; }
    Vec3 slip(const Vec3& p, std::size_t k, const Vec3& way) const
    {
        const Vec3 d = (p - Eigen::Map<const Vec3>(before_.data() + 4 * k)) + way;
        return d - ground_.normal * ground_.normal.dot(d);
    }

    Ground ground_;
    struct Touch {
        std::size_t point;
        double push, drag; ///< N/m, across the plane and along it
    };
    std::vector<Touch> touching_; ///< in the configuration of prepare_product
    double interval_s_ = 0;
    std::vector<double> before_; ///< per point its place when the step began, and its drag, N/m
    Reference reference_;        ///< from whose origin those places are seen
};

} // namespace

std::unique_ptr<Effect> make_ground(const Ground& ground) { return std::make_unique<GroundContact>(ground); }

} // namespace cinch
