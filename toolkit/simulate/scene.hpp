// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "toolkit/simulate/effect_kind.hpp"
#include "toolkit/simulate/integration.hpp"

namespace cinch {

struct Decompression;

/// An effect of a scene.
struct SceneEffect {
    const EffectKind* kind = nullptr;
    EffectPlan plan;
    std::vector<std::string> bodies; ///< names; empty: all
    std::string path;                ///< in the file, for messages

    bool acts_on(const std::string& body) const
    {
        return bodies.empty() || std::find(bodies.begin(), bodies.end(), body) != bodies.end();
    }
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
    double thickness_m = 0;                             ///< of a sheet
    Vec3 position = Vec3::Zero(), axis = Vec3::UnitZ(); ///< m, –
    Vec3 velocity = Vec3::Zero(), spin = Vec3::Zero();  ///< m/s, rad/s
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
    const Decompression* decoders = nullptr; ///< for files of its bodies
};

/// A scene from JSON text in the layout of data/scenes/schema.json. `file` is for messages. Throws InputError naming
/// file and the path of the wrong field (like /effects/2/young) and what was expected. Relative file names in it are
/// taken from `folder`.
Scene parse_scene(std::string_view text, const std::string& file, const std::string& folder);

/// The layout of scenes, a JSON schema (draft 2020-12): data/scenes/schema.json. What effects have to say is theirs.
std::string scene_schema();

/// Names of all effects that a scene can name, in the order in which they are listed.
std::vector<std::string> effect_names();

} // namespace cinch
