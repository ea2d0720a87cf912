// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

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

/// The rest data that a method needs of a BVH: boxes of BVs, also one per BV and simulation node, also extreme points and models of weights.
enum class RestNeed : std::uint8_t { boxes, local, points };

/// What the program must know of a method: lists of methods derive from this table.
struct MethodInfo {
    Method method;
    std::string_view name;
    bool kernel;       ///< has SIMD kernels; the others are computed in doubles, BV by BV
    bool weight_space; ///< holds for every w ∈ W' over the boxes that it needs
    bool chosen;       ///< `best` chooses among these
    RestNeed need;
};

inline constexpr std::array method_table = {
    MethodInfo{Method::convex, "convex", true, true, false, RestNeed::boxes},
    MethodInfo{Method::sphere, "sphere", false, false, false, RestNeed::boxes},
    MethodInfo{Method::corners, "corners", false, true, false, RestNeed::boxes},
    MethodInfo{Method::eq12, "eq12", true, true, false, RestNeed::boxes},
    MethodInfo{Method::limited, "limited", true, true, false, RestNeed::boxes},
    MethodInfo{Method::local, "local", true, true, true, RestNeed::local},
    MethodInfo{Method::support, "support", true, false, true, RestNeed::points},
    MethodInfo{Method::linear, "linear", true, false, true, RestNeed::points},
    MethodInfo{Method::best, "best", true, false, false, RestNeed::points},
    MethodInfo{Method::vertices, "vertices", false, false, false, RestNeed::boxes},
};
static_assert(method_table.back().method == Method::vertices && method_table.size() == static_cast<std::size_t>(Method::vertices) + 1,
              "a row for every method");
static_assert([] {
    for (std::size_t i = 0; i < method_table.size(); ++i)
        if (method_table[i].method != static_cast<Method>(i))
            return false;
    return true;
}(), "rows in the order of the enumeration");

constexpr const MethodInfo& info_of(Method method) { return method_table[static_cast<std::size_t>(method)]; }
constexpr std::string_view name_of(Method method) { return info_of(method).name; }

constexpr std::optional<Method> named_method(std::string_view name)
{
    for (const MethodInfo& info : method_table)
        if (info.name == name)
            return info.method;
    return std::nullopt;
}

/// One method or several, whose bounds are intersected: every valid upper bound may be intersected with every other.
class Methods {
public:
    constexpr Methods(Method method) : bits_(bit(method)) {}
    constexpr Methods operator|(Methods other) const { return Methods(static_cast<std::uint16_t>(bits_ | other.bits_)); }
    constexpr Methods without(Methods others) const { return Methods(static_cast<std::uint16_t>(bits_ & ~others.bits_)); }
    constexpr bool contains(Method method) const { return bits_ & bit(method); }
    /// True if no method is in this set that is not in `other`.
    constexpr bool within(Methods other) const { return (bits_ & ~other.bits_) == 0; }
    constexpr bool operator==(const Methods&) const = default;

    /// Its methods one by one, in the order of the ladder.
    class Iterator {
    public:
        using difference_type = std::ptrdiff_t;
        using value_type = Method;
        using reference = Method;
        using pointer = void;
        using iterator_category = std::input_iterator_tag;

        constexpr explicit Iterator(std::uint16_t bits) : bits_(bits) {}
        constexpr Method operator*() const { return static_cast<Method>(std::countr_zero(bits_)); }
        constexpr Iterator& operator++()
        {
            bits_ = static_cast<std::uint16_t>(bits_ & (bits_ - 1));
            return *this;
        }
        constexpr bool operator==(const Iterator&) const = default;

    private:
        std::uint16_t bits_;
    };
    constexpr Iterator begin() const { return Iterator(bits_); }
    constexpr Iterator end() const { return Iterator(0); }

    /// Those with which `wanted` agrees.
    template <class F> static constexpr Methods where(F wanted)
    {
        Methods all(std::uint16_t{0});
        for (const MethodInfo& info : method_table)
            if (wanted(info))
                all = all | info.method;
        return all;
    }

private:
    constexpr explicit Methods(std::uint16_t bits) : bits_(bits) {}
    static constexpr std::uint16_t bit(Method method) { return static_cast<std::uint16_t>(1u << static_cast<unsigned>(method)); }
    std::uint16_t bits_;
};
constexpr Methods operator|(Method a, Method b) { return Methods(a) | b; }

inline constexpr Methods all_methods = Methods::where([](const MethodInfo&) { return true; });
inline constexpr Methods kernel_methods = Methods::where([](const MethodInfo& m) { return m.kernel; });
/// What `best` chooses among.
inline constexpr Methods chosen_methods = Methods::where([](const MethodInfo& m) { return m.chosen; });
/// Those that hold for every w ∈ W' over the BV's own rest box, and of these the ones with kernels, each at least as tight as the one before it.
inline constexpr Methods box_methods = Methods::where([](const MethodInfo& m) { return m.weight_space && m.need == RestNeed::boxes; });
inline constexpr Methods ladder_methods = Methods::where([](const MethodInfo& m) { return m.weight_space && m.need == RestNeed::boxes && m.kernel; });
/// Those that hold for every w ∈ W' over whatever boxes.
inline constexpr Methods weight_space_methods = Methods::where([](const MethodInfo& m) { return m.weight_space; });

/// Whether one of them needs such rest data, or what needs more.
constexpr bool need(Methods methods, RestNeed need)
{
    for (const Method method : methods)
        if (info_of(method).need >= need)
            return true;
    return false;
}

/// The methods from the end of the ladder to its beginning.
inline std::vector<Method> tightest_first(Methods methods)
{
    std::vector<Method> all(methods.begin(), methods.end());
    std::reverse(all.begin(), all.end());
    return all;
}

/// The names of methods, in the order of the ladder.
inline std::vector<std::string_view> method_names(Methods methods = all_methods)
{
    std::vector<std::string_view> names;
    for (const Method method : methods)
        names.push_back(name_of(method));
    return names;
}

/// "support+linear", in the order of the ladder.
inline std::string name_of(Methods methods)
{
    std::string name;
    for (const Method method : methods)
        name += (name.empty() ? "" : "+") + std::string(name_of(method));
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
