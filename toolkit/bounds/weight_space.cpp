// SPDX-License-Identifier: Apache-2.0
#include "toolkit/bounds/weight_space.hpp"

#include <algorithm>

#include "toolkit/bounds/rounding.hpp"

namespace cinch {

double dual_bound(WeightSpace space, std::span<const double> b, double lambda, Rounding rounding) noexcept
{
    double sum = 0, absolute = 0; // T̂ and Â of rounding.hpp
    for (std::size_t j = 0; j < b.size(); ++j) {
        const double above = b[j] - lambda; // its sign is exact, so the right one of h and l is taken
        const double term = (above >= 0 ? space.h[j] : space.l[j]) * above;
        sum += term;
        absolute += std::abs(term);
    }
    if (!(absolute < infinite) || !(std::abs(lambda) < infinite))
        return infinite;
    const double bound = rounding == Rounding::plain
                             ? lambda + sum
                             : succ(lambda + succ(sum + sum_error(static_cast<double>(b.size()), absolute)));
    return bound < infinite ? bound : infinite;
}

double second_largest(std::span<const double> b) noexcept
{
    double first = b[0], second = b.size() > 1 ? -infinite : b[0];
    for (std::size_t j = 1; j < b.size(); ++j) {
        if (b[j] > first) {
            second = first;
            first = b[j];
        } else if (b[j] > second) {
            second = b[j];
        }
    }
    return second;
}

template <class T> T best_lambda(std::span<std::pair<T, T>> extremum_and_range, T slack) noexcept
{
    // Starting at l, the largest b are raised to h until the weights sum to 1; λ is the b at which they do.
    auto first = extremum_and_range.begin(), last = extremum_and_range.end();
    T smallest = first->first;
    for (const auto& e : extremum_and_range)
        smallest = std::min(smallest, e.first);
    while (first != last) {
        const T x = first->first, y = first[(last - first) / 2].first, z = (last - 1)->first;
        const T pivot = std::max(std::min(x, y), std::min(std::max(x, y), z));
        const auto equal = std::partition(first, last, [&](const auto& e) { return e.first > pivot; });
        const auto less = std::partition(equal, last, [&](const auto& e) { return e.first == pivot; });
        T greater_range = 0, equal_range = 0;
        for (auto e = first; e != equal; ++e)
            greater_range += e->second;
        if (greater_range > slack) {
            last = equal;
            continue;
        }
        for (auto e = equal; e != less; ++e)
            equal_range += e->second;
        if (greater_range + equal_range >= slack)
            return pivot;
        if (less == first)
            break; // the pivot is not a number
        slack -= greater_range + equal_range;
        first = less;
    }
    return smallest; // Σ h ≤ 1
}
template float best_lambda(std::span<std::pair<float, float>>, float) noexcept;
template double best_lambda(std::span<std::pair<double, double>>, double) noexcept;

double best_lambda(WeightSpace space, std::span<const double> b, std::vector<std::pair<double, double>>& scratch)
{
    double slack = 1;
    scratch.clear();
    for (std::size_t j = 0; j < b.size(); ++j) {
        slack -= space.l[j];
        scratch.emplace_back(b[j], space.h[j] - space.l[j]);
    }
    return best_lambda<double>(scratch, slack);
}

} // namespace cinch
