// SPDX-License-Identifier: Apache-2.0
#pragma once

/// \file
/// Files: meshes (OBJ, OFF, PLY, STL), characters (glTF 2.0), weights and transforms as text. Their faults are an
/// InputError.

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "cinch/deform.hpp"
#include "cinch/refit.hpp"

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

/// One key-framed curve of the weights of morph targets.
struct WeightCurve {
    std::uint32_t first_target = 0; ///< index into Character::targets; the targets of one mesh stand together
    std::uint32_t count = 0;        ///< of them
    Curve::Interpolation interpolation = Curve::Interpolation::linear; ///< of its keys
    std::vector<double> time_s; ///< ascending; of keys at the same time the last one holds from then on
    std::vector<double>
        value; ///< `count` per key, or for a cubic spline 3 × `count`: in-tangents, values, out-tangents
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
    std::string name;                           ///< printable; "nodes[I]" where the file gives none
};

/// A joint of a skin, or what carries a mesh without a skin: a simulation node.
struct Joint {
    std::uint32_t bone;     ///< index into Character::bones
    AffineMap inverse_bind; ///< from the mesh at rest to the bone; of a mesh without a skin the identity
};

/// Whether all of a file's surface is wanted, or only what is modelled.
enum class Coverage { whole, partial };
/// Whether morph targets are read, or are not modelled where their weights are not 0.
enum class Morphs { missing, read };

/// A character: every triangle that the file's default scene draws, deformed by skins or carried by nodes. Vertices
/// with equal position, weights and displacements are one vertex (glTF splits them where normals or texture coordinates
/// differ), and a mesh that is drawn twice by the same skin, which puts it at the same place, is there once.
struct Character {
    std::string file;                   ///< for messages
    TriangleMesh mesh;                  ///< in bind pose
    Influences influences;              ///< simulation node j is joints[j]
    std::vector<Joint> joints;          ///< of all skins, then one for each mesh without a skin
    std::size_t skins = 0;              ///< of which it is made; each has a rest space of its own,
    std::size_t carried = 0;            ///< as has each mesh without one, of which there are these
    std::vector<MorphTarget> targets;   ///< with Morphs::read
    std::vector<double> target_weights; ///< of the file, where no animation sets them
    std::vector<Bone> bones;            ///< joints and what moves them; parents come first
    /// One of the file's.
    struct Animation {
        std::string name;                 ///< unique, printable; "anim0", "anim1", ... where the file gives none
        double first_s = 0;               ///< the first key of all of its channels, whatever they move
        double last_s = 0;                ///< the last one
        std::vector<Curve> curves;        ///< those that move bones
        std::vector<WeightCurve> morphs;  ///< with Morphs::read
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

/// Decoders of what glTF files may be compressed with. cinch::io itself has none.
struct Decompression {
    /// Why data cannot be decoded.
    struct Fault : std::runtime_error {
        using std::runtime_error::runtime_error;
    };
    /// Triangles, and the numbers of attributes as stored, one list for each that was asked for.
    struct Mesh {
        std::size_t vertices = 0;                    ///< of it
        std::vector<std::uint32_t> indices;          ///< three per triangle, each below `vertices`
        std::vector<std::vector<double>> attributes; ///< per vertex as many as the attribute has
    };
    /// KHR_draco_mesh_compression: of the attributes with these ids. Throws Fault.
    Mesh (*draco)(std::string_view bytes, std::span<const std::uint32_t> ids);
    /// EXT_meshopt_compression: `count` elements of `stride` bytes; `mode` and `filter` as in the file. Throws Fault.
    std::string (*meshopt)(std::string_view bytes, std::size_t count, std::size_t stride, const std::string& mode,
                           const std::string& filter);
};
/// By their libraries, Draco and meshoptimizer: for programs that link cinch::compression too.
const Decompression& decompression();

/// Reads .gltf (with its .bin files), .glb or .vrm. What is read is listed, as is what cannot move a vertex (materials,
/// textures, cameras, lights, names, extras, ...); anything else that touches the surface is missing. `whole`: where
/// something is missing this throws, naming it, and animations with something missing have that as their fault.
/// `partial`: the rest is read. What is compressed is refused, unless there are decoders. Throws InputError; memory is
/// bounded by the files' sizes, but for what decoders unpack.
Character read_gltf(const std::filesystem::path& path, Coverage coverage = Coverage::whole,
                    Morphs morphs = Morphs::missing, const Decompression* decoders = nullptr);

/// True for .glb, .gltf and .vrm, in any case.
bool is_character_file(const std::filesystem::path& path);

/// The character's surface, with its weights normalised (to_dyadic). Where its parts have rest spaces of their own its
/// layout is the pose of the file.
DeformableSurface surface_of(const Character& character, WeightReport* report = nullptr);

/// Joint matrices (joint world × inverse bind) at evenly spaced times from the first key to the last, both included,
/// as near to `fps` per second as that allows; and the weights of morph targets that were read, where one of them
/// displaces anything in the animation (Clip::weights). The clip has a copy of what it needs. Throws InputError for a
/// fault of the animation, and for 10¹² frames or more; frames that overflow throw when they are made.
Clip sample(const Character& character, const Character::Animation& animation, double fps);

/// The rest pose as a clip of one frame.
Clip rest_pose(const Character& character);

/// The character with its morph targets (Morphs::read) at any weights from `least` to `greatest` at any time, whatever
/// its clips say: for faces that a program moves. They become one target of weight 1, whose displacement of a vertex is
/// a box with every Σ_i a_i d_i in it, as exact as computed in doubles; those after it displace nothing.
/// Throws std::invalid_argument unless least <= greatest, both finite; InputError where such a sum overflows.
Character with_any_weights(Character character, double least = 0, double greatest = 1);

/// Bounds every BV of a character for all times of a clip: every curve as the glTF specification interpolates it, morph
/// targets (Morphs::read) and parts without a skin included. Character, surface (surface_of) and BVH must stay as they
/// are, and alive.
class ClipBounder {
public:
    /// Throws InputError for a fault of the animation, std::invalid_argument for a k that is none.
    ClipBounder(const Character& character, const Character::Animation& animation, const DeformableSurface& surface,
                const Bvh& bvh, const RefitOptions& options = {});
    ~ClipBounder();
    /// What was moved from can only be destroyed.
    ClipBounder(ClipBounder&&) noexcept;

    /// supports[bv·k + d], d as in axes_of(k): at every real time of [t0_s, t1_s], both included, which lie between the
    /// animation's first_s and last_s. The half diagonals of boxes exceed those of the bounds at single times by
    /// at most the share `tolerance`, where halving intervals reaches it. Throws std::invalid_argument for times and
    /// sizes that do not fit.
    void operator()(double t0_s, double t1_s, std::span<double> supports, double tolerance = 0.01);

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

} // namespace cinch
