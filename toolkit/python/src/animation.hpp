// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "toolkit/python/src/objects.hpp"

namespace cinch::python {

/// Decoders of compressed files, where the module was built with them.
inline const Decompression* decoders()
{
#ifdef CINCH_HAS_COMPRESSION
    return &decompression();
#else
    return nullptr;
#endif
}

/// An Animation of this character, its name, or None: the first one, or the pose of the file where there is none.
/// Throws ValueError.
AnimationObject animation_of(const CharacterPtr& character, py::handle clip);

} // namespace cinch::python
