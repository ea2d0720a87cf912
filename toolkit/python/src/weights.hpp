// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "toolkit/python/src/arrays.hpp"

namespace cinch::python {

/// Python's Weights, with what normalising changed.
struct WeightsObject {
    Weights weights;
    WeightReport report;
    std::size_t alone = 0; ///< of kernel_weights
};

/// Of an array (V, J), of CSR triplets (data, indices, indptr), or of an object that has these: convex weights, or any
/// that are to be normalised. `nodes`: J, where triplets do not say it. Throws ValueError.
WeightsObject weights_from(pybind11::handle from, pybind11::handle nodes, bool normalise);

/// The class.
void add_weights(pybind11::module_& module);

/// (data, indices, indptr) without a copy, kept alive by `base`.
template <class Rows> pybind11::tuple triplets(const Rows& rows, const pybind11::object& base)
{
    const auto n = static_cast<pybind11::ssize_t>(rows.node.size());
    return pybind11::make_tuple(
        seen<double>(rows.weight.data(), {n}, base), seen<std::uint32_t>(rows.node.data(), {n}, base),
        seen<std::uint32_t>(rows.row.data(), {static_cast<pybind11::ssize_t>(rows.row.size())}, base));
}

} // namespace cinch::python
