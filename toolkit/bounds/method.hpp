// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace cinch {

/// The ladder of bounding methods, loosest first.
enum class Method {
    convex,   ///< max_j b_j: all convex weights (§5.1.2 of the paper)
    eq12,     ///< the paper's Eq. 12, D at the second-largest b
    limited,  ///< the exact optimum over W': D at the best λ
    vertices, ///< the vertices themselves, O(ℓ): the truth
};

inline constexpr std::array<std::string_view, 4> method_names = {"convex", "eq12", "limited", "vertices"};

constexpr std::string_view name_of(Method method) { return method_names[static_cast<std::size_t>(method)]; }

constexpr std::optional<Method> named_method(std::string_view name)
{
    for (std::size_t i = 0; i < method_names.size(); ++i)
        if (method_names[i] == name)
            return static_cast<Method>(i);
    return std::nullopt;
}

} // namespace cinch
