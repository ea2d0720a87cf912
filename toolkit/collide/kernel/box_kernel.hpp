// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace cinch {

/// A BV of one body and one of another.
struct BvPair {
    std::uint32_t a, b;
};

/// Two BVs, or two BVs in a row where the flag is set, of either body: 1, 2 or 4 pairs to test.
struct BoxTest {
    static constexpr std::uint32_t both = 1u << 31; ///< the BV after it too
    std::uint32_t a, b;
};

struct BoxInput {
    std::size_t side = 4; ///< dop_side(k)
    const float *dops_a, *dops_b;
    const float*
        shift; ///< dop_floats(k): along every direction where b's origin lies from a's, negated, see pair_shift
};

/// Writes the pairs that may overlap to `out`, which has room for four per test, in order; returns the end. Written as
/// a rejection: what is not a number overlaps. A pair is rejected only if its k-DOPs are disjoint: fl(A + B) has the
/// sign of A + B, and the shift has room for the rounding of A + B where it is not 0.
BvPair* test_boxes(const BoxInput& input, std::span<const BoxTest> tests, BvPair* out);

} // namespace cinch
