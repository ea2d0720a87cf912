// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "toolkit/surface/gltf_morph.hpp"
#include "toolkit/surface/gltf_scene.hpp"

namespace cinch {

/// All animations of the file, each with what it misses or why it cannot be used; and the rest pose.
void read_animations(GltfDocument& document, const GltfSkeleton& skeleton, const std::vector<GltfMorph>& morphs,
                     Morphs with_morphs, Character& out);

} // namespace cinch
