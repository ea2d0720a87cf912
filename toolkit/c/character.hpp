// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cinch/io.hpp"
#include "toolkit/c/objects.hpp"

namespace cinch::c {

/// Decoders for compressed files; null where this library has none.
const Decompression* decoders();

/// A file with its surface.
struct CharacterFile {
    static constexpr Kind kind = Kind::character;
    using Handle = cinch_character;

    Character character;
    std::shared_ptr<Surface> surface;

    /// clip < animations, or CINCH_REST. Throws std::invalid_argument.
    const Character::Animation& clip(std::size_t clip) const;
};

} // namespace cinch::c
