// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/body_builder.hpp"
#include "toolkit/simulate/json_fields.hpp"

namespace cinch {
namespace {

EffectPlan read_pinned(JsonFields& f)
{
    return {[selection = read_nodes(f, "nodes")](BodyBuilder& body) {
        std::vector<std::uint32_t> nodes = body.select(selection);
        std::vector<Vec3> places = body.starts(nodes);
        Pin pin = fixed_pin(std::move(nodes), std::move(places));
        pin.origin = body.origin();
        body.add(std::move(pin));
    }};
}

} // namespace

namespace effects {
extern const EffectKind pinned{"pinned", read_pinned, R"json([{
    "description": "nodes that stay",
    "properties": {"nodes": {"$ref": "#/$defs/nodes"}},
    "example": {"nodes": {"index": [0, 1]}}
}])json"};
}

} // namespace cinch
