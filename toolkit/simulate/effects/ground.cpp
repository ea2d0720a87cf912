// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "toolkit/simulate/body_builder.hpp"
#include "toolkit/simulate/contact_points.hpp"
#include "toolkit/simulate/effects/effects.hpp"
#include "toolkit/simulate/json_fields.hpp"

namespace cinch {
namespace {

constexpr const char* ground_name = "ground";

constexpr double slow = 5e-4; // see Ground

// ∛v of v > 0, by way of [1, 8): the library's rounding is not the same for all powers of 8.
double cube_root(double v)
{
    const int thirds = static_cast<int>(std::floor(std::ilogb(v) / 3.0));
    return std::ldexp(std::cbrt(std::ldexp(v, -3 * thirds)), thirds);
}

// Friction is a drag μ N / ‖slip of the last step‖ on the slip of this one, by which it reaches Coulomb's force where
// things slide steadily and holds where they rest: below a slow speed. Remembered are, per point, its place when the
// step began, and its drag, N/m.
class GroundContact : public Effect {
public:
    explicit GroundContact(const Ground& ground)
        : Effect(ground_name), ground_(ground),
          points_(ground.at_nodes ? ContactPoints::Of::nodes : ContactPoints::Of::surface)
    {
        ground_.normal.normalize();
    }

    bool needs_deformation() const override { return !ground_.at_nodes; }
    double energy(const Configuration& c) const override
    {
        double sum = 0;
        each_contact(c, [&](std::size_t k, const Vec3& p, double depth) {
            sum += 0.5 * stiffness(c) * depth * depth;
            if (const double f = drag(c, k); f > 0)
                sum += 0.5 * f * slip(c, p, k).squaredNorm();
        });
        return sum;
    }
    void add_forces(const Configuration& c, Forces out) const override
    {
        each_contact(c, [&](std::size_t k, const Vec3& p, double depth) {
            Vec3 f = stiffness(c) * depth * ground_.normal;
            if (const double d = drag(c, k); d > 0)
                f -= d * slip(c, p, k);
            points_.add_force(c, k, f, out);
        });
    }
    bool couples_nodes() const override { return true; }
    void find_touching(const Configuration& c, bool worst, std::vector<Touch>& touching) const override
    {
        if (worst) // anything may touch within the steps to come
            for (std::size_t k = 0; k < points_.count(c); ++k)
                touching.push_back({k, stiffness(c), 0});
        else
            each_contact(c, [&](std::size_t k, const Vec3&, double depth) {
                touching.push_back({k, depth > 0 ? stiffness(c) : 0, drag(c, k)});
            });
    }
    void add_product(const Configuration& c, std::span<const Touch> touching, const Field& dx, const MatrixField& dj,
                     Forces out) const override
    {
        for (const Touch& t : touching) {
            const Vec3 dp = points_.change(c, t.point, dx, dj), along = ground_.normal * ground_.normal.dot(dp);
            points_.add_force(c, t.point, -t.push * along - t.drag * (dp - along), out);
        }
    }
    void add_diagonal(const Configuration& c, std::span<const Touch> touching, std::vector<Mat3>& block) const override
    {
        const Mat3 along = ground_.normal * ground_.normal.transpose();
        for (const Touch& t : touching) {
            const Mat3 push = t.push * along + t.drag * (Mat3::Identity() - along);
            points_.each_weight(c, t.point,
                                [&](std::uint32_t i, double weight) { block[i] += weight * weight * push; });
        }
    }
    /// As the drag does for an explicit step: force by velocity, c = μ N / speed.
    void add_damping(const Configuration& c, Curvature out) const override
    {
        each_load(c, [&](std::uint32_t i, double load) { out.block[i].diagonal().array() += load; });
    }
    /// Friction must not turn a slip around: c Δt ≤ m of every node.
    double longest_step(const Configuration& c) const override
    {
        double longest = std::numeric_limits<double>::infinity();
        std::vector<double> load; // of each node by all points
        each_load(c, [&](std::uint32_t i, double by_point) {
            load.resize(c.body.size(), 0);
            load[i] += by_point;
        });
        for (std::size_t i = 0; i < load.size(); ++i)
            if (load[i] > 0)
                longest = std::min(longest, c.body.mass[i] / load[i]);
        return longest;
    }
    void remember(const Configuration& c, double dt_s, Memory& memory) const override
    {
        if (ground_.friction == 0)
            return;
        const std::size_t count = points_.count(c);
        Memory next{Field(4 * count, 0), c.reference, dt_s};
        double held = 0; // N
        for (std::size_t k = 0; k < count; ++k) {
            const Vec3 p = points_.place(c, k);
            at(next.values, k) = p;
            next.values[4 * k + 3] = std::max(0.0, depth(c, p));
            held += stiffness(c) * next.values[4 * k + 3];
        }
        double mass = 0, volume = 0;
        for (std::size_t i = 0; i < c.body.size(); ++i) {
            mass += c.body.mass[i];
            volume += c.body.volume[i];
        }
        const double slow_m_per_s = slow * std::sqrt(held / mass * cube_root(volume));
        const bool first = c.remembered().values.empty();
        for (std::size_t k = 0; k < count; ++k)
            if (double& drag = next.values[4 * k + 3]; drag > 0)
                drag = first ? 0
                             : ground_.friction * stiffness(c) * drag /
                                   std::max(slip(c, at(next.values, k), k).norm(), slow_m_per_s * dt_s);
        memory = std::move(next);
    }

private:
    double depth(const Configuration& c, const Vec3& p) const
    {
        return ground_.normal.dot(c.reference.relative(ground_.point) - p);
    }
    // What is below the plane, and what still rubs against it: depth ≥ 0.
    template <class Visit> void each_contact(const Configuration& c, const Visit& visit) const
    {
        const std::size_t count = points_.count(c);
        for (std::size_t k = 0; k < count; ++k) {
            const Vec3 p = points_.place(c, k);
            if (const double below = depth(c, p); below > 0 || drag(c, k) > 0)
                visit(k, p, std::max(below, 0.0));
        }
    }
    // N s/m on the nodes of every point that rubs. By rows: weights sum to 1, and what acts through J comes on top.
    template <class Visit> void each_load(const Configuration& c, const Visit& visit) const
    {
        const Memory& before = c.remembered();
        const double share = points_.share_of_stresses(c);
        for (std::size_t k = 0; k < before.values.size() / 4; ++k)
            if (const double damping = drag(c, k) * before.interval_s; damping != 0)
                points_.each_weight(c, k, [&](std::uint32_t i, double weight) { visit(i, share * weight * damping); });
    }
    double stiffness(const Configuration& c) const { return ground_.stiffness / static_cast<double>(points_.count(c)); }
    static double drag(const Configuration& c, std::size_t k)
    {
        const Memory& before = c.remembered();
        return before.values.empty() ? 0 : before.values[4 * k + 3];
    }
    Vec3 slip(const Configuration& c, const Vec3& p, std::size_t k) const
    {
        const Memory& before = c.remembered();
        const Vec3 d = (p - at(before.values, k)) + before.reference.way_to(c.reference);
        return d - ground_.normal * ground_.normal.dot(d);
    }

    Ground ground_;
    ContactPoints points_;
};

EffectPlan read_ground(JsonFields& f)
{
    Ground ground;
    ground.point = f.vector("point", Vec3::Zero());
    ground.normal = f.has("normal") ? f.direction("normal") : Vec3::UnitZ();
    ground.stiffness = f.number("stiffness", JsonFields::not_negative());
    ground.friction = f.number("friction", JsonFields::not_negative(), 0);
    const std::string at = f.text("at", "surface");
    if (at != "surface" && at != "nodes")
        f.complain("at", "'" + at + "' is unknown; known are surface, nodes");
    ground.at_nodes = at == "nodes";
    return {[ground](BodyBuilder& body) { body.add(make_ground(ground)); }};
}

} // namespace

namespace effects {
extern const EffectKind ground{ground_name, read_ground, R"json([{
    "description": "a plane that pushes back",
    "properties": {
        "point": {"$ref": "#/$defs/vector"},
        "normal": {"$ref": "#/$defs/vector"},
        "stiffness": {"type": "number", "minimum": 0, "description": "N/m, of the whole body"},
        "friction": {"type": "number", "minimum": 0},
        "at": {"enum": ["surface", "nodes"]}
    },
    "required": ["stiffness"],
    "example": {"point": [0, 0, 0], "normal": [0, 0, 1], "stiffness": 5, "friction": 0.1, "at": "nodes"}
}])json"};
}

std::unique_ptr<Effect> make_ground(const Ground& ground) { return std::make_unique<GroundContact>(ground); }

} // namespace cinch
