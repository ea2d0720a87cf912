// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/node_selection.hpp"

#include <algorithm>
#include <numeric>

#include <nlohmann/json.hpp>

#include "toolkit/simulate/json_fields.hpp"

namespace cinch {

NodeSelection read_nodes(JsonFields& parent, const std::string& key)
{
    const JsonFields::Json* json = parent.find(key);
    if (!json || *json == "all")
        return EveryNode{};
    JsonFields f(*json, parent.file(), parent.place(key));
    NodeSelection selection;
    if (f.has("box")) {
        const JsonFields::Json& box = f.need("box");
        if (!box.is_array() || box.size() != 2)
            f.fail("box", "two corners", box);
        selection = NodesInBox{f.vector_of("box/0", box[0]), f.vector_of("box/1", box[1])};
    } else if (f.has("centre")) {
        const Vec3 centre = f.vector("centre");
        selection = NodesInBall{centre, f.number("radius", JsonFields::positive())};
    } else if (f.has("index")) {
        NodesByIndex nodes;
        const JsonFields::Json& all = f.array("index");
        for (std::size_t i = 0; i < all.size(); ++i)
            nodes.index.push_back(
                static_cast<std::uint32_t>(f.count_of("index/" + std::to_string(i), all[i], 0, 1u << 30)));
        selection = nodes;
    } else if (f.has("nearest")) {
        const Vec3 point = f.vector("nearest");
        selection = NearestNodes{point, f.count("count", 1, 1u << 30, 1)};
    } else {
        f.complain("", "expected \"all\", or an object with box, centre and radius, index, or nearest");
    }
    f.finish();
    return selection;
}

const char* const node_selection_schema = R"json({
    "description": "simulation nodes by their place at rest, before the body is placed in the world [all]",
    "oneOf": [
        {"const": "all"},
        {
            "type": "object",
            "properties": {"box": {"type": "array", "items": {"$ref": "#/$defs/vector"}, "minItems": 2, "maxItems": 2}},
            "additionalProperties": false,
            "required": ["box"]
        },
        {
            "type": "object",
            "properties": {"centre": {"$ref": "#/$defs/vector"}, "radius": {"type": "number", "exclusiveMinimum": 0}},
            "additionalProperties": false,
            "required": ["centre", "radius"]
        },
        {
            "type": "object",
            "properties": {"index": {"type": "array", "items": {"type": "integer", "minimum": 0}}},
            "additionalProperties": false,
            "required": ["index"]
        },
        {
            "type": "object",
            "properties": {"nearest": {"$ref": "#/$defs/vector"}, "count": {"type": "integer", "minimum": 1}},
            "additionalProperties": false,
            "required": ["nearest"]
        }
    ]
})json";

std::vector<std::uint32_t> select_nodes(const NodeSelection& selection, std::span<const Vec3> nodes,
                                        const std::string& file, const std::string& path, const std::string& body)
{
    std::vector<std::uint32_t> chosen;
    auto where = [&](auto&& inside) {
        for (std::size_t i = 0; i < nodes.size(); ++i)
            if (inside(nodes[i]))
                chosen.push_back(static_cast<std::uint32_t>(i));
    };
    if (std::holds_alternative<EveryNode>(selection)) {
        where([](const Vec3&) { return true; });
    } else if (const auto* in_box = std::get_if<NodesInBox>(&selection)) {
        where([&](const Vec3& p) {
            return (p.array() >= in_box->low.array()).all() && (p.array() <= in_box->high.array()).all();
        });
    } else if (const auto* ball = std::get_if<NodesInBall>(&selection)) {
        where([&](const Vec3& p) { return (p - ball->centre).norm() <= ball->radius; });
    } else if (const auto* index = std::get_if<NodesByIndex>(&selection)) {
        for (const std::uint32_t i : index->index) {
            if (i >= nodes.size())
                throw InputError::in_file(file, path + "/nodes/index: body '" + body + "' has simulation nodes 0 to " +
                                                    std::to_string(nodes.size() - 1) + ", not " + std::to_string(i));
            chosen.push_back(i);
        }
        std::sort(chosen.begin(), chosen.end());
        chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
    } else if (const auto* near = std::get_if<NearestNodes>(&selection)) {
        std::vector<std::uint32_t> order(nodes.size());
        std::iota(order.begin(), order.end(), 0u);
        std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
            return (nodes[a] - near->point).squaredNorm() < (nodes[b] - near->point).squaredNorm();
        });
        order.resize(std::min(order.size(), near->count));
        std::sort(order.begin(), order.end());
        chosen = order;
    }
    if (chosen.empty())
        throw InputError::in_file(file, path + "/nodes: selects no simulation node of body '" + body + "'");
    return chosen;
}

} // namespace cinch
