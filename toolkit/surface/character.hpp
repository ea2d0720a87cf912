// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "toolkit/surface/skin.hpp"

namespace cinch {

/// One key-framed curve of a glTF animation.
struct Curve {
    enum class Target { translation, rotation, scale };
    enum class Interpolation { step, linear, cubic_spline };

    std::uint32_t bone = 0; ///< index into Character::bones
    Target target = Target::translation;
    Interpolation interpolation = Interpolation::linear;
    std::vector<double> time_s; ///< ascending; of keys at the same time the last one holds from then on
    /// Per key one value, or for a cubic spline in-tangent, value, out-tangent. Rotations are (x, y, z, w).
    std::vector<std::array<double, 4>> value;
};

/// A node of the glTF scene graph that moves joints.
struct Bone {
    std::int64_t parent = -1; ///< comes earlier in Character::bones, or -1
    bool is_matrix =
        false; ///< rest pose given by `matrix`; the three below are what it is made of, where it is animated
    std::array<double, 16> matrix{}; ///< column-major, affine
    std::array<double, 3> translation{0, 0, 0}, scale{1, 1, 1};
    std::array<double, 4> rotation{0, 0, 0, 1}; ///< x, y, z, w
};

struct Joint {
    std::uint32_t bone;
    AffineMap inverse_bind;
};

/// Whether all of a file's surface is wanted, or only what is modelled.
enum class Coverage { whole, partial };

/// A skinned character: every triangle of every mesh that a skin deforms and the file's default scene draws. Vertices
/// with equal position and weights are one vertex (glTF splits them where normals or texture coordinates differ), and
/// a mesh that is drawn twice by the same skin, which puts it at the same place, is there once.
struct Character {
    std::string file; ///< for messages
    TriangleMesh mesh;
    Influences influences; ///< simulation node j is joints[j]
    std::vector<Joint> joints;
    std::vector<Bone> bones; ///< joints and what moves them; parents come first
    struct Animation {
        std::string name; ///< unique, printable; "anim0", "anim1", ... where the file gives none
        double first_s = 0, last_s = 0; ///< from the first key to the last of all of its channels, whatever they move
        std::vector<Curve> curves;
        std::vector<std::string> missing; ///< what moves the surface in it and is not modelled
        std::vector<std::string> notes;   ///< what was changed, for the load report
        std::string fault; ///< why it cannot be sampled, as the message of an InputError; empty where it can
    };
    std::vector<Animation> animations;
    Animation rest; ///< the pose of the file, as an animation that moves nothing
    std::vector<std::string>
        missing; ///< of the surface, in whatever animation: what is drawn or moves it and is not modelled
    std::vector<std::string> notes; ///< what was left out since it bounds nothing, for the load report
};

/// Reads .gltf (with its .bin files) or .glb. What is read is listed, as is what cannot move a vertex (materials,
/// textures, cameras, lights, names, extras, ...); anything else that touches the surface is missing. `whole`: where
/// something is missing this throws, naming it, and animations with something missing have that as their fault.
/// `partial`: the rest is read. Throws InputError; memory is bounded by the files' sizes.
Character read_gltf(const std::filesystem::path& path, Coverage coverage = Coverage::whole);
Character parse_gltf(std::string_view bytes, const std::string& file, Coverage coverage = Coverage::whole);

/// Joint matrices (joint world × inverse bind) at evenly spaced times from the first key to the last, both included,
/// as near to `fps` per second as that allows. The clip has a copy of what it needs. Throws InputError for a fault of
/// the animation, and for 10¹² frames or more; frames that overflow throw when they are made.
Clip sample(const Character& character, const Character::Animation& animation, double fps);

/// The rest pose as a clip of one frame.
Clip rest_pose(const Character& character);

/// "what is not modelled: A; B", for the message that refuses it.
std::string not_modelled(const std::vector<std::string>& missing);

} // namespace cinch
