// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace cinch {

/// The ladder of bounding methods.
enum class Method : std::uint8_t {
    convex,   ///< max_j b_j: all convex weights (§5.1.2 of the paper)
    sphere,   ///< accumulated-deformation sphere; a reconstruction of the baseline of the paper's Fig. 5
    corners,  ///< all n(n − 1) corners of §5.2.2, evaluated in O(n²)
    eq12,     ///< the paper's Eq. 12, D at the second-largest b
    limited,  ///< the exact optimum over W': D at the best λ
    local,    ///< D with one rest box per (BV, simulation node), λ near the best one
    support,  ///< rest support of a reference map, and `local` for the rest of every map
    linear,   ///< affine model of the weights with residuals, over the same rest support; no λ
    best,     ///< per BV the one of local, support and linear that scored best at build
    vertices, ///< the vertices themselves, O(ℓ): the truth
};

inline constexpr std::array<std::string_view, 10> method_names = {"convex", "sphere",  "corners", "eq12", "limited",
                                                                  "local",  "support", "linear",  "best", "vertices"};

constexpr std::string_view name_of(Method method) { return method_names[static_cast<std::size_t>(method)]; }

constexpr std::optional<Method> named_method(std::string_view name)
{
    for (std::size_t i = 0; i < method_names.size(); ++i)
        if (method_names[i] == name)
            return static_cast<Method>(i);
    return std::nullopt;
}

/// One method or several, whose bounds are intersected: every valid upper bound may be intersected with every other.
class Methods {
public:
    constexpr Methods(Method method) : bits_(bit(method)) {}
    constexpr Methods operator|(Methods other) const { return Methods(static_cast<std::uint16_t>(bits_ | other.bits_)); }
    constexpr Methods without(Method method) const { return Methods(static_cast<std::uint16_t>(bits_ & ~bit(method))); }
    constexpr bool contains(Method method) const { return bits_ & bit(method); }
    /// True if no method is in this set that is not in `other`.
    constexpr bool within(Methods other) const { return (bits_ & ~other.bits_) == 0; }
    constexpr bool operator==(const Methods&) const = default;

private:
    constexpr explicit Methods(std::uint16_t bits) : bits_(bits) {}
    static constexpr std::uint16_t bit(Method method) { return static_cast<std::uint16_t>(1u << static_cast<unsigned>(method)); }
    std::uint16_t bits_;
};
constexpr Methods operator|(Method a, Method b) { return Methods(a) | b; }

/// Those that hold for every w ∈ W' over the BV's own rest box.
inline constexpr Methods box_methods = Method::convex | Method::corners | Method::eq12 | Method::limited;

/// "support+linear", in the order of the ladder.
inline std::string name_of(Methods methods)
{
    std::string name;
    for (std::size_t i = 0; i < method_names.size(); ++i)
        if (methods.contains(static_cast<Method>(i)))
            name += (name.empty() ? "" : "+") + std::string(method_names[i]);
    return name;
}

/// Reads "support" or "support+linear"; empty for a name that is none.
inline std::optional<Methods> named_methods(std::string_view text)
{
    std::optional<Methods> methods;
    for (;;) {
        const std::size_t plus = text.find('+');
        const auto method = named_method(text.substr(0, plus));
        if (!method)
            return std::nullopt;
        methods = methods ? *methods | *method : Methods(*method);
        if (plus == std::string_view::npos)
            return methods;
        text.remove_prefix(plus + 1);
    }
}

} // namespace cinch
