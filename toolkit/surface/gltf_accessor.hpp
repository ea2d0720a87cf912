// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <tiny_gltf.h>

namespace cinch {

/// The elements of a glTF accessor as doubles, `components` per element: strides, normalised integers and sparse
/// substitution resolved, every access checked against its buffer. Throws InputError naming the accessor.
std::vector<double> read_accessor(const tinygltf::Model& model, int index, std::size_t components, const std::string& file);

} // namespace cinch
