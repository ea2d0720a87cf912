// SPDX-License-Identifier: Apache-2.0
#pragma once

/// \file
/// Bounds of every BV of a deforming surface, frame after frame.

#include <chrono>
#include <memory>
#include <span>

#include "cinch/bvh.hpp"

namespace cinch {

/// How a surface is bounded.
struct RefitOptions {
    Methods methods = Method::best;       ///< several are intersected
    int kdop = 6;                         ///< 6, 14, 18 or 26
    Rounding rounding = Rounding::proven; ///< `plain` proves nothing
    Precision precision =
        Precision::float32;                 ///< of the methods that have kernels: all but sphere, corners and vertices
    int passes = 1;                         ///< evaluations of D for local, support, moments and best
    RestShape rest_shape = RestShape::aabb; ///< for convex, eq12 and limited
    bool remember = false; ///< λ of local, support, moments and best begins where the last frame left it
};

/// What of a frame could not be bounded.
struct RefitReport {
    std::size_t unbounded_nodes = 0; ///< simulation nodes whose transform is not finite, or too large for the
                                     ///< arithmetic of the methods that have kernels
    std::size_t infinite = 0;        ///< supports that are +∞ for whatever reason
};

/// Bounds every BV of one surface, frame after frame. All but `vertices` cost O(n) per BV (`corners` O(n²)) and do not
/// touch the vertices. Surface and BVH must stay as they are, and alive.
class Refitter {
public:
    /// Prepares the rest data that the methods need. Throws std::invalid_argument for a k that is none.
    /// `targets`: morph targets whose weights frames have; they must stay as they are, and alive, too.
    Refitter(const Bvh& bvh, const DeformableSurface& surface, const RefitOptions& options,
             std::span<const MorphTarget> targets = {});
    Refitter(const Bvh&&, const DeformableSurface&, const RefitOptions&,
             std::span<const MorphTarget> = {}) = delete; ///< both are referred to
    Refitter(const Bvh&, const DeformableSurface&&, const RefitOptions&, std::span<const MorphTarget> = {}) = delete;
    ~Refitter();
    /// What was moved from can only be destroyed.
    Refitter(Refitter&&) noexcept;

    /// supports[bv·k + d], d as in axes_of(k). In parallel over BVs; the same bits for every thread count and every
    /// target. A transform that is not finite, in whatever entry, makes all supports of the BVs that its simulation
    /// node influences infinite, and changes no other; or, on a surface far from the origin of coordinates, others by
    /// rounding at most, should the grid cell of the median node change. Throws std::invalid_argument for sizes that do
    /// not fit and std::runtime_error for a changed floating-point environment.
    RefitReport operator()(std::span<const AffineMap> maps, std::span<double> supports);

    /// The same of the surface displaced by its morph targets with these weights (Clip::weights), one per target or
    /// none: to what bounds it undisplaced is added what the boxes of each BV's displacements reach, O(targets + nodes)
    /// per BV. Weights that are not finite make the supports of the BVs infinite that their targets displace.
    RefitReport operator()(std::span<const AffineMap> maps, std::span<const double> weights,
                           std::span<double> supports);

    /// Of the rest data that the kernels stream.
    std::size_t bytes() const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

/// A single frame: prepares everything anew.
RefitReport refit(const Bvh& bvh, const DeformableSurface& surface, std::span<const AffineMap> maps,
                  const RefitOptions& options, std::span<double> supports);

/// Bounds one BV ever tighter, for as long as there is time: branch and bound down the tree. At any moment each support
/// is proven as those of a Refitter are; in the end it is what the method `vertices` says of the BV, or less. A step
/// bounds two BVs or the vertices of one leaf, so only the few BVs that reach far out are ever looked at. Not
/// thread-safe.
class AnytimeBounder {
public:
    /// Prepares the rest data that the methods need. Throws std::invalid_argument for a k that is none. Surface and BVH
    /// must stay as they are, and alive.
    AnytimeBounder(const Bvh& bvh, const DeformableSurface& surface, const RefitOptions& options = {});
    AnytimeBounder(const Bvh&&, const DeformableSurface&, const RefitOptions& = {}) = delete; ///< both are referred to
    AnytimeBounder(const Bvh&, const DeformableSurface&&, const RefitOptions& = {}) = delete;
    ~AnytimeBounder();
    /// What was moved from can only be destroyed.
    AnytimeBounder(AnytimeBounder&&) noexcept;

    /// Begins a frame; `maps` must stay alive through it. Throws std::invalid_argument unless there is one transform
    /// per simulation node, and std::runtime_error for a changed floating-point environment.
    void begin(std::span<const AffineMap> maps);
    /// Of this BV in the frame, by the methods alone. Throws std::out_of_range for one that the BVH does not have.
    void begin(std::size_t bv);

    /// One step where there is most to gain; no support grows. False, and nothing is done, where there is nothing left.
    bool refine();
    /// Steps until this time has passed, or nothing is left; the last one may take some microseconds more. The number
    /// of steps.
    std::size_t refine_for(std::chrono::nanoseconds budget);
    /// Steps until each support is above what the vertices reach by at most `tolerance` ≥ 0 times the BV's width along
    /// that axis, or nothing is left. The number of steps.
    std::size_t refine_to(double tolerance);

    std::span<const double> supports() const; ///< k, d as in axes_of(k); after begin(bv)
    /// What the BV's vertices reach at least, by what steps have looked at; of single vertices as the method `vertices`
    /// bounds them. −∞ where nothing is known.
    std::span<const double> reached() const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

/// How a crowd is bounded.
struct CrowdOptions {
    int level = 0; ///< of the tree: its BVs, and leaves above it, are the boxes; 0: one box, of the root
    Rounding rounding = Rounding::proven; ///< `plain` is the formula of engines, and proves nothing
};

/// Boxes of many bodies that share one surface, each in a pose of its own: crowds of a character. A box per simulation
/// node and BV, transformed and united, as engines bound a character; but in binary32 with room for all rounding, so
/// that every box contains its BV's vertices in real arithmetic and as evaluate_vertex computes them. A Refitter is
/// tighter where BVs have many simulation nodes; this is the least that a box costs.
class CrowdRefitter {
public:
    /// Copies the rest data, which all bodies share. Throws std::invalid_argument for a level below 0, and for a BVH
    /// without local boxes (RestDetail::boxes).
    CrowdRefitter(const Bvh& bvh, const DeformableSurface& surface, const CrowdOptions& options = {});
    ~CrowdRefitter();
    /// What was moved from can only be destroyed.
    CrowdRefitter(CrowdRefitter&&) noexcept;

    /// The BVs whose boxes these are.
    const std::vector<std::uint32_t>& bvs() const;

    /// maps[i·J + j] moves simulation node j of body i, J of the surface; out[i·B + b] is the box of its BV bvs()[b], B
    /// of them. In parallel over bodies; the same bits for every thread count and every target. Where a map is not
    /// finite the boxes that its simulation node reaches are infinite. Throws std::invalid_argument for sizes that do
    /// not fit and std::runtime_error for a changed floating-point environment.
    void operator()(std::span<const AffineMap> maps, std::span<Aabb> out) const;

    /// Of the rest data.
    std::size_t bytes() const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

} // namespace cinch
