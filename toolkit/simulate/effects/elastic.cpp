// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/body_builder.hpp"
#include "toolkit/simulate/effects/effects.hpp"
#include "toolkit/simulate/effects/material.hpp"
#include "toolkit/simulate/json_fields.hpp"

namespace cinch {
namespace {

EffectPlan read_elastic(JsonFields& f)
{
    const std::string model = f.text("model", "neo-hookean");
    if (model != "neo-hookean" && model != "stvk" && model != "stvk-paper")
        f.complain("model", "'" + model + "' is unknown; known are neo-hookean, stvk, stvk-paper");
    EffectPlan plan;
    const double young = plan.young = f.number("young", JsonFields::positive());
    const double poisson = f.number("poisson", {-1, 0.5, true, "a number above -1 and below 0.5"}, 0.3);
    if (poisson == 0.5)
        f.complain("poisson", "must lie below 0.5; add the effect 'volume' for what hardly changes its volume");
    if (model == "neo-hookean")
        plan.build = [young, poisson](BodyBuilder& body) { body.add(make_neo_hookean(young, poisson)); };
    else
        plan.build = [young, poisson, literal = model == "stvk-paper"](BodyBuilder& body) {
            body.add(make_stvk(young, poisson, literal));
        };
    return plan;
}

} // namespace

namespace effects {
extern const EffectKind elastic{elastic_name, read_elastic, R"json([{
    "description": "an elastic material",
    "properties": {
        "model": {"enum": ["neo-hookean", "stvk", "stvk-paper"]},
        "young": {"type": "number", "exclusiveMinimum": 0},
        "poisson": {"type": "number", "exclusiveMinimum": -1, "exclusiveMaximum": 0.5}
    },
    "required": ["young"],
    "example": {"model": "stvk", "young": 1e4, "poisson": 0.3}
}])json"};
}

} // namespace cinch
