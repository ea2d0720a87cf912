// SPDX-License-Identifier: Apache-2.0
#pragma once

/// \file
/// Intersecting triangles of deforming bodies, exactly.

#include <compare>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "cinch/bvh.hpp"

namespace cinch {

/// How the BVs of a frame come about.
enum class Update : std::uint8_t {
    lazy,      ///< the cut by the methods, above it by merging, below it on demand; leaves from their vertices
    full,      ///< all leaves from their vertices, all other BVs by merging: O(ℓ)
    automatic, ///< full for a body of which the last query touched more than half of the leaves, else lazy
};

/// How the BVs of a body are bounded.
struct LazyOptions {
    Methods methods = Method::best;           ///< several are intersected
    int kdop = 6;                             ///< 6, 14, 18 or 26
    Precision precision = Precision::float32; ///< of the methods that have kernels
    Update update = Update::automatic;        ///< how much of a tree a frame brings up to date
    RestShape rest_shape = RestShape::aabb;   ///< for convex, eq12 and limited
    bool keep_cut = true;   ///< false: every BV by the methods when it is wanted, as for a front of pairs
    std::size_t lanes = 16; ///< 4, 8 or 16: room for the triangles and vertices of every leaf
};

/// A body's motion in a frame.
struct BodyFrame {
    std::span<const AffineMap> maps;   ///< one per simulation node
    std::span<const Vec3> positions{}; ///< of all vertices, where they are there anyway: then these are the vertices,
                                       ///< and the update is full
    std::span<const double> weights{}; ///< of a body with morph targets, one per target: where any is not 0 and there
                                       ///< are no positions, all vertices are evaluated and the update is full
};

/// What a frame took.
struct LazyCounts {
    std::size_t bounds = 0;   ///< BVs bounded by the methods
    std::size_t leaves = 0;   ///< deformed
    std::size_t vertices = 0; ///< of these leaves, those at their borders counted in each
    std::size_t merged = 0;   ///< BVs bounded by their children
};

/// Two triangles that intersect: ids of bodies, body_a < body_b, and indices of triangles of their meshes.
struct TrianglePair {
    std::uint32_t body_a;     ///< the lesser id
    std::uint32_t triangle_a; ///< of body_a
    std::uint32_t body_b;     ///< the greater id
    std::uint32_t triangle_b; ///< of body_b
    /// By body_a, triangle_a, body_b, triangle_b.
    auto operator<=>(const TrianglePair&) const = default;
};

/// What is asked of a query.
enum class Query : std::uint8_t {
    pairs,  ///< all intersecting pairs of triangles
    any,    ///< whether there is one; stops at the first it finds
    leaves, ///< pairs of leaves whose k-DOPs overlap, each given by its first triangle: the least effort, no triangle
            ///< is tested
};

/// What a query did.
struct QueryCounts {
    std::size_t body_pairs = 0;       ///< whose roots overlap
    std::size_t box_tests = 0;        ///< pairs of BVs
    std::size_t leaf_pairs = 0;       ///< whose k-DOPs overlap
    std::uint64_t triangle_tests = 0; ///< pairs of triangles whose boxes overlap
    std::uint64_t in_double = 0;      ///< of these, decided by the vertices of evaluate_vertex and filtered signs;
    std::uint64_t in_exact = 0;       ///< by exact arithmetic; all others by floats with proven margins
    LazyCounts updates;               ///< of all bodies, up to here in this frame
};

/// A body of a collider: 0, 1, 2, ... in the order of add(), never given twice.
using BodyId = std::uint32_t;

/// Finds the intersecting triangles of several deforming bodies, frame after frame: a sweep over the roots, then all
/// pairs of trees level by level, each level's BVs brought up to date together, then the leaves. A pair is one if the
/// closed triangles whose vertices are those of evaluate_vertex have a point in common, exactly. The list and its order
/// are the same for every method, k, history, update and number of threads; the order is that of the trees. One
/// collider is used by one thread at a time.
class Collider {
public:
    /// What bodies have that are added without options of their own.
    explicit Collider(const LazyOptions& options = {});
    ~Collider();
    /// What was moved from can only be assigned to or destroyed.
    Collider(Collider&&) noexcept;
    /// The same.
    Collider& operator=(Collider&&) noexcept;

    /// Adds a body; builds its tree, with the leaf size and rest data that queries want. The surface must stay as it
    /// is, and alive. Queries need a new update() then. Throws std::invalid_argument for options that do not fit those
    /// of the collider: kdop, lanes and keep_cut are the same for all.
    BodyId add(const DeformableSurface& surface);
    /// The same with options of its own.
    BodyId add(const DeformableSurface& surface, const LazyOptions& own);
    /// The same of a surface that morph targets displace; they must stay as they are, and alive.
    BodyId add(const DeformableSurface& surface, std::span<const MorphTarget> targets);
    BodyId add(const DeformableSurface&& surface) = delete; ///< it is referred to
    BodyId add(const DeformableSurface&& surface, std::span<const MorphTarget> targets) = delete;
    BodyId add(const DeformableSurface&& surface, const LazyOptions& own) = delete;
    /// The same with a tree that is there, whose leaves have at most options.lanes triangles and vertices. It must stay
    /// alive for methods without kernels (sphere, corners, vertices).
    BodyId add(const Bvh& bvh, const DeformableSurface& surface);
    /// The same with a tree that the collider keeps if it is needed.
    BodyId add(Bvh&& bvh, const DeformableSurface& surface);
    /// The same with options of its own.
    BodyId add(const Bvh& bvh, const DeformableSurface& surface, const LazyOptions& own);
    BodyId add(const Bvh& bvh, const DeformableSurface&& surface) = delete;
    BodyId add(Bvh&& bvh, const DeformableSurface&& surface) = delete;
    BodyId add(const Bvh&& bvh, const DeformableSurface& surface) = delete;
    BodyId add(const Bvh&& bvh, const DeformableSurface&& surface) = delete;
    BodyId add(const Bvh&& bvh, const DeformableSurface& surface, const LazyOptions& own) = delete;
    BodyId add(const Bvh& bvh, const DeformableSurface&& surface, const LazyOptions& own) = delete;

    /// Takes a body away; the others keep their ids. Queries need a new update() then. Throws std::invalid_argument for
    /// an id that is none.
    void remove(BodyId body);
    /// Ascending: update() takes a frame for each, in this order.
    std::span<const BodyId> bodies() const;

    /// Pairs of bodies a < b that queries leave out: where `wanted` is there and says false. Asked by the thread that
    /// queries, of bodies whose roots may overlap; it must always say the same within a frame.
    void set_filter(std::function<bool(BodyId a, BodyId b)> wanted);

    /// Begins a frame, one per body; what it points to must stay alive until after the query. Throws
    /// std::invalid_argument for sizes that do not fit, std::runtime_error for a changed floating-point environment;
    /// whatever it throws, there is no frame then.
    void update(std::span<const BodyFrame> frames);

    /// Takes a piece of the list; false: no more is wanted.
    using Sink = std::function<bool(std::span<const TrianglePair>)>;
    /// Queries the frame. `sink` gets the pairs in order, piece by piece, and says whether to go on. True if there are
    /// any. These and unknown() throw std::logic_error if there is no frame: before the first update(), after one that
    /// threw, after add() and after remove().
    bool find(Query query, const Sink& sink);
    /// All of the frame.
    std::vector<TrianglePair> pairs();
    /// Whether there is one; stops at the first.
    bool any();

    /// Bodies of which nothing is known in this frame: a transform that has weight is not finite, or so large that
    /// vertices may not be. They are to be taken as overlapping everything, and are in no pair.
    const std::vector<BodyId>& unknown() const;
    const QueryCounts& counts() const; ///< of the frame so far
    std::size_t bytes() const;         ///< of everything but the surfaces and BVHs that were not moved in

    struct Parts; ///< internal
    const Parts& parts() const { return *parts_; }

private:
    std::unique_ptr<Parts> parts_;
};

/// A body over a step of time: a tree, and bounds of all of its BVs that hold throughout, supports[bv·k + d]: those of
/// a ClipBounder, or swept() of both ends. Views.
struct SweptBody {
    const Bvh* bvh = nullptr;         ///< not null
    std::span<const double> supports; ///< no NaN; +∞ meets everything
};

/// Two leaves: places of bodies in the list, body_a < body_b, and of BVs in their trees.
struct LeafPair {
    std::uint32_t body_a; ///< the first one
    std::uint32_t leaf_a; ///< a BV of it
    std::uint32_t body_b; ///< the second one
    std::uint32_t leaf_b; ///< a BV of it
    /// By body_a, leaf_a, body_b, leaf_b.
    auto operator<=>(const LeafPair&) const = default;
};

/// The leaves of different bodies whose bounds over the step meet, sorted: the broad phase of continuous collision.
/// Some are left out where those of BVs above them, which may be tighter, do not meet. Triangles that touch at any time
/// of the step lie in one of the pairs. Throws std::invalid_argument for a k that is none, and for supports whose size
/// is not that of the tree.
std::vector<LeafPair> swept_leaf_pairs(std::span<const SweptBody> bodies, int kdop = 6);

/// Bounds over a step in which every T_j moves from one end to the other linearly, (1 − τ) T_j(0) + τ T_j(1), as
/// between simulated frames: every vertex moves along a straight line, so that along each direction it is farthest at
/// one end. Of bounds at both ends; all three have the same size, else throws std::invalid_argument.
void swept(std::span<const double> first, std::span<const double> last, std::span<double> supports);

} // namespace cinch
