// SPDX-License-Identifier: Apache-2.0
#include "cinch/surface.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "cinch/environment.hpp"
#include "toolkit/deform/dyadic.hpp"

namespace cinch {

Weights to_dyadic(const Influences& influences, WeightReport* report)
{
    require_default_arithmetic();
    Weights out;
    out.node_count = influences.node_count;
    WeightReport counted;
    counted.vertices = influences.row.size() - 1;
    std::vector<double> weights;
    bool any = false;
    for (std::size_t k = 0; k + 1 < influences.row.size(); ++k) {
        const std::size_t first = influences.row[k], last = influences.row[k + 1];
        if (first >= last)
            throw std::invalid_argument("to_dyadic: vertex " + std::to_string(k) + " has no influence");
        weights.assign(influences.weight.begin() + static_cast<std::ptrdiff_t>(first),
                       influences.weight.begin() + static_cast<std::ptrdiff_t>(last));
        const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
        if (std::all_of(weights.begin(), weights.end(), [](double w) { return w == 0; })) {
            ++counted.without_weight;
            weights.front() = 1;
        } else {
            counted.least_sum = any ? std::min(counted.least_sum, sum) : sum;
            counted.greatest_sum = any ? std::max(counted.greatest_sum, sum) : sum;
            any = true;
            const double off = std::abs(sum - 1), rounding = sum_rounding(weights.size());
            if (!(off <= rounding)) {
                ++counted.normalised;
                counted.beyond_steps +=
                    !(off <= rounding + 0.5 * influences.step * static_cast<double>(weights.size()));
                counted.largest_change = std::max(counted.largest_change, std::abs(1 / sum - 1));
            }
        }
        round_dyadic(weights);
        for (std::size_t i = 0; i < weights.size(); ++i)
            if (weights[i] > 0) {
                out.node.push_back(influences.node[first + i]);
                out.weight.push_back(weights[i]);
            }
        out.row.push_back(static_cast<std::uint32_t>(out.node.size()));
    }
    if (report)
        *report = counted;
    return out;
}

} // namespace cinch
