// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "toolkit/surface/gltf_extensions.hpp"

namespace cinch {

/// A mesh with morph targets that the scene draws, by a node.
struct GltfMorph {
    std::size_t node = 0, mesh = 0;
    std::size_t targets = 0;
    std::vector<char> moves;        ///< whether a target displaces positions
    std::vector<double> weights;    ///< where no animation sets them: the node's, or the mesh's
    std::uint32_t first_target = 0; ///< in Character::targets, where they are read

    /// Whether `all` (weights of the targets, one set after the other) move a vertex.
    bool moved_by(const std::vector<double>& all) const;
};

/// Attributes that are read, or cannot move a vertex: those of shading, and an application's own.
bool is_known_attribute(const std::string& name);

/// The targets of a mesh as a node draws it; those of primitives without positions count for nothing.
GltfMorph read_morph(const GltfValue& node, std::size_t node_index, const GltfValue& mesh);

/// By which of a primitive's targets a vertex is displaced, and how far: ascending, none of them 0.
using Displacements = std::vector<std::pair<std::uint32_t, std::array<double, 3>>>;
/// Of each of a primitive's vertices; target i of the primitive is first + i.
std::vector<Displacements> read_displacements(GltfDocument& document, const GltfValue& primitive, std::size_t vertices,
                                              std::uint32_t first, Missing& missing);

} // namespace cinch
