// SPDX-License-Identifier: Apache-2.0
#pragma once

/// \file
/// How it is deformed: clips of transforms, vertices, and weights for bodies without a skeleton.

#include <functional>
#include <memory>

#include "cinch/surface.hpp"

namespace cinch {

/// Motion as frames, each made when it is asked for: a clip of a million frames takes the memory of those that are
/// held. Frame i moves simulation node j by frame(i)[j]; all frames have as many maps. Copies share what the frames are
/// made from.
class Clip {
public:
    using Frame = std::vector<AffineMap>; ///< a map per simulation node

    Clip() = default;
    /// Frames that are computed. `time_s` and `frame` are called with i < count, by any thread, and always answer the
    /// same.
    /// `weights`, where morph targets displace vertices: theirs.
    Clip(std::string clip_name, std::size_t count, std::function<double(std::size_t)> time_s,
         std::function<Frame(std::size_t)> frame, std::function<std::vector<double>(std::size_t)> weights = {});
    /// Frames that are there already, one per time. Throws std::invalid_argument where their numbers differ.
    Clip(std::string clip_name, std::vector<double> time_s, std::vector<Frame> frames);

    /// Of a clip made by default 0.
    std::size_t frame_count() const { return count_; }
    /// i < frame_count(), else std::out_of_range; in seconds.
    double time_s(std::size_t i) const;
    /// The same for the maps. Throws InputError where a computed frame overflows.
    Frame frame(std::size_t i) const;
    /// The same for the weights of all morph targets, finite; empty where none of them displaces anything in the clip.
    std::vector<double> weights(std::size_t i) const;
    /// Whether morph targets displace vertices.
    bool displaces() const { return bool(weights_); }

    std::string name; ///< as files call it

private:
    std::size_t checked(std::size_t i) const;

    std::size_t count_ = 0;
    std::function<double(std::size_t)> time_s_;
    std::function<Frame(std::size_t)> frame_;
    std::function<std::vector<double>(std::size_t)> weights_;
};

/// `frames` of the clip, evenly spread, the last one included; 0, and as many as it has or more, keep all. The clip has
/// at most 10¹² frames.
Clip evenly_spread(const Clip& clip, std::size_t frames);

/// v_k = Σ_j w_kj (A_j v⁰_k + t_j) (Eq. 3) in double. This is *the* computed vertex: its operations and their order are
/// fixed (per node and coordinate ((a₀x + a₁y) + a₂z) + t, times w, summed in the order of the row; no fused
/// operations), every caller gets the same bits, and the bounds are proven to contain it. Non-finite maps give
/// non-finite coordinates.
Vec3 evaluate_vertex(const Vec3& rest, Weights::Row row, std::span<const AffineMap> maps) noexcept;

/// Adds Σ_i a_i d_i to rest vertices, in double, in the order of the targets; the bounds are proven to contain what
/// evaluate_vertex makes of them. Where displacements are boxes (MorphTarget::half), by their middles. Throws
/// std::invalid_argument unless there is one weight per target.
void displace(std::span<const MorphTarget> targets, std::span<const double> weights, std::span<Vec3> rest);

/// All vertices, in parallel; the same bits for every thread count. `out` has one place per vertex. Throws
/// std::runtime_error for a changed floating-point environment (environment.hpp).
void evaluate(std::span<const Vec3> rest, const Weights& weights, std::span<const AffineMap> maps, std::span<Vec3> out);

/// Evaluates all vertices of one surface, frame after frame, by SIMD: groups of 8 vertices that lie near each other,
/// one in a lane, go through the simulation nodes that influence any of them, with weight 0 where a node does not. The
/// surface must stay as it is, and alive.
///
/// In double the positions are those of evaluate_vertex, bit for bit: a term of 0 changes no sum that began at +0. In
/// float they are within 1e-5 of the greatest distance of a node's image of the surface from the mean one: for pictures
/// and files, not for proofs.
template <class T> class SurfaceEvaluator {
public:
    /// Packs the surface's weights into groups.
    explicit SurfaceEvaluator(const DeformableSurface& surface);
    explicit SurfaceEvaluator(const DeformableSurface&& surface) = delete; ///< it would refer to what is gone
    ~SurfaceEvaluator();
    /// What was moved from can only be assigned to or destroyed.
    SurfaceEvaluator(SurfaceEvaluator&&) noexcept;
    /// The same.
    SurfaceEvaluator& operator=(SurfaceEvaluator&&) noexcept;

    /// `out` has a place per vertex. In parallel. Non-finite maps give non-finite coordinates where they have weight,
    /// and nowhere else.
    void operator()(std::span<const AffineMap> maps, std::span<Vec3> out) const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

extern template class SurfaceEvaluator<double>;
extern template class SurfaceEvaluator<float>;

/// Simulation nodes in rest position and the radius within which each influences the surface.
struct SimulationNodes {
    std::vector<Vec3> position; ///< in the unit of the surface
    double fill_distance = 0;   ///< the farthest that any point of the volume or surface is from its nearest node
};

/// Farthest-point samples of the closed volume: the vertices and the points of a grid that have non-zero winding number
/// (none where the mesh is flat or open). Fewer than `count` where there are not that many distinct points.
/// `seed` chooses the first sample. Throws std::invalid_argument for a mesh without vertices or a count of 0.
SimulationNodes sample_nodes(const TriangleMesh& mesh, std::size_t count, std::uint64_t seed);

/// Kernel (1 − r²/h²)³ for r < h, normalised per vertex, h = support × fill distance. A vertex beyond every node's
/// reach follows its nearest node alone; `alone`, if given, counts these (not those that coincide with it, as all do
/// where h = 0).
Weights kernel_weights(const TriangleMesh& mesh, const SimulationNodes& nodes, double support,
                       std::size_t* alone = nullptr);

} // namespace cinch
