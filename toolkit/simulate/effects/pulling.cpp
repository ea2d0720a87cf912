// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "toolkit/simulate/body_builder.hpp"
#include "toolkit/simulate/effects/effects.hpp"
#include "toolkit/simulate/json_fields.hpp"

namespace cinch {
namespace {

constexpr const char* pulling_name = "pulling";

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
        : Effect(pulling_name), pull_(std::move(pull)), share_(by_mass(body, pull_.nodes))
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
        if (!(pull_.period_s > 0))
            return pull_.force;
        return std::sin(2 * std::numbers::pi * (t - pull_.start_s) / pull_.period_s) * pull_.force;
    }
    PullingForce pull_;
    std::vector<double> share_;
};

class Target : public Effect {
public:
    Target(const MeshlessBody& body, PullingTarget pull)
        : Effect(pulling_name), pull_(std::move(pull)), share_(by_mass(body, pull_.nodes))
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

EffectPlan read_force(JsonFields& f, NodeSelection nodes)
{
    PullingForce pull;
    pull.force = f.vector("force");
    pull.start_s = f.number("start", JsonFields::not_negative(), 0);
    pull.end_s = f.number("end", JsonFields::not_negative(), std::numeric_limits<double>::infinity());
    pull.period_s = f.number("period", JsonFields::positive(), 0);
    return {[nodes, pull](BodyBuilder& body) {
        PullingForce on_body = pull;
        on_body.nodes = body.select(nodes);
        body.add(make_pulling(body.body(), std::move(on_body)));
    }};
}

EffectPlan read_target(JsonFields& f, NodeSelection nodes)
{
    EffectPlan plan;
    const double stiffness = f.number("stiffness", JsonFields::not_negative());
    plan.follows_clip = f.flag("clip", false);
    if (plan.follows_clip) {
        plan.build = [nodes, stiffness](BodyBuilder& body) {
            PullingTarget pull{body.select(nodes), stiffness, {}};
            pull.target = body.clip(pull.nodes);
            body.add(make_pulling(body.body(), std::move(pull)));
        };
        return plan;
    }
    const Vec3 offset = f.vector("offset"); // from where the node began
    const double ramp_s = f.number("ramp", JsonFields::not_negative(), 0);
    plan.build = [nodes, stiffness, offset, ramp_s](BodyBuilder& body) {
        PullingTarget pull{body.select(nodes), stiffness, {}, body.origin()};
        pull.target = [places = body.starts(pull.nodes), offset, ramp_s](std::size_t k, double t) {
            return Vec3(places[k] + (ramp_s > 0 ? std::min(1.0, t / ramp_s) : 1.0) * offset);
        };
        body.add(make_pulling(body.body(), std::move(pull)));
    };
    return plan;
}

EffectPlan read_pulling(JsonFields& f)
{
    NodeSelection nodes = read_nodes(f, "nodes");
    return f.has("stiffness") ? read_target(f, std::move(nodes)) : read_force(f, std::move(nodes));
}

} // namespace

namespace effects {
extern const EffectKind pulling{pulling_name, read_pulling, R"json([{
    "description": "a force on nodes together, spread by mass",
    "properties": {
        "nodes": {"$ref": "#/$defs/nodes"},
        "force": {"$ref": "#/$defs/vector", "description": "N"},
        "start": {"type": "number", "minimum": 0},
        "end": {"type": "number", "minimum": 0},
        "period": {"type": "number", "exclusiveMinimum": 0, "description": "s; the force swings as a sine"}
    },
    "required": ["force"],
    "example": {"nodes": "all", "force": [1, 0, 0], "start": 0, "end": 1, "period": 2}
}, {
    "description": "springs to where the nodes began plus an offset",
    "properties": {
        "nodes": {"$ref": "#/$defs/nodes"},
        "stiffness": {"type": "number", "minimum": 0, "description": "N/m, of all together"},
        "offset": {"$ref": "#/$defs/vector"},
        "ramp": {"type": "number", "minimum": 0, "description": "s until it is there [0]"},
        "clip": {"const": false}
    },
    "required": ["stiffness", "offset"],
    "example": {"nodes": {"centre": [0, 0, 0], "radius": 2}, "stiffness": 5, "offset": [0, 0, 1], "ramp": 1}
}, {
    "description": "springs to the character's clip",
    "properties": {
        "nodes": {"$ref": "#/$defs/nodes"},
        "stiffness": {"type": "number", "minimum": 0, "description": "N/m, of all together"},
        "clip": {"const": true}
    },
    "required": ["stiffness", "clip"],
    "example": {"stiffness": 5, "clip": true}
}])json"};
}

std::unique_ptr<Effect> make_pulling(const MeshlessBody& body, PullingForce pull)
{
    return std::make_unique<Force>(body, std::move(pull));
}
std::unique_ptr<Effect> make_pulling(const MeshlessBody& body, PullingTarget pull)
{
    return std::make_unique<Target>(body, std::move(pull));
}

} // namespace cinch
