// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

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

/// The k-DOPs there are, by their numbers of directions. (CMakeLists.txt reads this line.)
inline constexpr std::array kdops = {6, 14, 18, 26};
inline constexpr std::size_t most_directions = *std::max_element(kdops.begin(), kdops.end());
inline constexpr bool is_kdop(int k) { return std::find(kdops.begin(), kdops.end(), k) != kdops.end(); }

/// "6, 14, 18 or 26".
inline std::string kdop_names()
{
    std::string names;
    for (std::size_t i = 0; i < kdops.size(); ++i)
        names += (i == 0 ? "" : i + 1 < kdops.size() ? ", " : " or ") + std::to_string(kdops[i]);
    return names;
}

/// The k/2 axes of a k-DOP; the faces (AABB) come first. A bound has k supports: place 2a is max axis·v, place 2a + 1 is max −axis·v.
inline std::span<const Axis> axes_of(int k)
{
    if (k == 18)
        return axes_18;
    return std::span(all_axes).first(static_cast<std::size_t>(k / 2));
}

/// Calls f.operator()<number of axes>() for a k-DOP. Throws std::invalid_argument for a k that is none.
template <class F> void with_axes(int k, F&& f)
{
    const bool found = [&]<std::size_t... i>(std::index_sequence<i...>) {
        return ((k == kdops[i] ? (f.template operator()<static_cast<std::size_t>(kdops[i] / 2)>(), true) : false) || ...);
    }(std::make_index_sequence<kdops.size()>());
    if (!found)
        throw std::invalid_argument("k must be " + kdop_names());
}

} // namespace cinch
