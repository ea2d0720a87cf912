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
    std::vector<double> time_s; ///< strictly ascending
    /// Per key one value, or for a cubic spline in-tangent, value, out-tangent. Rotations are (x, y, z, w).
    std::vector<std::array<double, 4>> value;
};

/// A node of the glTF scene graph.
struct Bone {
    std::int64_t parent = -1; ///< comes earlier in Character::bones, or -1
    bool is_matrix = false;   ///< rest pose given by `matrix`, not by the three below
    std::array<double, 16> matrix{}; ///< column-major
    std::array<double, 3> translation{0, 0, 0}, scale{1, 1, 1};
    std::array<double, 4> rotation{0, 0, 0, 1}; ///< x, y, z, w
};

struct Joint {
    std::uint32_t bone;
    AffineMap inverse_bind;
};

/// A skinned character: every triangle primitive of every mesh that a skin deforms. Vertices with equal position and
/// weights are one vertex (glTF splits them where normals or texture coordinates differ).
struct Character {
    TriangleMesh mesh;
    Influences influences; ///< simulation node j is joints[j]
    std::vector<Joint> joints;
    std::vector<Bone> bones;
    struct Animation {
        std::string name; ///< unique; "anim0", "anim1", ... where the file gives none
        std::vector<Curve> curves;
    };
    std::vector<Animation> animations;
    std::vector<std::string> notes; ///< what was left out, for the load report
};

/// Reads .gltf (with its .bin files) or .glb. Throws InputError; memory is bounded by the files' sizes.
Character read_gltf(const std::filesystem::path& path);
Character parse_gltf(std::string_view bytes, const std::string& file);

/// Joint matrices (joint world × inverse bind) at evenly spaced times from the first key to the last, both included, as near to
/// `fps` per second as that allows. Throws InputError if the clip would have more than a million frames.
Clip sample(const Character& character, const Character::Animation& animation, double fps);

/// The rest pose as a clip of one frame.
Clip rest_pose(const Character& character);

} // namespace cinch
