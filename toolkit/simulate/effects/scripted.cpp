// SPDX-License-Identifier: Apache-2.0
#include <limits>

#include "toolkit/simulate/body_builder.hpp"
#include "toolkit/simulate/json_fields.hpp"

namespace cinch {
namespace {

Turning read_turning(JsonFields& f)
{
    Turning t;
    t.axis = f.direction("axis");
    t.centre = f.vector("centre", Vec3::Zero());
    if (f.has("period")) {
        t.period_s = f.number("period", JsonFields::interval());
        t.most = f.number("swing", JsonFields::any());
    } else {
        t.rate = f.number("rate", JsonFields::any());
        t.ramp_s = f.number("ramp", JsonFields::not_negative(), 0);
        t.most = f.number("until", JsonFields::not_negative(), 0);
    }
    return t;
}

// A pin of the selected nodes: make(nodes, where they begin, from where these are seen).
template <class Make> auto pin_with(NodeSelection selection, Make make)
{
    return [selection, make](BodyBuilder& body) {
        std::vector<std::uint32_t> nodes = body.select(selection);
        std::vector<Vec3> places = body.starts(nodes);
        Pin pin = make(std::move(nodes), std::move(places), body.origin());
        pin.origin = body.origin();
        body.add(std::move(pin));
    };
}

EffectPlan read_scripted(JsonFields& f)
{
    EffectPlan plan;
    const NodeSelection selection = read_nodes(f, "nodes");
    plan.follows_clip = f.flag("clip", false);
    if (plan.follows_clip) {
        plan.build = [selection](BodyBuilder& body) {
            std::vector<std::uint32_t> nodes = body.select(selection);
            BodyPath path = body.clip(nodes);
            body.add(Pin{std::move(nodes), std::move(path), [](double, double) { return 0.0; }, Vec3::Zero()});
        };
        return plan;
    }
    using Nodes = std::vector<std::uint32_t>;
    using Places = std::vector<Vec3>;
    const Vec3 velocity = f.has("velocity") ? f.vector("velocity") : Vec3(Vec3::Zero());
    Turning turning; // axis and centre in the world
    double end_s = 0;
    if (f.has("velocity"))
        end_s = f.number("end", JsonFields::not_negative(), std::numeric_limits<double>::infinity());
    else
        turning = read_turning(f);
    if (velocity.norm() > 0)
        plan.build = pin_with(selection, [velocity, end_s](Nodes nodes, Places places, const Vec3&) {
            return sliding_pin(std::move(nodes), std::move(places), velocity, end_s);
        });
    else
        plan.build = pin_with(selection, [turning](Nodes nodes, Places places, const Vec3& origin) {
            Turning seen = turning;
            seen.centre -= origin;
            return turning_pin(std::move(nodes), std::move(places), seen);
        });
    return plan;
}

} // namespace

namespace effects {
extern const EffectKind scripted{"scripted", read_scripted, R"json([{
    "description": "nodes that turn about an axis of the world at a rate",
    "properties": {
        "nodes": {"$ref": "#/$defs/nodes"},
        "axis": {"$ref": "#/$defs/vector"},
        "centre": {"$ref": "#/$defs/vector"},
        "rate": {"type": "number", "description": "rad/s"},
        "ramp": {"type": "number", "minimum": 0, "description": "s until it has that rate"},
        "until": {"type": "number", "minimum": 0, "description": "rad at which it stops [never]"}
    },
    "required": ["axis", "rate"],
    "example": {
        "nodes": {"nearest": [1, 0, 0], "count": 2}, "axis": [0, 0, 1], "centre": [0, 0, 0],
        "rate": 1, "ramp": 1, "until": 2
    }
}, {
    "description": "nodes that swing about an axis of the world",
    "properties": {
        "nodes": {"$ref": "#/$defs/nodes"},
        "axis": {"$ref": "#/$defs/vector"},
        "centre": {"$ref": "#/$defs/vector"},
        "period": {"type": "number", "minimum": 1e-30, "maximum": 1e+30},
        "swing": {"type": "number", "description": "rad"}
    },
    "required": ["axis", "period", "swing"],
    "example": {"nodes": {"index": [0]}, "axis": [0, 1, 0], "centre": [0, 0, 1], "period": 2, "swing": 0.5}
}, {
    "description": "nodes that move",
    "properties": {
        "nodes": {"$ref": "#/$defs/nodes"},
        "velocity": {"$ref": "#/$defs/vector"},
        "end": {"type": "number", "minimum": 0}
    },
    "required": ["velocity"],
    "example": {"nodes": {"box": [[-1, -1, -1], [0.01, 0.01, 1]]}, "velocity": [0, 0, 1], "end": 1}
}, {
    "description": "nodes that follow the character's clip",
    "properties": {"nodes": {"$ref": "#/$defs/nodes"}, "clip": {"const": true}},
    "required": ["clip"],
    "example": {"clip": true}
}])json"};
}

} // namespace cinch
