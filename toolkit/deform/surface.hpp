// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "toolkit/deform/weights.hpp"
#include "toolkit/surface/triangle_mesh.hpp"

namespace cinch {

/// A surface in rest state with the weights that deform it: weights.vertex_count() == mesh.vertices.size().
struct DeformableSurface {
    TriangleMesh mesh;
    Weights weights;
};

} // namespace cinch
