// SPDX-License-Identifier: GPL-3.0-or-later
// Internal to exact/.
#pragma once

#include <vector>

#include "exact/formulas.hpp"
#include "exact/verifier.hpp"

namespace cinch::exact {

/// All that one frame shares between BVs.
struct Frame {
    const DeformableSurface& surface;
    const Bvh& bvh;
    std::span<const AffineMap> maps;
    Methods methods;
    RestShape shape;
    std::span<const Axis> axes;
    std::vector<Point<Interval>> exact_vertices; // enclosures
    std::vector<Vec3> computed_vertices;
    const Displacements& displacements;
    std::span<const double> weights; // of morph targets; empty where they displace nothing

    /// Where a vertex is at rest: v⁰ + Σ_i a_i d_i.
    template <class N> Point<N> rest(std::size_t v) const
    {
        Point<N> out = as_point<N>(surface.mesh.vertices[v]);
        if (!weights.empty())
            for (const Displacements::One& d : displacements.of(v))
                for (std::size_t c = 0; c < 3; ++c)
                    out[c] = out[c] + N(weights[d.target]) * N(d.by[static_cast<int>(c)]);
        return out;
    }
    bool displaced(std::size_t v) const
    {
        for (const Displacements::One& d : displacements.of(v))
            if (!weights.empty() && weights[d.target] != 0)
                return true;
        return false;
    }
};

/// What the BVs of one task add to a verdict.
struct BlockResult {
    std::size_t decided_by_filter = 0;
    std::vector<Violation> violations;
    std::map<std::size_t, std::string> exact_lambda;
};

/// Proves the bounds of single BVs of a frame; one per task, for its scratch memory. Lives under DirectedRounding.
class BvCheck {
public:
    explicit BvCheck(const Frame& frame)
        : frame_(frame), boxes_(frame.methods.within(box_methods) && frame.shape == RestShape::aabb),
          weight_space_(frame.methods.within(weight_space_methods)), place_(frame.surface.weights.node_count)
    {
    }

    /// Writes the BV's own places of `out`, where rest_data is set already if it applies.
    void check(std::size_t bv, std::span<const std::uint32_t> vertices, std::span<const double> supports,
               FrameVerdict& out, BlockResult& block);

private:
    const Axis& axis() const { return frame_.axes[axis_]; }
    const std::vector<Interval>& extrema() const { return against_ ? minus_ : plus_; }
    void fail(Statement statement, std::string detail);
    void enclose_extrema();
    template <class N> void own_extrema(std::vector<N>& plus, std::vector<N>& minus) const;
    std::vector<Exact> exact_extrema() const;
    Interval true_support() const;
    void check_direction(const Interval& support, bool rest_holds, Loss& loss);
    void check_exact_vertices(const Interval& support);
    void check_computed_vertices();
    void check_weight_space();
    double greedy_lambda();
    Interval method_value() const;
    double scale() const;
    Interval boxes_at_actual_weights() const;
    void attribute(const Interval& support, Loss& loss) const;

    const Frame& frame_;
    const bool boxes_;               // extrema are those of the deformed rest box, else of each node's own vertices
    const bool weight_space_;        // the methods make that statement
    std::vector<std::size_t> place_; // of a simulation node in rest_.node; valid for nodes of the BV
    FrameVerdict* out_ = nullptr;
    BlockResult* block_ = nullptr;
    std::size_t bv_ = 0, axis_ = 0, slot_ = 0; // slot_: of the direction in the verdict's arrays
    bool against_ = false, exact_used_ = false, box_is_finite_ = true;
    double bound_ = 0;
    RestBv rest_;
    std::span<const std::uint32_t> vertices_;
    std::vector<Interval> plus_, minus_; // exact extrema along the axis and against it
    Interval optimum_;
    bool displaced_ = false; // by morph targets
    std::vector<std::size_t> order_;
};

} // namespace cinch::exact
