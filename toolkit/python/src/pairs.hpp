// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cinch/collider.hpp"
#include "toolkit/python/src/arrays.hpp"

namespace cinch::python {

using PairRow = std::array<std::uint32_t, 4>;
static_assert(sizeof(TrianglePair) == sizeof(PairRow) && sizeof(LeafPair) == sizeof(PairRow), "rows of four");

/// Pairs of triangles or leaves as an array, (n, 4).
template <class Pair> py::array_t<std::uint32_t> rows_of(std::span<const Pair> pairs)
{
    const auto* flat = reinterpret_cast<const std::uint32_t*>(pairs.data());
    return copied<std::uint32_t>({flat, 4 * pairs.size()}, {static_cast<py::ssize_t>(pairs.size()), 4});
}

} // namespace cinch::python
