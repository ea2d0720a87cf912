// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/read_scene.hpp"

#include <nlohmann/json.hpp>

namespace cinch {

Integration read_integration(JsonFields& scene, double frame_s)
{
    Integration integration;
    integration.step_s = frame_s;
    const JsonFields::Json* json = scene.find("integrator");
    if (!json)
        return integration;
    JsonFields f(*json, scene.file(), scene.place("integrator"));
    const std::string method = f.text("method", "implicit");
    if (method != "implicit" && method != "explicit")
        f.complain("method", "'" + method + "' is unknown; known are implicit, explicit");
    if (method == "explicit")
        integration.method = Integration::Method::explicit_euler;
    integration.step_s = f.number("step", JsonFields::interval(), integration.step_s);
    if (method == "explicit") {
        const JsonFields::Range share{0, 1, true, "a number above 0 and at most 1"};
        integration.safety = f.number("safety", share, integration.safety);
    } else {
        integration.tolerance = f.number("tolerance", JsonFields::positive(), integration.tolerance);
        const auto most = static_cast<std::size_t>(integration.most_iterations);
        integration.most_iterations = static_cast<int>(f.count("iterations", 1, 100000, most));
    }
    f.finish();
    return integration;
}

const char* const integrator_schema = R"json({
    "oneOf": [
        {
            "type": "object",
            "properties": {
                "method": {"const": "implicit"},
                "step": {
                    "type": "number",
                    "minimum": 1e-30,
                    "maximum": 1e+30,
                    "description": "longest step [the frame]"
                },
                "tolerance": {
                    "type": "number",
                    "exclusiveMinimum": 0,
                    "description":
                        "greatest error of an acceleration that is left, over the greatest acceleration [1e-5]"
                },
                "iterations": {"type": "integer", "minimum": 1, "maximum": 100000}
            },
            "additionalProperties": false
        },
        {
            "type": "object",
            "properties": {
                "method": {"const": "explicit"},
                "step": {
                    "type": "number",
                    "minimum": 1e-30,
                    "maximum": 1e+30,
                    "description": "longest substep [the frame]"
                },
                "safety": {
                    "type": "number",
                    "exclusiveMinimum": 0,
                    "maximum": 1,
                    "description": "share of the longest stable substep [0.6]"
                }
            },
            "additionalProperties": false,
            "required": ["method"]
        }
    ]
})json";

} // namespace cinch
