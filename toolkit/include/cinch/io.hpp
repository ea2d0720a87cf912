// SPDX-License-Identifier: Apache-2.0
#pragma once

/// \file
/// Files: meshes (OBJ, OFF, PLY, STL), characters (glTF 2.0), weights and transforms as text. Their faults are an
/// InputError.

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "cinch/deform.hpp"

namespace cinch {

/// The surface of a mesh file, and what else the file has.
struct MeshFile {
    TriangleMesh mesh; ///< in the file's unit
    std::vector<std::string>
        notes; ///< one line each, for the load report: what bounds nothing and was left out, what was not read
};

/// Reads OBJ, OFF, PLY (ascii and both binaries) or STL (ascii and binary), chosen by the extension in any case.
/// Polygons become triangle fans, PLY's strips the triangles that they stand for; vertex counts are those of the file
/// (an STL file has three per triangle). What is no surface is left out, and a note counts it: lines, points, faces of
/// two vertices, and where the file gives the count itself (PLY, OFF) of one or none. Throws InputError, one line with
/// file, line or byte, and reason: truncation, bad indices, coordinates that are not finite, counts that the file
/// cannot hold, surfaces of other kinds. Memory is bounded by the file's size.
MeshFile read_mesh(const std::filesystem::path& path);

/// True if the extension is one that read_mesh knows.
bool is_mesh_file(const std::filesystem::path& path);

/// Text form of a skin's weights. First line `V J`; then per vertex `n j1 w1 ... jn wn` (node index from 0, weight ≥ 0,
/// not necessarily normalised). `vertices` must be the mesh's count. Throws InputError.
Influences read_weights_text(const std::filesystem::path& path, std::size_t vertices);

/// Text form of clips. First the number of clips; per clip a line `name K J`, then K lines `time` and J × 12 numbers,
/// the row-major 3×4 matrix of every simulation node. `nodes` must equal every J. Throws InputError.
std::vector<Clip> read_clips_text(const std::filesystem::path& path, std::uint32_t nodes);

/// One key-framed curve of a glTF animation.
struct Curve {
    /// What of the bone it moves.
    enum class Target { translation, rotation, scale };
    /// Between keys.
    enum class Interpolation { step, linear, cubic_spline };

    std::uint32_t bone = 0;                              ///< index into Character::bones
    Target target = Target::translation;                 ///< of that bone
    Interpolation interpolation = Interpolation::linear; ///< of its keys
    std::vector<double> time_s; ///< ascending; of keys at the same time the last one holds from then on
    /// Per key one value, or for a cubic spline in-tangent, value, out-tangent. Rotations are (x, y, z, w).
    std::vector<std::array<double, 4>> value;
};

/// A node of the glTF scene graph that moves joints.
struct Bone {
    std::int64_t parent = -1; ///< comes earlier in Character::bones, or -1
    bool is_matrix =
        false; ///< rest pose given by `matrix`; the three below are what it is made of, where it is animated
    std::array<double, 16> matrix{};            ///< column-major, affine
    std::array<double, 3> translation{0, 0, 0}; ///< in the file's unit
    std::array<double, 3> scale{1, 1, 1};       ///< along its own axes
    std::array<double, 4> rotation{0, 0, 0, 1}; ///< x, y, z, w
};

/// A joint of a skin: a simulation node.
struct Joint {
    std::uint32_t bone;     ///< index into Character::bones
    AffineMap inverse_bind; ///< from the mesh at rest to the bone
};

/// Whether all of a file's surface is wanted, or only what is modelled.
enum class Coverage { whole, partial };

/// A skinned character: every triangle of every mesh that a skin deforms and the file's default scene draws. Vertices
/// with equal position and weights are one vertex (glTF splits them where normals or texture coordinates differ), and
/// a mesh that is drawn twice by the same skin, which puts it at the same place, is there once.
struct Character {
    std::string file;          ///< for messages
    TriangleMesh mesh;         ///< in bind pose
    Influences influences;     ///< simulation node j is joints[j]
    std::vector<Joint> joints; ///< of all skins
    std::vector<Bone> bones;   ///< joints and what moves them; parents come first
    /// One of the file's.
    struct Animation {
        std::string name;                 ///< unique, printable; "anim0", "anim1", ... where the file gives none
        double first_s = 0;               ///< the first key of all of its channels, whatever they move
        double last_s = 0;                ///< the last one
        std::vector<Curve> curves;        ///< those that move bones
        std::vector<std::string> missing; ///< what moves the surface in it and is not modelled
        std::vector<std::string> notes;   ///< what was changed, for the load report
        std::string fault; ///< why it cannot be sampled, as the message of an InputError; empty where it can
    };
    std::vector<Animation> animations; ///< in the order of the file
    Animation rest;                    ///< the pose of the file, as an animation that moves nothing
    std::vector<std::string>
        missing; ///< of the surface, in whatever animation: what is drawn or moves it and is not modelled
    std::vector<std::string> notes; ///< what was left out since it bounds nothing, for the load report
};

/// Reads .gltf (with its .bin files) or .glb. What is read is listed, as is what cannot move a vertex (materials,
/// textures, cameras, lights, names, extras, ...); anything else that touches the surface is missing. `whole`: where
/// something is missing this throws, naming it, and animations with something missing have that as their fault.
/// `partial`: the rest is read. Throws InputError; memory is bounded by the files' sizes.
Character read_gltf(const std::filesystem::path& path, Coverage coverage = Coverage::whole);

/// Joint matrices (joint world × inverse bind) at evenly spaced times from the first key to the last, both included,
/// as near to `fps` per second as that allows. The clip has a copy of what it needs. Throws InputError for a fault of
/// the animation, and for 10¹² frames or more; frames that overflow throw when they are made.
Clip sample(const Character& character, const Character::Animation& animation, double fps);

/// The rest pose as a clip of one frame.
Clip rest_pose(const Character& character);

} // namespace cinch
