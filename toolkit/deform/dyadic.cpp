// SPDX-License-Identifier: Apache-2.0
#include "toolkit/deform/dyadic.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

namespace cinch {

void round_dyadic(std::span<double> weights, int bits)
{
    const std::int64_t one = std::int64_t{1} << bits;
    int exponent = 0;
    std::frexp(*std::max_element(weights.begin(), weights.end()), &exponent);
    for (double& w :
         weights) // by a power of two, which is exact but for what underflows: neither sum nor quotient can overflow
        w = std::ldexp(w, -exponent);
    const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    assert(sum > 0 && std::isfinite(sum));

    struct Part {
        std::int64_t units;
        double remainder;
        std::size_t index;
    };
    std::vector<Part> parts(weights.size());
    std::int64_t missing = one;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        const double ideal = std::ldexp(weights[i] / sum, bits);
        const double floor = std::min(std::floor(ideal), static_cast<double>(one));
        parts[i] = {static_cast<std::int64_t>(floor), ideal - floor, i};
        missing -= parts[i].units;
    }
    // The rounded sum may be off by n units either way, so the correction may take several rounds, or be negative.
    std::sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) {
        return a.remainder != b.remainder ? a.remainder > b.remainder : a.index < b.index;
    });
    while (missing > 0)
        for (std::size_t i = 0; i < parts.size() && missing > 0; ++i, --missing)
            ++parts[i].units;
    while (missing < 0)
        for (std::size_t i = parts.size(); i-- > 0 && missing < 0;)
            if (parts[i].units > 0) {
                --parts[i].units;
                ++missing;
            }
    for (const Part& part : parts)
        weights[part.index] = std::ldexp(static_cast<double>(part.units), -bits);
}

} // namespace cinch
