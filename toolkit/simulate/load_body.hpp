// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>

#include "toolkit/simulate/scene.hpp"
#include "toolkit/surface/read_mesh.hpp"

namespace cinch {

/// A body's surface at rest, its nodes, and for a character where its clip takes a point that lies in it.
struct LoadedBody {
    DeformableSurface surface;
    std::vector<Vec3> nodes;
    std::vector<double> volume; ///< per node; empty: by density
    double total_volume = 0;    ///< to which volumes by density are scaled; 0: they are not
    std::vector<std::string> notes;
    std::function<Vec3(std::size_t node, double time_s)> clip; ///< empty where there is none
};

/// Meshes that several bodies of a scene share, by the name of their surface.
using MeshCache = std::map<std::string, MeshFile>;

/// Throws InputError with file and path. `decoders`: of what is compressed, or null.
LoadedBody load_body(const SceneBody& body, const std::string& file, const Decompression* decoders, MeshCache& meshes);

} // namespace cinch
