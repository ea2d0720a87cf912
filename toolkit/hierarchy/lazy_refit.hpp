// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cinch/collider.hpp"
#include "toolkit/hierarchy/bounder.hpp"
#include "toolkit/hierarchy/dop.hpp"
#include "toolkit/hierarchy/leaf_set.hpp"

namespace cinch {

/// The BVs of one body in a frame, brought up to date as far as a query goes (§4.2 of the paper). Each tree keeps its
/// *cut*: the BVs where the last query went no further. At the beginning of a frame these are bounded by the methods,
/// all above them by their children. What the query wants below is bounded when it wants it. Not thread-safe but for
/// what is const.
class LazyRefit {
public:
    static constexpr std::uint32_t no_slot = ~0u;

    /// The surface must stay as it is, and alive; so must the BVH for methods without kernels (sphere, corners,
    /// vertices), and the targets. Throws std::invalid_argument for leaves that have not enough lanes and a k that is
    /// none.
    LazyRefit(const Bvh& bvh, const DeformableSurface& surface, const LazyOptions& options,
              std::span<const MorphTarget> targets = {});

    /// Begins a frame; what it points to must stay alive through it. Throws std::invalid_argument unless there is one
    /// transform per simulation node and one weight per morph target, or one position per vertex.
    void begin(const BodyFrame& frame);

    bool empty() const { return links_.empty(); }
    /// False if the transform of a simulation node with influence is not finite, or so large that vertices may not be:
    /// nothing is known of where the body is.
    bool known() const { return known_; }
    const Vec3& origin() const { return origin_; } ///< to which supports and positions are relative
    const BodyFrame& frame() const { return now_; }

    /// What a query must know of a BV.
    struct Link {
        std::uint32_t child = 0;    ///< the first of two; of a leaf, its place among the leaves
        float size = 0;             ///< at rest; negative for a leaf
        std::uint32_t expanded = 0; ///< frame in which its children were last looked at

        bool is_leaf() const { return size < 0; }
    };
    const Link& link(std::uint32_t bv) const { return links_[bv]; }
    float* dop(std::uint32_t bv) { return dops_.data() + bv * dop_floats(options_.kdop); }
    const float* dop(std::uint32_t bv) const { return dops_.data() + bv * dop_floats(options_.kdop); }

    /// A query looks at a BV's children, of the root or where it looked at its parent's in this frame: they are noted
    /// where they are not up to date, and supply() bounds all that were noted, in parallel.
    void expand(std::uint32_t bv);
    void want(std::uint32_t bv); ///< the same for one BV
    void supply();
    /// The vertices of a leaf that is current: after a full update they are kept only of those that are wanted, from
    /// supply() on.
    void want_slot(std::uint32_t leaf);
    bool current(std::uint32_t bv) const { return dop(bv)[dop_side(options_.kdop) - 1] == stamp_; }

    /// Of a leaf that is current, and wanted. See LeafPlace.
    const float* slot(std::uint32_t bv) const
    {
        return slots_.data() + slot_of_[links_[bv].child] * leaf_slot_floats(leaves_.lanes);
    }
    const PackedLeaf& leaf(std::uint32_t bv) const { return leaves_.leaves[links_[bv].child]; }
    std::size_t lanes() const { return leaves_.lanes; }
    /// Triangle of the mesh, from a leaf's first_triangle on.
    std::uint32_t triangle(std::size_t place) const { return triangle_[place]; }

    const LazyCounts& counts() const { return counts_; } ///< of the frame so far
    bool fully_refitted() const { return full_; }
    std::size_t bytes() const; ///< of everything but the surface
    const LazyOptions& options() const { return options_; }

private:
    void begin_with(std::span<const Vec3> positions);
    void displace_all();
    void place_leaves();
    void note(std::uint32_t bv);
    void merge(std::uint32_t bv);
    void stamp(std::uint32_t bv) { dop(bv)[dop_side(options_.kdop) - 1] = stamp_; }
    void refit_all();
    bool was_expanded(std::uint32_t bv) const { return links_[bv].expanded + 1 == frame_; }

    const DeformableSurface& surface_;
    LazyOptions options_;
    Bounder bounder_;
    LeafSet leaves_;
    std::vector<Link> links_;
    std::vector<std::uint32_t> triangle_, influencing_; // influencing_: simulation nodes that have weight anywhere
    AlignedVector<float>
        dops_; ///< per BV dop_floats(k); the last pad along the axes is the stamp of the frame that set it
    AlignedVector<float> slots_;         ///< of the leaves deformed in this frame, in order of wanting
    std::vector<std::uint32_t> slot_of_; ///< per leaf
    std::size_t slots_used_ = 0;

    std::span<const MorphTarget> targets_;
    std::vector<Vec3> displaced_, placed_; ///< vertices with morph targets, at rest and in this frame

    BodyFrame now_;
    Vec3 origin_ = Vec3::Zero();
    std::uint32_t frame_ = 1;
    float stamp_ = 1;
    bool known_ = true, full_ = false;
    std::vector<std::uint32_t> expanded_, before_; ///< in this frame and the last one, parents first
    std::vector<std::uint32_t> wanted_;            ///< noted: BVs for the methods
    std::vector<LeafJob> jobs_;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> wanted_leaves_; ///< (BV, slot)
    LazyCounts counts_;
};

} // namespace cinch
