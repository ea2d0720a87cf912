// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "toolkit/surface/character.hpp"
#include "toolkit/surface/gltf_extensions.hpp"

namespace cinch {

/// Draws a node's mesh at many places of the node's own space.
inline constexpr const char* instancing = "EXT_mesh_gpu_instancing";

/// What a file's default scene draws.
struct GltfScene {
    std::vector<std::int64_t> parent; ///< of every node of the file; -1: none
    std::vector<std::size_t> nodes;   ///< of the scene, parents first
    std::vector<char> visible;        ///< of these: neither they nor a parent of theirs are hidden
};

/// The default scene; the first one where none is named, and all nodes where there is no scene. Throws InputError for
/// a node with two parents or that is its own ancestor, and for a scene that names a child.
GltfScene read_scene(const GltfDocument& document, Missing& missing, std::vector<std::string>& notes);

/// The joints that deform the surface, and the nodes that move them.
class GltfSkeleton {
public:
    static constexpr std::uint32_t none = ~0u;

    GltfSkeleton(GltfDocument& document, const GltfScene& scene, Missing& missing, Character& out);

    /// The first of a skin's joints among Character::joints, which are made where they are not there yet; and how
    /// many it has.
    std::uint32_t first_joint(std::size_t skin);
    /// A joint of its own for a mesh that a node draws without a skin.
    std::uint32_t carrier(std::size_t node);
    /// A joint for each place at which EXT_mesh_gpu_instancing draws the mesh of a node that has it.
    std::vector<std::uint32_t> instances(std::size_t node);
    std::uint32_t joint_count(std::size_t skin) const { return joint_count_[skin]; }
    /// The bone of a node, or none.
    std::uint32_t bone_of(std::size_t node) const { return bone_of_node_[node]; }
    /// Whether a bone can be animated: not where its matrix is no product of translation, rotation and positive scale.
    bool can_animate(std::uint32_t bone) const { return can_animate_[bone]; }

private:
    std::uint32_t add_bone(std::size_t node);

    GltfDocument& document_;
    const GltfScene& scene_;
    Missing& missing_;
    Character& out_;
    std::vector<std::uint32_t> bone_of_node_, first_joint_, joint_count_;
    std::vector<char> can_animate_;
};

} // namespace cinch
