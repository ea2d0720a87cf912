// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>

#include "cinch/refit.hpp"
#include "toolkit/bounds/projected_maps.hpp"

namespace cinch {

/// Bounds single BVs of one surface by the methods of the ladder, in the frame last begun. Surface and BVH must stay as
/// they are, and alive; with methods that have kernels (all but sphere, corners and vertices) and no remembered λ, the
/// BVH may go.
class Bounder {
public:
    enum class Leaves { included, left_out }; ///< those left out cost no memory, and must not be bounded

    /// Throws std::invalid_argument for a k that is none, std::runtime_error for a changed floating-point environment.
    Bounder(const Bvh& bvh, const DeformableSurface& surface, const RefitOptions& options, Leaves leaves);
    ~Bounder();
    Bounder(Bounder&&) noexcept;

    /// Begins a frame; `maps` must stay alive through it. Returns how many simulation nodes have a transform that is
    /// not finite, or too large for the arithmetic. Throws std::invalid_argument unless there is one transform per
    /// simulation node.
    std::size_t begin(std::span<const AffineMap> maps);

    /// supports[(bv − first)·k + d] for BVs [first, last), d as in axes_of(k), in the world. Any thread may call it.
    void bound(std::size_t first, std::size_t last, std::span<double> supports) const;
    /// Those of the BVs listed, as floats relative to maps().origin at dops + bv·dop_floats(k): see dop.hpp.
    void bound(std::span<const std::uint32_t> list, float* dops) const;

    /// That it will be bounded soon.
    void prefetch(std::uint32_t bv) const;

    const ProjectedMaps<float>& maps() const; ///< of the frame, whatever the methods and their precision
    const RestExtent& rest() const;
    std::size_t bytes() const; ///< of the rest data that the kernels stream

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

} // namespace cinch
