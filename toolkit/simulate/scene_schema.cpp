// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "toolkit/simulate/node_selection.hpp"
#include "toolkit/simulate/read_scene.hpp"

namespace cinch {
namespace {

using Json = nlohmann::ordered_json;

// What is no part's own.
const char* const frame = R"json({
    "$schema": "https://json-schema.org/draft/2020-12/schema",
    "title": "A scene of cinch",
    "description": "Lengths in m, times in s, masses in kg, stiffnesses in Pa unless it says otherwise.",
    "type": "object",
    "properties": {
        "$schema": {"type": "string"},
        "name": {"type": "string"},
        "about": {"type": "string"},
        "duration": {
            "type": "number",
            "minimum": 0,
            "description": "seconds to simulate; at most a million frames"
        },
        "frame": {
            "type": "number",
            "minimum": 1e-30,
            "maximum": 1e+30,
            "description": "seconds from frame to frame [1/60]"
        },
        "integrator": {},
        "bodies": {"type": "array", "minItems": 1, "items": {"$ref": "#/$defs/body"}},
        "effects": {"type": "array", "items": {"$ref": "#/$defs/effect"}}
    },
    "additionalProperties": false,
    "required": ["duration", "bodies", "effects"],
    "$defs": {
        "vector": {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3},
        "cells": {
            "type": "array",
            "items": {"type": "integer", "minimum": 1, "maximum": 1000},
            "minItems": 3,
            "maxItems": 3
        },
        "bodies": {
            "type": "array",
            "items": {"type": "string"},
            "minItems": 1,
            "description": "names of the bodies that it acts on [all]"
        },
        "nodes": {},
        "body": {},
        "effect": {"oneOf": []}
    }
})json";

std::string key_of(const Json& object, const std::string& key)
{
    return object.is_object() ? Json(key).dump() + ": " : "";
}

std::string in_one_line(const Json& json)
{
    if (!json.is_structured())
        return json.dump();
    std::string line;
    for (const auto& [key, value] : json.items())
        line += (line.empty() ? "" : ", ") + key_of(json, key) + in_one_line(value);
    return json.is_object() ? "{" + line + "}" : "[" + line + "]";
}

// In lines of at most 120 columns, where parts allow it, each as long as it can be. `used`: columns before it and after
// it.
std::string in_lines(const Json& json, std::size_t indent, std::size_t used)
{
    std::string line = in_one_line(json);
    if (!json.is_structured() || json.empty() || used + line.size() <= 120)
        return line;
    const std::string margin(indent + 2, ' ');
    std::string lines;
    for (const auto& [key, value] : json.items()) {
        const std::string name = margin + key_of(json, key);
        lines += (lines.empty() ? "\n" : ",\n") + name + in_lines(value, indent + 2, name.size() + 1);
    }
    lines += "\n" + std::string(indent, ' ');
    return json.is_object() ? "{" + lines + "}" : "[" + lines + "]";
}

Json form_of(const EffectKind& kind, const Json& own)
{
    Json form{{"type", "object"},
              {"properties", {{"effect", {{"const", kind.name}}}, {"bodies", {{"$ref", "#/$defs/bodies"}}}}},
              {"additionalProperties", false},
              {"required", Json::array({"effect"})},
              {"description", own.at("description")}};
    form["properties"].update(own.at("properties"));
    if (own.contains("required"))
        form["required"].insert(form["required"].end(), own["required"].begin(), own["required"].end());
    Json example{{"effect", kind.name}};
    example.update(own.at("example"));
    form["examples"] = Json::array({example});
    return form;
}

} // namespace

std::string scene_schema()
{
    Json schema = Json::parse(frame);
    schema["properties"]["integrator"] = Json::parse(integrator_schema);
    schema["$defs"]["nodes"] = Json::parse(node_selection_schema);
    schema["$defs"]["body"] = Json::parse(body_schema);
    for (const EffectKind* kind : effect_kinds())
        for (const Json& form : Json::parse(kind->forms))
            schema["$defs"]["effect"]["oneOf"].push_back(form_of(*kind, form));
    return in_lines(schema, 0, 0) + "\n";
}

} // namespace cinch
