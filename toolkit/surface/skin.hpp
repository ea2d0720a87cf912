// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "toolkit/surface/clip.hpp"
#include "toolkit/surface/triangle_mesh.hpp"

namespace cinch {

/// Weights of every vertex as a file gives them: not normalised. Vertex k owns entries [row[k], row[k+1]).
struct Influences {
    std::uint32_t node_count = 0;        ///< simulation nodes (joints)
    std::vector<std::uint32_t> row = {0};
    std::vector<std::uint32_t> node;     ///< ascending within a vertex, no node twice
    std::vector<double> weight;          ///< finite, ≥ 0
    double step = 0; ///< between neighbouring numbers where weights are stored as integers, 1/255 or 1/65535, the coarsest; 0: floating point
};

/// Text form of a skin's weights. First line `V J`; then per vertex `n j1 w1 ... jn wn` (node index from 0, weight ≥ 0,
/// not necessarily normalised). `vertices` must be the mesh's count. Throws InputError.
Influences read_weights_text(const std::filesystem::path& path, std::size_t vertices);

/// Text form of clips. First the number of clips; per clip a line `name K J`, then K lines `time` and J × 12 numbers,
/// the row-major 3×4 matrix of every simulation node. `nodes` must equal every J. Throws InputError.
std::vector<Clip> read_clips_text(const std::filesystem::path& path, std::uint32_t nodes);

Influences parse_weights_text(std::string_view bytes, const std::string& file, std::size_t vertices);
std::vector<Clip> parse_clips_text(std::string_view bytes, const std::string& file, std::uint32_t nodes);

} // namespace cinch
