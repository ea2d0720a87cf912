// SPDX-License-Identifier: Apache-2.0
#pragma once

// Integers that hold the determinant of any three differences of finite doubles, in units of the least bit of all
// coordinates. A double is less than 2^2098 units of 2^-1074, a difference less than 2^2099, the product of three less
// than 2^6297 and the determinant, six of those, less than 2^6300: 197 words of 32 bits. A difference has 66 words, the
// product of two 132, so that of three has 198 before the leading zero goes.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace cinch {

/// Sign and magnitude. Words from the least significant one, the last one not zero; no word is the value 0.
struct BigInteger {
    bool negative = false;
    std::size_t size = 0;
    std::array<std::uint32_t, 198> word; ///< the first `size` are meaningful

    int sign() const noexcept { return size == 0 ? 0 : negative ? -1 : 1; }
    void trim() noexcept
    {
        while (size > 0 && word[size - 1] == 0)
            --size;
    }
};

/// The exponent of the unit in the last place of x ≠ 0, not below −1074: x is a multiple of 2 to the power of it.
inline int unit_exponent(double x) noexcept
{
    int exponent;
    std::frexp(x, &exponent); // |x| in [2^(exponent − 1), 2^exponent)
    return std::max(exponent - 53, -1074);
}

/// x / 2^unit, an integer, for finite x with unit_exponent(x) ≥ unit or x = 0.
inline BigInteger scaled(double x, int unit) noexcept
{
    BigInteger result;
    if (x == 0)
        return result;
    const int exponent = unit_exponent(x);
    const auto mantissa = static_cast<std::uint64_t>(std::ldexp(std::abs(x), -exponent)); // < 2^53, exact
    const auto shift = static_cast<std::size_t>(exponent - unit);
    result.negative = x < 0;
    result.size = shift / 32 + 3; // mantissa·2^31 < 2^84
    std::fill_n(result.word.begin(), result.size, 0);
    const std::size_t bits = shift % 32;
    const std::uint64_t low = (mantissa & 0xffffffff) << bits, high = (mantissa >> 32) << bits;
    const std::uint64_t middle = (low >> 32) + (high & 0xffffffff); // no carry: the bits do not overlap
    result.word[shift / 32] = static_cast<std::uint32_t>(low);
    result.word[shift / 32 + 1] = static_cast<std::uint32_t>(middle);
    result.word[shift / 32 + 2] = static_cast<std::uint32_t>(high >> 32);
    result.trim();
    return result;
}

inline int compare_magnitudes(const BigInteger& a, const BigInteger& b) noexcept
{
    if (a.size != b.size)
        return a.size < b.size ? -1 : 1;
    for (std::size_t i = a.size; i-- > 0;)
        if (a.word[i] != b.word[i])
            return a.word[i] < b.word[i] ? -1 : 1;
    return 0;
}

/// a + b, or a − b.
inline BigInteger sum(const BigInteger& a, const BigInteger& b, bool negate_b) noexcept
{
    const bool b_is_negative = b.negative != negate_b;
    const bool a_is_larger = compare_magnitudes(a, b) >= 0;
    const BigInteger &large = a_is_larger ? a : b, &small = a_is_larger ? b : a;
    BigInteger result;
    result.negative = a_is_larger ? a.negative : b_is_negative;
    result.size = large.size;
    const bool subtract = a.negative != b_is_negative;
    std::uint64_t carry = 0; // or borrow
    for (std::size_t i = 0; i < large.size; ++i) {
        const std::uint64_t other = (i < small.size ? small.word[i] : 0) + carry;
        const std::uint64_t digit = subtract ? large.word[i] - other : large.word[i] + other;
        result.word[i] = static_cast<std::uint32_t>(digit);
        carry = digit >> 32 & 1; // a negative difference wraps around and sets every bit above 32
    }
    if (carry != 0)
        result.word[result.size++] = 1;
    result.trim();
    return result;
}

inline BigInteger operator+(const BigInteger& a, const BigInteger& b) noexcept { return sum(a, b, false); }
inline BigInteger operator-(const BigInteger& a, const BigInteger& b) noexcept { return sum(a, b, true); }

inline BigInteger operator*(const BigInteger& a, const BigInteger& b) noexcept
{
    BigInteger product;
    if (a.size == 0 || b.size == 0)
        return product;
    product.negative = a.negative != b.negative;
    product.size = a.size + b.size;
    std::fill_n(product.word.begin(), product.size, 0);
    std::size_t first = 0; // word of b that is not 0: of a double far above the unit all but the last three are
    while (b.word[first] == 0)
        ++first;
    for (std::size_t i = 0; i < a.size; ++i) {
        if (a.word[i] == 0)
            continue;
        std::uint64_t carry = 0;
        for (std::size_t j = first; j < b.size; ++j) {
            const std::uint64_t digit =
                std::uint64_t{a.word[i]} * b.word[j] + product.word[i + j] + carry; // at most 2^64 − 1
            product.word[i + j] = static_cast<std::uint32_t>(digit);
            carry = digit >> 32;
        }
        product.word[i + b.size] = static_cast<std::uint32_t>(carry);
    }
    product.trim();
    return product;
}

} // namespace cinch
