// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "toolkit/simulate/body_simulation.hpp"
#include "toolkit/simulate/effects/effects.hpp"

namespace cinch {

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

/// The effects that a scene can name, each with what it needs.
struct GravitySpec {
    Vec3 acceleration;
};
struct PullingForceSpec {
    NodeSelection nodes;
    PullingForce force;
};
struct PullingTargetSpec {
    NodeSelection nodes;
    double stiffness = 0;
    Vec3 offset = Vec3::Zero(); ///< of the target from where the node began; reached after `ramp_s`
    double ramp_s = 0;
    bool clip = false; ///< follow the character's clip instead
};
struct ElasticSpec {
    enum class Model { neo_hookean, stvk, stvk_paper } model = Model::neo_hookean;
    double young = 0, poisson = 0.3;
};
struct VolumeSpec {
    double stiffness = 0;
};
struct HourglassSpec {
    double alpha = 1, young = 0; ///< 0: that of the elastic effect
};
struct PlasticitySpec {
    PlasticFlow flow;
};
struct ViscositySpec {
    double viscosity = 0;
};
struct DampingSpec {
    double rate = 0;
};
struct GroundSpec {
    Ground ground;
};
struct ContactSpec {      ///< of the bodies of its effect with each other
    double stiffness = 0; ///< Pa/m
};
struct PinnedSpec {
    NodeSelection nodes;
};
struct ScriptedSpec { ///< axis and centre in the world
    NodeSelection nodes;
    Turning turning;
    Vec3 velocity = Vec3::Zero();
    double end_s = 0;
    bool clip = false;
};
struct SceneEffect {
    std::vector<std::string> bodies; ///< names; empty: all
    std::variant<GravitySpec, PullingForceSpec, PullingTargetSpec, ElasticSpec, VolumeSpec, HourglassSpec,
                 PlasticitySpec, ViscositySpec, DampingSpec, GroundSpec, ContactSpec, PinnedSpec, ScriptedSpec>
        what;
    std::string path; ///< in the file, for messages
};

struct SceneBody {
    std::string name;
    std::string surface;                    ///< a shape, "box", "sheet", a mesh file, or a character
    double size_m = 0;                      ///< longest half-extent; 0: as the file has it
    Vec3 box_m = Vec3::Ones();              ///< of a box or sheet (z = 0)
    std::array<int, 3> cells = {1, 1, 1};   ///< of its surface
    std::size_t nodes = 0;                  ///< sampled in the volume, or
    std::array<int, 3> lattice = {0, 0, 0}; ///< at the centres of a box's cells, or
    std::vector<Vec3> places;               ///< given
    std::uint64_t seed = 0;
    MeshlessOptions meshless;
    bool volume_by_density = false;
    double thickness_m = 0; ///< of a sheet
    Vec3 position = Vec3::Zero(), axis = Vec3::UnitZ(), velocity = Vec3::Zero(),
         spin = Vec3::Zero(); ///< m, –, m/s, rad/s
    double angle_deg = 0;
    std::string clip; ///< of a character; empty: its first
    std::string path; ///< in the file, for messages
};

struct Scene {
    std::string name, about;
    double duration_s = 1, frame_s = 1.0 / 60;
    Integration integration;
    std::vector<SceneBody> bodies;
    std::vector<SceneEffect> effects;
};

/// A scene from JSON text in the layout of data/scenes/schema.json. `file` is for messages. Throws InputError naming
/// file and the path of the wrong field (like /effects/2/young) and what was expected. Relative file names in it are
/// taken from `folder`.
Scene parse_scene(std::string_view text, const std::string& file, const std::string& folder);

/// Names of all effects that a scene can name, in the order in which they are listed.
std::vector<std::string> effect_names();

} // namespace cinch
