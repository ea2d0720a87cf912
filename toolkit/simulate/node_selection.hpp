// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "toolkit/surface/triangle_mesh.hpp"

namespace cinch {

class JsonFields;

/// Which nodes of a body, by their place at rest (m, before the body is placed in the world).
struct EveryNode {};
struct NodesInBox {
    Vec3 low, high;
};
struct NodesInBall {
    Vec3 centre;
    double radius;
};
struct NodesByIndex {
    std::vector<std::uint32_t> index;
};
struct NearestNodes {
    Vec3 point;
    std::size_t count;
};
using NodeSelection = std::variant<EveryNode, NodesInBox, NodesInBall, NodesByIndex, NearestNodes>;

/// A selection in a scene: "all" where the field is missing. Throws InputError.
NodeSelection read_nodes(JsonFields& parent, const std::string& key);
/// Of the schema of scenes: how it is written.
extern const char* const node_selection_schema;

/// Indices of the nodes, ascending. Throws InputError, with file and path of what selects, if there are none, or one
/// that is not there.
std::vector<std::uint32_t> select_nodes(const NodeSelection& selection, std::span<const Vec3> nodes,
                                        const std::string& file, const std::string& path, const std::string& body);

} // namespace cinch
