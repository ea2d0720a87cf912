// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "cinch/io.hpp"

namespace cinch {

/// read_gltf on bytes in memory; `file` is for messages, and where others are named, beside it.
Character parse_gltf(std::string_view bytes, const std::string& file, Coverage coverage = Coverage::whole,
                     Morphs morphs = Morphs::missing, const Decompression* decoders = nullptr);

/// Whether morph targets (Morphs::read) displace any vertex at any time of an animation: a weight of theirs is not 0.
bool moves_targets(const Character& character, const Character::Animation& animation);

/// "what is not modelled: A; B", for the message that refuses it.
std::string not_modelled(const std::vector<std::string>& missing);

} // namespace cinch
