// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstring>
#include <memory>

#include "cinch/bvh.hpp"
#include "cinch/io.hpp"
#include "toolkit/python/src/arrays.hpp"
#include "toolkit/python/src/needed.hpp"
#include "toolkit/time/bake_clip.hpp"

namespace cinch::python {

/// Python's Surface: one of its own, one whose vertices stand in an array of the caller, or a part of something else.
/// Never moves; whoever refers to it shares it.
class Surface {
public:
    explicit Surface(DeformableSurface&& own) : own_(std::move(own)), at_(&own_) {}
    /// `there` lives as long as `keeper`.
    Surface(const DeformableSurface& there, std::shared_ptr<const void> keeper)
        : at_(&there), keeper_(std::move(keeper))
    {
    }
    /// `vertices` is shared where it can be, see stands_in; all else is in `rest`.
    Surface(Doubles vertices, DeformableSurface&& rest);
    ~Surface();
    Surface(const Surface&) = delete;
    Surface& operator=(const Surface&) = delete;

    const DeformableSurface& get() const { return *at_; }
    /// The array in which the vertices stand; none where they are this surface's own.
    const py::object& array() const { return array_; }
    /// Throws ValueError where somebody wrote into the array in which the vertices stand. Asked wherever vertices are
    /// read.
    void require_unchanged() const
    {
        if (array_ && sum() != sum_)
            throw py::value_error("the array of vertices was changed after the surface was made of it; "
                                  "Surface(..., copy=True) has a copy of its own");
    }

private:
    // Of all bits: four chains, each step of which is a bijection, so that no single change is missed.
    std::uint64_t sum() const
    {
        std::uint64_t chain[4] = {1, 2, 3, 4};
        const auto* data = reinterpret_cast<const char*>(own_.mesh.vertices.data());
        const std::size_t words = own_.mesh.vertices.size() * 3;
        for (std::size_t i = 0; i < words; ++i) {
            std::uint64_t word;
            std::memcpy(&word, data + 8 * i, 8);
            std::uint64_t& c = chain[i % 4];
            c = (c ^ word) * 0x9e3779b97f4a7c15u;
            c ^= c >> 29;
        }
        return chain[0] + 3 * chain[1] + 5 * chain[2] + 7 * chain[3];
    }

    DeformableSurface own_;
    const DeformableSurface* at_;
    std::shared_ptr<const void> keeper_;
    py::object array_, reference_; // the latter keeps NumPy from resizing it
    std::uint64_t sum_ = 0;
};

using SurfacePtr = std::shared_ptr<Surface>;

/// Python's Bvh: it keeps its surface.
struct Tree {
    Bvh bvh;
    SurfacePtr surface;
};
using TreePtr = std::shared_ptr<Tree>;

/// Throws ValueError unless the tree is over that surface; None stands for its own. The surface as it is to be read.
inline const DeformableSurface& surface_of_tree(const TreePtr& tree, const SurfacePtr& surface)
{
    if (surface && surface != tree->surface)
        throw py::value_error("the BVH was not built over this surface");
    tree->surface->require_unchanged();
    return tree->surface->get();
}

/// Python's Character: its surface is made once.
struct CharacterObject {
    Character character;
    WeightReport report;
    SurfacePtr surface;
    double least = 0, greatest = 0; ///< of with_any_weights, and the file as it was read
    std::shared_ptr<const CharacterObject> any_weights_of;
};
using CharacterPtr = std::shared_ptr<CharacterObject>;

/// One of its animations.
struct AnimationObject {
    CharacterPtr of;
    const Character::Animation* animation;
};

/// Python's Clip.
struct ClipObject {
    Clip clip;
    std::size_t nodes; ///< of each frame
};
using ClipPtr = std::shared_ptr<ClipObject>;

/// Python's Baked: bounds of a clip for all times.
struct Baked {
    CharacterPtr character;
    AnimationObject clip;
    TreePtr tree;
    std::size_t kdop;
    std::vector<BakedInterval> intervals;
};

/// The k supports per BV that somebody hands in: (BVs, k), or boxes, (BVs, 2, 3).
inline std::vector<double> supports_from(py::handle from, std::size_t bvs, std::optional<int> kdop = {})
{
    const Doubles given(from, "supports");
    const auto n = static_cast<py::ssize_t>(bvs);
    if (fits(given.array(), {n, 2, 3}) && kdop.value_or(6) == 6) {
        std::vector<double> out(6 * bvs);
        const auto values = given.values();
        for (std::size_t bv = 0; bv < bvs; ++bv)
            for (std::size_t a = 0; a < 3; ++a) {
                out[6 * bv + 2 * a] = values[6 * bv + 3 + a];
                out[6 * bv + 2 * a + 1] = -values[6 * bv + a];
            }
        return out;
    }
    const bool any_k = !kdop && given.ndim() == 2 && given.shape(0) == bvs && is_kdop(static_cast<int>(given.shape(1)));
    if (!any_k && !(kdop && fits(given.array(), {n, *kdop})))
        throw py::value_error("supports: an array of shape (" + std::to_string(bvs) + ", k), k " + kdop_names() +
                              ", or boxes, (" + std::to_string(bvs) + ", 2, 3), is needed, not " +
                              shape_of(given.array()));
    return {given.values().begin(), given.values().end()};
}

} // namespace cinch::python
