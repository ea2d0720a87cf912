// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>

#include "cinch/io.hpp"
#include "toolkit/surface/gltf_document.hpp"

namespace cinch {

/// Whether what an extension of this name compresses is decoded: KHR_draco_mesh_compression, EXT_ or
/// KHR_meshopt_compression, where the document has decoders.
bool is_decoded(const GltfDocument& document, std::string_view extension);

/// The bytes of a compressed buffer view, with its extension's stride; none of others. Throws InputError.
struct DecodedView {
    const std::string* bytes = nullptr;
    std::size_t stride = 0;
};
DecodedView decoded_view(GltfDocument& document, std::size_t view);

/// A primitive that Draco compressed: triangles, and the attributes that are in it.
struct DecodedPrimitive {
    std::vector<std::uint32_t> indices;                   ///< three per triangle
    std::map<std::string, std::vector<double>> attribute; ///< as read_accessor has them
};
/// None of others. Throws InputError.
std::optional<DecodedPrimitive> decoded_primitive(GltfDocument& document, const GltfValue& primitive);

} // namespace cinch
