// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

namespace cinch {

/// An axis of a k-DOP: components in {−1, 0, 1}, so that a projection needs no multiplication. Not normalised.
using Axis = std::array<int, 3>;

/// All 13 axes of the 26-DOP: 3 faces, 4 corners, 6 edges.
inline constexpr std::array<Axis, 13> all_axes = {{{1, 0, 0},
                                                   {0, 1, 0},
                                                   {0, 0, 1},
                                                   {1, 1, 1},
                                                   {1, 1, -1},
                                                   {1, -1, 1},
                                                   {1, -1, -1},
                                                   {1, 1, 0},
                                                   {1, 0, 1},
                                                   {0, 1, 1},
                                                   {1, -1, 0},
                                                   {1, 0, -1},
                                                   {0, 1, -1}}};
inline constexpr std::array<Axis, 9> axes_18 = {
    {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {1, 0, 1}, {0, 1, 1}, {1, -1, 0}, {1, 0, -1}, {0, 1, -1}}};

inline constexpr bool is_kdop(int k) { return k == 6 || k == 14 || k == 18 || k == 26; }

/// The k/2 axes of a k-DOP, k ∈ {6, 14, 18, 26}; the faces (AABB) come first. A bound has k supports: place 2a is
/// max axis·v, place 2a + 1 is max −axis·v.
inline std::span<const Axis> axes_of(int k)
{
    if (k == 18)
        return axes_18;
    return std::span(all_axes).first(static_cast<std::size_t>(k / 2));
}

} // namespace cinch
