// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "toolkit/surface/gltf_document.hpp"
#include "toolkit/surface/gltf_extensions.hpp"

namespace cinch {

/// The elements of an accessor as doubles, `components` per element: strides, normalised integers, sparse
/// substitution and those without data, which are zeros, resolved; every access checked against its buffer. Throws
/// InputError naming the accessor. Extensions that may change the numbers go to `missing`.
std::vector<double> read_accessor(GltfDocument& document, std::size_t index, std::size_t components, Missing& missing);

/// The step between neighbouring numbers of an accessor of normalised integers: 1/255, 1/65535, ...; 0 for others.
double step_of_accessor(const GltfDocument& document, std::size_t index);

} // namespace cinch
