// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "toolkit/surface/triangle_mesh.hpp"

namespace cinch {

/// Closed genus-0 surfaces that stand for the paper's three models, about 1 unit in half-extent, exactly as many
/// vertices as asked for (2V − 4 triangles). Same vertices, same bits on one platform.
TriangleMesh brain(std::size_t vertices); ///< folded; front along +x, up along +z
TriangleMesh santa(std::size_t vertices); ///< a body with head, cap, arms and legs; up along +z
TriangleMesh fish(std::size_t vertices);  ///< a body with fins; swims along +x

/// One of the above by name: brain-3500, brain-30000 (or brain), brain-145000, santa-2857 (or santa), santa-45682,
/// fish-8000 (or fish).
std::optional<TriangleMesh> named_shape(std::string_view name);
std::vector<std::string> shape_names();

/// An axis-aligned box of `size` about the origin, closed, its sides cut into `cells` along x, y and z; with no size
/// along z, an open sheet.
TriangleMesh box(const Vec3& size, const std::array<int, 3>& cells);

/// A unit sphere of `vertices` ≥ 5 in rings of latitude, near-equilateral away from the poles.
TriangleMesh ring_sphere(std::size_t vertices);

/// Moves the vertices of a unit sphere onto the outermost zero of `distance` along rays from the origin, evening out
/// edge lengths. `distance` must be at most the true distance to the surface, negative inside, positive beyond
/// radius 3.
void wrap(TriangleMesh& sphere, const std::function<double(const Vec3&)>& distance);

} // namespace cinch
