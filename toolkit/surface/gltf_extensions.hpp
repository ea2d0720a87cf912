// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>

#include "toolkit/surface/gltf_document.hpp"

namespace cinch {

/// What a file has that touches the surface and is not modelled, by name, each with the first place where it was met.
class Missing {
public:
    /// `what` may be met in many places; an empty place is the file itself.
    void add(const std::string& what, const std::string& place);
    /// "the extension EXT_x of a node (nodes[3] 'hand' and 4 more)", in the order in which they were met.
    std::vector<std::string> names() const;
    bool empty() const { return entries_.empty(); }

private:
    struct Entry {
        std::string what, first;
        std::set<std::string> places;
    };
    std::vector<Entry> entries_;
};

/// Whether an extension of this name cannot move a vertex, nor change what is drawn, wherever it stands: materials,
/// textures, lights, sound, metadata. Only such names are known; all others may.
bool is_harmless_extension(std::string_view name);

/// Adds the extensions of a value to what is missing, but for harmless ones and those named in `modelled`. Throws
/// InputError for compression, unless it is decoded where values like this have it.
void note_extensions(const GltfValue& value, Missing& missing, std::initializer_list<std::string_view> modelled = {});
void note_compressed(const GltfDocument& document, const GltfValue& value, Missing& missing);

/// The same for what the file requires, and has at its top.
void note_extensions_of_file(const GltfDocument& document, Missing& missing);

} // namespace cinch
