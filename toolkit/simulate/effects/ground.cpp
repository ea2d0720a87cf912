// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <vector>

#include "toolkit/simulate/effects/effects.hpp"
#include "toolkit/simulate/stream.hpp"
#include "toolkit/simulate/surface_force.hpp"

namespace cinch {
namespace {

// What touches the ground: the vertices of the surface, or the nodes of a body that has none.
class GroundContact : public Effect {
public:
    explicit GroundContact(const Ground& ground) : Effect("ground"), ground_(ground) { ground_.normal.normalize(); }

    bool needs_deformation() const override { return !ground_.at_nodes; }
    double energy(const Configuration& given) const override
    {
        const Configuration c = seen(given);
        double sum = 0;
        each_contact(c, [&](std::size_t k, const Vec3& p, double depth) {
            sum += 0.5 * stiffness(c) * depth * depth;
            if (const double f = drag(k); f > 0)
                sum += 0.5 * f * slip(p, k).squaredNorm();
        });
        return sum;
    }
    void add_forces(const Configuration& given, Forces out) const override
    {
        const Configuration c = seen(given);
        each_contact(c, [&](std::size_t k, const Vec3& p, double depth) {
            Vec3 f = stiffness(c) * depth * ground_.normal;
            if (const double d = drag(k); d > 0)
                f -= d * slip(p, k);
            add_point_force(c, k, f, out);
        });
    }
    bool couples_nodes() const override { return true; }
    void prepare_product(const Configuration& given) override
    {
        const Configuration c = seen(given);
        touching_.clear();
        each_contact(c, [&](std::size_t k, const Vec3&, double) { touching_.push_back(k); });
    }
    void add_product(const Configuration& given, const Field& dx, const MatrixField& dj, Forces out) const override
    {
        const Configuration c = seen(given);
        for (const std::size_t k : touching_) {
            const Vec3 dp = point_change(c, k, dx, dj), along = ground_.normal * ground_.normal.dot(dp);
            add_point_force(c, k, -stiffness(c) * along - drag(k) * (dp - along), out);
        }
    }
    void add_diagonal(const Configuration& given, std::vector<Mat3>& block) const override
    {
        const Configuration c = seen(given);
        const Mat3 along = ground_.normal * ground_.normal.transpose();
        for (const std::size_t k : touching_) {
            const Mat3 push = stiffness(c) * along + drag(k) * (Mat3::Identity() - along);
            if (!c.surface) {
                block[k] += push;
                continue;
            }
            const Weights::Row row = c.surface->weights.of(k);
            for (std::size_t e = 0; e < row.node.size(); ++e)
                block[row.node[e]] += row.weight[e] * row.weight[e] * push;
        }
    }
    /// Friction: a drag μ N / ‖slip of the last step‖ on the slip of this one, by which it reaches Coulomb's force where things slide
    /// steadily and holds where they rest.
    void remember(const Configuration& given, double) override
    {
        const Configuration c = seen(given);
        if (ground_.friction == 0)
            return;
        const std::size_t count = points_of(c);
        std::vector<double> next(4 * count, 0);
        for (std::size_t k = 0; k < count; ++k) {
            const Vec3 p = point(c, k);
            std::copy_n(p.data(), 3, next.data() + 4 * k);
            const double depth = ground_.normal.dot(ground_.point - p);
            if (depth > 0 && !before_.empty()) {
                const double size = std::max(slip(p, k).norm(), 1e-4 * c.body.spacing);
                next[4 * k + 3] = ground_.friction * stiffness(c) * depth / size;
            }
        }
        before_ = std::move(next);
    }
    void save(std::ostream& out) const override
    {
        const std::size_t count = before_.size();
        write_raw<std::size_t>(out, {&count, 1});
        write_raw<double>(out, before_);
    }
    void restore(std::istream& in) override
    {
        std::size_t count = 0;
        read_raw<std::size_t>(in, {&count, 1});
        before_.resize(count);
        read_raw<double>(in, before_);
    }

private:
    Configuration seen(const Configuration& c) const { return {c.body, ground_.at_nodes ? nullptr : c.surface, c.x, c.gradient, c.deformation, c.plastic_inverse, c.time_s}; }
    template <class Visit> void each_contact(const Configuration& c, const Visit& visit) const
    {
        const std::size_t count = points_of(c);
        for (std::size_t k = 0; k < count; ++k) {
            const Vec3 p = point(c, k);
            if (const double depth = ground_.normal.dot(ground_.point - p); depth > 0)
                visit(k, p, depth);
        }
    }
    double stiffness(const Configuration& c) const { return ground_.stiffness / static_cast<double>(points_of(c)); }
    double drag(std::size_t k) const { return before_.empty() ? 0 : before_[4 * k + 3]; }
    Vec3 slip(const Vec3& p, std::size_t k) const
    {
        const Vec3 d = p - Eigen::Map<const Vec3>(before_.data() + 4 * k);
        return d - ground_.normal * ground_.normal.dot(d);
    }

    Ground ground_;
    std::vector<std::size_t> touching_; ///< in the configuration of prepare_product
    std::vector<double> before_; ///< per point its place when the step began, and its drag, N/m
};

} // namespace

std::unique_ptr<Effect> make_ground(const Ground& ground) { return std::make_unique<GroundContact>(ground); }

} // namespace cinch
