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

/// What normalising a file's weights changed. Dividing by their sum s changes every weight of a vertex by the share |1/s − 1|.
struct WeightReport {
    std::size_t vertices = 0;
    std::size_t normalised = 0;     ///< vertices whose weights it changed by more than sum_rounding
    std::size_t beyond_steps = 0;   ///< of these, whose sum is off by more than storing weights as integers explains: half a step each
    double largest_change = 0;      ///< share by which it changed the weights of these vertices at most
    std::size_t without_weight = 0; ///< vertices whose weights were all 0: bound wholly to the first node they name; not among the others
    double least_sum = 1, greatest_sum = 1; ///< of all vertices with weights
};

/// How far from 1 the sum of n weights may be that a program normalised in binary32 and stored so, or printed: with u = 2⁻²⁴, the sum that it
/// divided by is off by n − 1 additions, (n − 1) u, each quotient by u more, and a printed or stored one by another u, and the weights sum
/// to 1: (n + 1) u to first order, and (n + 2) u with all higher ones for n < 2²³. (Adding them up here errs by n 2⁻⁵³, less than what is left.)
constexpr double sum_rounding(std::size_t n) { return (static_cast<double>(n) + 2) * 0x1p-24; }

/// Normalises and rounds every vertex's weights to dyadic ones; weights that round to 0 are dropped.
Weights to_dyadic(const Influences& influences, WeightReport* report = nullptr);

} // namespace cinch
