// SPDX-License-Identifier: Apache-2.0
#include <filesystem>

#include <nlohmann/json.hpp>

#include "toolkit/simulate/read_scene.hpp"

namespace cinch {
namespace {

using Json = JsonFields::Json;

// Also of file names.
constexpr const char* name_characters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.";
constexpr std::size_t most_nodes = 20000; // of a body

std::array<int, 3> read_cells(JsonFields& f, const std::string& key)
{
    const Json& json = f.array(key);
    if (json.size() != 3)
        f.fail(key, "an array of 3 whole numbers", json);
    std::array<int, 3> cells{};
    for (std::size_t i = 0; i < 3; ++i)
        cells[i] = static_cast<int>(f.count_of(key + "/" + std::to_string(i), json[i], 1, 1000));
    return cells;
}

} // namespace

SceneBody read_body(const Json& json, const std::string& file, const std::string& folder, std::size_t index)
{
    SceneBody body;
    body.path = "/bodies/" + std::to_string(index);
    JsonFields f(json, file, body.path);
    body.name = f.text("name", "body-" + std::to_string(index));
    if (body.name.empty() || body.name.size() > 64 || body.name[0] == '.' ||
        body.name.find_first_not_of(name_characters) != std::string::npos)
        f.complain("name", "must be 1 to 64 letters, digits, '-', '_' or '.', not beginning with '.'");
    body.surface = f.text("surface");
    if (std::filesystem::path(body.surface).has_extension() && std::filesystem::path(body.surface).is_relative())
        body.surface = (std::filesystem::path(folder) / body.surface).string();
    if (body.surface == "box" || body.surface == "sheet") {
        body.box_m = f.vector("box");
        for (int r = 0; r < 3; ++r)
            if (!(r == 2 && body.surface == "sheet" && body.box_m[r] == 0))
                f.number_of("box/" + std::to_string(r), f.need("box")[static_cast<std::size_t>(r)],
                            JsonFields::length());
        body.cells = read_cells(f, "cells");
        const double x = body.cells[0], y = body.cells[1], z = body.cells[2];
        if (x * y + y * z + z * x > 1e6)
            f.complain("cells", "makes more than four million triangles");
        if (body.surface == "sheet")
            body.thickness_m = f.number("thickness", JsonFields::length());
    } else {
        body.size_m = f.number("size", JsonFields::length(), 0);
    }
    const int ways = f.has("nodes") + f.has("lattice") + f.has("places");
    if (ways != 1)
        f.complain("", "needs one of nodes (how many), lattice (cells of a box) and places (positions)");
    if (f.has("lattice")) {
        if (body.surface != "box" && body.surface != "sheet")
            f.complain("lattice", "needs the surface box or sheet");
        body.lattice = read_cells(f, "lattice");
        if (double(body.lattice[0]) * body.lattice[1] * body.lattice[2] > most_nodes)
            f.complain("lattice", "makes more than 20,000 simulation nodes");
    } else if (f.has("places")) {
        const Json& places = f.array("places");
        if (places.empty() || places.size() > most_nodes)
            f.complain("places", "must have 1 to 20,000 of them");
        for (std::size_t i = 0; i < places.size(); ++i)
            body.places.push_back(f.vector_of("places/" + std::to_string(i), places[i]));
    } else {
        body.nodes = f.count("nodes", 1, most_nodes);
    }
    body.seed = f.count("seed", 0, std::size_t(1) << 53, 0);
    body.meshless.density = f.number("density", JsonFields::positive(), 1000);
    body.meshless.support_factor = f.number("support", JsonFields::positive(), MeshlessOptions().support_factor);
    body.meshless.support_radius = f.number("support_radius", JsonFields::positive(), 0);
    body.meshless.nearest = static_cast<int>(f.count("nearest", 1, 1000, 10));
    const std::string volumes = f.text("volumes", "cells");
    if (volumes != "cells" && volumes != "density")
        f.complain("volumes", "'" + volumes + "' is unknown; known are cells, density");
    body.volume_by_density = volumes == "density";
    body.position = f.vector("position", Vec3::Zero());
    body.velocity = f.vector("velocity", Vec3::Zero());
    body.spin = f.vector("spin", Vec3::Zero());
    if (const Json* rotation = f.find("rotation")) {
        JsonFields r(*rotation, file, f.place("rotation"));
        body.axis = r.direction("axis");
        body.angle_deg = r.number("degrees", JsonFields::any());
        r.finish();
    }
    body.clip = f.text("clip", "");
    f.finish();
    return body;
}

const char* const body_schema = R"json({
    "type": "object",
    "properties": {
        "name": {"type": "string", "pattern": "^[A-Za-z0-9_-][A-Za-z0-9_.-]{0,63}$"},
        "surface": {
            "type": "string",
            "description": "a shape (brain, fish, ...), box, sheet, or a mesh or character file, relative to this one"
        },
        "size": {
            "type": "number",
            "minimum": 1e-30,
            "maximum": 1e+30,
            "description": "longest half-extent to which a mesh is centred and scaled [as the file has it]"
        },
        "box": {
            "type": "array",
            "items": {"type": "number", "minimum": 0, "maximum": 1e+30},
            "minItems": 3,
            "maxItems": 3,
            "description": "edge lengths of a box, or of a sheet (the third 0)"
        },
        "cells": {"$ref": "#/$defs/cells", "description": "into which the sides of a box are cut"},
        "thickness": {"type": "number", "minimum": 1e-30, "maximum": 1e+30, "description": "of a sheet"},
        "nodes": {
            "type": "integer",
            "minimum": 1,
            "maximum": 20000,
            "description": "simulation nodes sampled in the volume"
        },
        "lattice": {
            "$ref": "#/$defs/cells",
            "description": "simulation nodes at the centres of so many cells of a box"
        },
        "places": {
            "type": "array",
            "items": {"$ref": "#/$defs/vector"},
            "minItems": 1,
            "maxItems": 20000,
            "description": "simulation nodes, given"
        },
        "seed": {"type": "integer", "minimum": 0},
        "density": {"type": "number", "exclusiveMinimum": 0, "description": "kg/m3 [1000]"},
        "support": {
            "type": "number",
            "exclusiveMinimum": 0,
            "description": "support radius over the mean distance to the nearest nodes [1.75]"
        },
        "support_radius": {"type": "number", "exclusiveMinimum": 0, "description": "of every node, instead"},
        "nearest": {"type": "integer", "minimum": 1, "maximum": 1000, "description": "so many nearest nodes [10]"},
        "volumes": {
            "enum": ["cells", "density"],
            "description": "of the nodes: of the space nearest to each, or from their density as in the paper [cells]"
        },
        "position": {"$ref": "#/$defs/vector"},
        "velocity": {"$ref": "#/$defs/vector", "description": "m/s"},
        "spin": {"$ref": "#/$defs/vector", "description": "rad/s"},
        "rotation": {
            "type": "object",
            "properties": {"axis": {"$ref": "#/$defs/vector"}, "degrees": {"type": "number"}},
            "additionalProperties": false,
            "required": ["axis", "degrees"]
        },
        "clip": {"type": "string", "description": "of a character [the first]"}
    },
    "additionalProperties": false,
    "required": ["surface"],
    "oneOf": [{"required": ["nodes"]}, {"required": ["lattice"]}, {"required": ["places"]}],
    "allOf": [
        {
            "if": {"properties": {"surface": {"enum": ["box", "sheet"]}}},
            "then": {"required": ["box", "cells"], "not": {"required": ["size"]}},
            "else": {"not": {"anyOf": [{"required": ["box"]}, {"required": ["cells"]}, {"required": ["lattice"]}]}}
        },
        {
            "if": {"properties": {"surface": {"const": "sheet"}}},
            "then": {"required": ["thickness"]},
            "else": {"not": {"required": ["thickness"]}}
        }
    ]
})json";

} // namespace cinch
