// SPDX-License-Identifier: Apache-2.0
#pragma once

// Exact sums, differences and products of doubles as expansions [Shewchuk 1997]: the value is the sum of the terms,
// which do not overlap and grow in magnitude, so its sign is that of the last. Exact as long as no operation overflows
// and every product of terms is a multiple of 2^-1074. Must be compiled with this project's flags.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace cinch {

/// At most N terms, none of them zero; no term is the value 0.
template <int N> struct Expansion {
    int size = 0;
    std::array<double, N> term; ///< the first `size` are meaningful

    int sign() const noexcept { return size == 0 ? 0 : term[static_cast<std::size_t>(size) - 1] > 0 ? 1 : -1; }

    /// Grow-Expansion: adds b exactly; one term more at most.
    void add(double b) noexcept
    {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < static_cast<std::size_t>(size); ++i) {
            const double rounded = b + term[i]; // TwoSum [Knuth]: rounded + error = b + term exactly
            const double virtual_b = rounded - term[i];
            const double error = (b - virtual_b) + (term[i] - (rounded - virtual_b));
            if (error != 0)
                term[kept++] = error;
            b = rounded;
        }
        if (b != 0)
            term[kept++] = b;
        size = static_cast<int>(kept);
    }
};

/// a − b of two doubles.
inline Expansion<2> exact_difference(double a, double b) noexcept
{
    Expansion<2> d;
    d.add(a);
    d.add(-b);
    return d;
}

/// a + factor·b, factor 1 or −1.
template <int N, int M> Expansion<N + M> sum(const Expansion<N>& a, const Expansion<M>& b, double factor) noexcept
{
    Expansion<N + M> result;
    result.size = a.size;
    std::copy_n(a.term.begin(), a.size, result.term.begin());
    for (std::size_t i = 0; i < static_cast<std::size_t>(b.size); ++i)
        result.add(factor * b.term[i]);
    return result;
}

template <int N, int M> Expansion<N + M> operator+(const Expansion<N>& a, const Expansion<M>& b) noexcept
{
    return sum(a, b, 1);
}
template <int N, int M> Expansion<N + M> operator-(const Expansion<N>& a, const Expansion<M>& b) noexcept
{
    return sum(a, b, -1);
}

template <int N, int M> Expansion<2 * N * M> operator*(const Expansion<N>& a, const Expansion<M>& b) noexcept
{
    Expansion<2 * N * M> product;
    for (std::size_t i = 0; i < static_cast<std::size_t>(a.size); ++i)
        for (std::size_t j = 0; j < static_cast<std::size_t>(b.size); ++j) {
            const double high = a.term[i] * b.term[j];
            const double low = std::fma(a.term[i], b.term[j], -high); // TwoProduct: high + low = a·b exactly
            if (low != 0)
                product.add(low);
            product.add(high);
        }
    return product;
}

} // namespace cinch
