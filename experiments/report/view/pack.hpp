// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>

#include <nlohmann/json.hpp>

namespace cinch {

/// Lists of integers whose neighbours are alike: `frames` × `items` × `components`. Every value is predicted as that of the item before,
/// plus what that one changed by since the frame before (modulo 2^32; what is not there is 0). The errors, zigzagged, stand as byte
/// planes, lowest bytes first, as many as it takes, in the zlib format, in base64: {"shape":[…],"planes":P,"data":"…"}.
nlohmann::ordered_json pack(std::span<const std::int32_t> values, std::size_t frames, std::size_t items, std::size_t components);

} // namespace cinch
