// SPDX-License-Identifier: Apache-2.0
#pragma once

/// \file
/// The choices of a bound: methods, k-DOPs, arithmetic; and boxes and k-DOPs as values.

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cinch/surface.hpp"

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
    moments,  ///< first and second moments of the weights, what they leave of every map by D; third order
    best,     ///< per BV the one of local, support, linear and moments that scored best at build
    vertices, ///< the vertices themselves, O(ℓ): the truth
};

/// The rest data that a method needs of a BVH: boxes of BVs, also one per BV and simulation node, also extreme points
/// and models of weights.
enum class RestNeed : std::uint8_t { boxes, local, points };

/// What the program must know of a method: lists of methods derive from this table.
struct MethodInfo {
    Method method;         ///< its value
    std::string_view name; ///< as options and records have it
    bool kernel;           ///< has SIMD kernels; the others are computed in doubles, BV by BV
    bool weight_space;     ///< holds for every w ∈ W' over the boxes that it needs
    bool chosen;           ///< `best` chooses among these
    RestNeed need;         ///< of the tree
};

/// A row for each method, in the order of the enumeration.
inline constexpr std::array method_table = {
    MethodInfo{Method::convex, "convex", true, true, false, RestNeed::boxes},
    MethodInfo{Method::sphere, "sphere", false, false, false, RestNeed::points},
    MethodInfo{Method::corners, "corners", false, true, false, RestNeed::boxes},
    MethodInfo{Method::eq12, "eq12", true, true, false, RestNeed::boxes},
    MethodInfo{Method::limited, "limited", true, true, false, RestNeed::boxes},
    MethodInfo{Method::local, "local", true, true, true, RestNeed::local},
    MethodInfo{Method::support, "support", true, false, true, RestNeed::points},
    MethodInfo{Method::linear, "linear", true, false, true, RestNeed::points},
    MethodInfo{Method::moments, "moments", true, false, true, RestNeed::points},
    MethodInfo{Method::best, "best", true, false, false, RestNeed::points},
    MethodInfo{Method::vertices, "vertices", false, false, false, RestNeed::boxes},
};
static_assert(method_table.back().method == Method::vertices &&
                  method_table.size() == static_cast<std::size_t>(Method::vertices) + 1,
              "a row for every method");
static_assert(
    [] {
        for (std::size_t i = 0; i < method_table.size(); ++i)
            if (method_table[i].method != static_cast<Method>(i))
                return false;
        return true;
    }(),
    "rows in the order of the enumeration");

/// A method's row.
constexpr const MethodInfo& info_of(Method method) { return method_table[static_cast<std::size_t>(method)]; }
/// A method's name.
constexpr std::string_view name_of(Method method) { return info_of(method).name; }

/// The method of that name; empty for a name that is none.
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
    /// One method alone.
    constexpr Methods(Method method) : bits_(bit(method)) {}
    /// Those in either set.
    constexpr Methods operator|(Methods other) const
    {
        return Methods(static_cast<std::uint16_t>(bits_ | other.bits_));
    }
    /// Those that are not in `others`.
    constexpr Methods without(Methods others) const
    {
        return Methods(static_cast<std::uint16_t>(bits_ & ~others.bits_));
    }
    /// Whether it is one of them.
    constexpr bool contains(Method method) const { return bits_ & bit(method); }
    /// True if no method is in this set that is not in `other`.
    constexpr bool within(Methods other) const { return (bits_ & ~other.bits_) == 0; }
    /// Whether both hold the same methods.
    constexpr bool operator==(const Methods&) const = default;

    /// \cond
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
    /// \endcond
    /// Its methods one by one, in the order of the ladder.
    constexpr Iterator begin() const { return Iterator(bits_); }
    /// Where they end.
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
    static constexpr std::uint16_t bit(Method method)
    {
        return static_cast<std::uint16_t>(1u << static_cast<unsigned>(method));
    }
    std::uint16_t bits_;
};
/// Both.
constexpr Methods operator|(Method a, Method b) { return Methods(a) | b; }

/// Every method there is.
inline constexpr Methods all_methods = Methods::where([](const MethodInfo&) { return true; });
/// Those that have SIMD kernels.
inline constexpr Methods kernel_methods = Methods::where([](const MethodInfo& m) { return m.kernel; });
/// What `best` chooses among.
inline constexpr Methods chosen_methods = Methods::where([](const MethodInfo& m) { return m.chosen; });
/// Those that hold for every w ∈ W' over the BV's own rest box.
inline constexpr Methods box_methods =
    Methods::where([](const MethodInfo& m) { return m.weight_space && m.need == RestNeed::boxes; });
/// Of these the ones with kernels, each at least as tight as the one before it.
inline constexpr Methods ladder_methods =
    Methods::where([](const MethodInfo& m) { return m.weight_space && m.need == RestNeed::boxes && m.kernel; });
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
/// The axes of the 18-DOP: 3 faces, 6 edges.
inline constexpr std::array<Axis, 9> axes_18 = {
    {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {1, 0, 1}, {0, 1, 1}, {1, -1, 0}, {1, 0, -1}, {0, 1, -1}}};

/// The k-DOPs there are, by their numbers of directions. (CMakeLists.txt reads this line.)
inline constexpr std::array kdops = {6, 14, 18, 26};
/// Of any k-DOP.
inline constexpr std::size_t most_directions = *std::max_element(kdops.begin(), kdops.end());
/// Whether there is a k-DOP with so many directions.
inline constexpr bool is_kdop(int k) { return std::find(kdops.begin(), kdops.end(), k) != kdops.end(); }

/// "6, 14, 18 or 26".
inline std::string kdop_names()
{
    std::string names;
    for (std::size_t i = 0; i < kdops.size(); ++i)
        names += (i == 0 ? "" : i + 1 < kdops.size() ? ", " : " or ") + std::to_string(kdops[i]);
    return names;
}

/// The k/2 axes of a k-DOP; the faces (AABB) come first. A bound has k supports: place 2a is max axis·v, place 2a + 1
/// is max −axis·v.
inline std::span<const Axis> axes_of(int k)
{
    if (k == 18)
        return axes_18;
    return std::span(all_axes).first(static_cast<std::size_t>(k / 2));
}

/// Calls `f.operator()<A>()`, A the number of axes, for a k-DOP. Throws std::invalid_argument for a k that is none.
template <class F> void with_axes(int k, F&& f)
{
    const bool found = [&]<std::size_t... i>(std::index_sequence<i...>)
    {
        return ((k == kdops[i] ? (f.template operator()<static_cast<std::size_t>(kdops[i] / 2)>(), true) : false) ||
                ...);
    }
    (std::make_index_sequence<kdops.size()>());
    if (!found)
        throw std::invalid_argument("k must be " + kdop_names());
}

/// Whether results carry the error terms of rounding.hpp and so are proven bounds. `plain` is double arithmetic as it
/// comes, which falls below the exact value about every fourth time; it exists to measure what the proof costs.
enum class Rounding { proven, plain };

/// The arithmetic of the kernels. Both give proven bounds; float's are looser by a few 1e-6 of the surface's extent.
/// Where a BV has more simulation nodes than float takes (most_nodes_in_float), double is used throughout.
enum class Precision { float32, float64 };

/// "float" or "double".
constexpr std::string_view name_of(Precision precision) { return precision == Precision::float32 ? "float" : "double"; }

/// Which rest box of a BV the methods without local boxes use.
enum class RestShape : std::uint8_t { aabb, obb };

/// A closed axis-aligned box; none if lower > upper on any axis.
struct Aabb {
    Vec3 lower; ///< corner with the least coordinates
    Vec3 upper; ///< and with the greatest
    /// Borders included.
    bool contains(const Vec3& p) const
    {
        return (p.array() >= lower.array()).all() && (p.array() <= upper.array()).all();
    }
    /// Whether both corners are the same.
    bool operator==(const Aabb&) const = default;
};

/// A k-DOP: for every axis a of axes_of(k) the slab against(a) ≤ a·x ≤ along(a). Stored as supports are everywhere:
/// place 2a is the greatest a·x, place 2a + 1 the greatest −a·x.
class Dop {
public:
    /// From the supports of one BV, k of them. Throws std::invalid_argument for a k that is none.
    explicit Dop(std::span<const double> supports)
    {
        if (!is_kdop(static_cast<int>(supports.size())))
            throw std::invalid_argument("a k-DOP has " + kdop_names() + " supports");
        std::copy(supports.begin(), supports.end(), support_.begin());
        k_ = static_cast<int>(supports.size());
    }
    /// The number of directions.
    int k() const { return k_; }
    /// k/2 axes.
    std::span<const Axis> axes() const { return axes_of(k_); }
    /// The greatest a·x of axis number `axis`.
    double along(std::size_t axis) const { return support_[2 * axis]; }
    /// The least one.
    double against(std::size_t axis) const { return -support_[2 * axis + 1]; }
    /// The first three axes are those of coordinates.
    Aabb aabb() const { return {{against(0), against(1), against(2)}, {along(0), along(1), along(2)}}; }
    /// In doubles as they come: a·x is rounded where the axis is no coordinate axis.
    bool contains(const Vec3& p) const
    {
        for (std::size_t a = 0; a < axes().size(); ++a) {
            const Axis& axis = axes()[a];
            const double along_axis = axis[0] * p[0] + axis[1] * p[1] + axis[2] * p[2];
            if (!(along_axis <= along(a) && along_axis >= against(a)))
                return false;
        }
        return true;
    }

private:
    std::array<double, most_directions> support_{};
    int k_ = 0;
};

} // namespace cinch
