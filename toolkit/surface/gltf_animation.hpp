// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "toolkit/surface/gltf_scene.hpp"

namespace cinch {

/// A mesh with morph targets that the scene draws, by a node.
struct GltfMorph {
    std::size_t node = 0, mesh = 0;
    std::size_t targets = 0;
    std::vector<char> moves;     ///< whether a target displaces positions
    std::vector<double> weights; ///< where no animation sets them: the node's, or the mesh's

    /// Whether `all` (weights of the targets, one set after the other) move a vertex.
    bool moved_by(const std::vector<double>& all) const;
};

/// All animations of the file, each with what it misses or why it cannot be used; and the rest pose.
void read_animations(GltfDocument& document, const GltfSkeleton& skeleton, const std::vector<GltfMorph>& morphs,
                     Character& out);

} // namespace cinch
