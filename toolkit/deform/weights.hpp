// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "toolkit/surface/skin.hpp"

namespace cinch {

/// Convex weights of every vertex (Eq. 2). Vertex k owns entries [row[k], row[k+1]); they are > 0, multiples of 2^-53,
/// ascending in node, and sum to exactly 1.
struct Weights {
    std::uint32_t node_count = 0; ///< simulation nodes
    std::vector<std::uint32_t> row = {0};
    std::vector<std::uint32_t> node;
    std::vector<double> weight;

    struct Row {
        std::span<const std::uint32_t> node;
        std::span<const double> weight;
    };
    Row of(std::size_t vertex) const
    {
        const std::size_t first = row[vertex], count = row[vertex + 1] - first;
        return {std::span(node).subspan(first, count), std::span(weight).subspan(first, count)};
    }
    std::size_t vertex_count() const { return row.size() - 1; }
};

/// What normalising a file's weights changed.
struct WeightReport {
    std::size_t vertices = 0;
    std::size_t off_by_a_thousandth = 0; ///< vertices whose weights summed to less than 0.999 or more than 1.001
    std::size_t without_weight = 0;      ///< vertices whose weights were all 0: bound wholly to the first node they name
    double least_sum = 1, greatest_sum = 1;
};

/// Normalises and rounds every vertex's weights to dyadic ones; weights that round to 0 are dropped.
Weights to_dyadic(const Influences& influences, WeightReport* report = nullptr);

} // namespace cinch
