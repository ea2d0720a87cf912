// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <nlohmann/json.hpp>

namespace cinch {

/// The items from which another one is predicted; all come before it.
struct References {
    std::uint32_t a, b, c;
};

/// For vertices in the order in which triangles (three corners each) first use them: where a vertex is the tip of a
/// triangle on an edge ab that is known, a, b and the vertex c beyond the edge (a parallelogram); else the nearest that
/// is known. The first one: itself.
std::vector<References> parallelograms(std::span<const std::uint32_t> corners, std::size_t vertices);

/// Lists of integers whose neighbours are alike: `frames` × `items` × `components`. Items change from frame to frame;
/// the change of an item is predicted as that of its a + b − c, or without `references` as that of the item before it
/// (modulo 2^32; before the first frame all are 0). The errors, zigzagged, stand as byte planes, lowest bytes first, as
/// many as it takes, in the zlib format, in base64:
/// {"shape":[…],"planes":P,"data":"…"}.
nlohmann::ordered_json pack(std::span<const std::int32_t> values, std::size_t frames, std::size_t items,
                            std::size_t components, std::span<const References> references = {});

} // namespace cinch
