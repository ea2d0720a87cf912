/* SPDX-License-Identifier: Apache-2.0 */
#ifndef CINCH_CINCH_H
#define CINCH_CINCH_H

/// \file
/// cinch from C99 and whatever calls C: proven bounds of deforming surfaces, trees of them, intersections of bodies.
///
/// **Errors.** Functions return a ::cinch_status; what failed says why by cinch_error_message(), in the sentences of
/// the C++ library's exceptions. No exception leaves them: null pointers, handles that were freed or are
/// of another kind, numbers of elements that do not fit, indices out of range and what is no number are errors. What is
/// not said to stand in such a case has no defined content then. (Whether an array has as many elements as is said,
/// C cannot check.)
///
/// **Arrays** are a pointer and the number of their *rows*, in C order and aligned as their elements: (n, 3) doubles
/// are n rows of 3. The numbers must be those that are wanted, no more and no less. A null pointer with 0 rows is an
/// array of none. Arrays are read and written during the call alone; nothing keeps them.
///
/// **Handles** are pointers that are never followed, but looked up: cinch_free() ends them all. What a handle refers to
/// lives as long as it is needed, so they may be freed in any order. Functions that make one set it to null where they
/// fail.
///
/// **Threads.** All functions may be called by all threads at once. A refitter, a clip's bounder, a collider and a
/// simulation do one thing at a time: a second call meanwhile is CINCH_ERROR_BUSY. Inside they go parallel, by oneTBB
/// or by cinch_use_executor(); results are the same bits for any number of threads.
///
/// **Numbers.** Lengths are in the surface's unit, times in seconds. A map is 12 doubles, the rows of (A | t): x moves
/// to A x + t. Supports: of a BV k, place 2a the greatest a.x, place 2a + 1 the greatest -a.x, a as in cinch_axes(). A
/// box is 6 doubles: least x, y, z, greatest x, y, z. What is not finite in maps and weights of a frame gives infinite
/// supports, never NaN.
///
/// **Options** that are all 0 are the defaults, and so is a null pointer to them. Until 1.0 their layout, like all else
/// here, stays within 0.x.

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
/// What the shared library exports.
#define CINCH_API __attribute__((visibility("default")))
#else
/// What the shared library exports.
#define CINCH_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/// What became of a call.
typedef enum cinch_status {
    CINCH_OK = 0,             ///< it did what it says
    CINCH_ERROR_INPUT = 1,    ///< a fault of a file or of its content: file, place and reason
    CINCH_ERROR_ARGUMENT = 2, ///< sizes, numbers, options or pointers that do not fit
    CINCH_ERROR_HANDLE = 3,   ///< no handle, a freed one, or one of another kind
    CINCH_ERROR_ORDER = 4,    ///< a call out of order, as of a query without a frame
    CINCH_ERROR_RUNTIME = 5,  ///< a changed floating-point environment, a step that cannot be solved
    CINCH_ERROR_LENGTH = 6,   ///< more than the arithmetic can prove
    CINCH_ERROR_MEMORY = 7,   ///< there is none left
    CINCH_ERROR_BUSY = 8,     ///< the handle is in use, by another thread or further up in this one
    CINCH_ERROR_ABSENT = 9,   ///< a part that this library was built without: see cinch_parts()
    CINCH_ERROR_INTERNAL = 10 ///< a fault of cinch
} cinch_status;

typedef struct cinch_surface cinch_surface;   ///< a mesh at rest, weights, morph targets; never changes
typedef struct cinch_bvh cinch_bvh;           ///< a tree over a surface; never changes
typedef struct cinch_refitter cinch_refitter; ///< bounds of every BV, frame after frame
typedef struct cinch_crowd cinch_crowd;       ///< boxes of many bodies of one surface; never changes
typedef struct cinch_collider cinch_collider; ///< bodies, and which of their triangles intersect

/* -------------------------------------------------- the library ------------------------------------------------- */

/// "major.minor.patch", for ever.
CINCH_API const char* cinch_version(void);
/// What is there of ::cinch_part, together.
CINCH_API uint32_t cinch_parts(void);
/// A part of the library, a bit of cinch_parts().
typedef enum cinch_part {
    CINCH_PART_IO = 1,          ///< files
    CINCH_PART_COMPRESSION = 2, ///< Draco and meshopt in characters
    CINCH_PART_SIMULATE = 4,    ///< scenes
    CINCH_PART_TBB = 8          ///< parallel without an executor; without it libtbb is not needed either
} cinch_part;
/// Why this thread's last call that failed did; "" if none has. Until the next one that fails.
CINCH_API const char* cinch_error_message(void);
/// Ends a handle of whatever kind; null is none. Calls with it that are under way end well.
CINCH_API cinch_status cinch_free(void* handle);

/// A piece of work: does its part number `i`.
typedef void (*cinch_task)(void* work, size_t i);
/// An engine's jobs: calls task(work, i) once for every i < count, on any threads, in any order or at once, and returns
/// when all have returned. Calls that are missing are CINCH_ERROR_RUNTIME; those too many do nothing.
typedef void (*cinch_run)(void* context, size_t count, cinch_task task, void* work);
/// From now on what this thread calls goes parallel by `run` in the place of oneTBB; null: by oneTBB again (where
/// CINCH_PART_TBB is not there, by this thread alone). The library links libtbb unless it was built without it
/// (CINCH_TBB=OFF).
CINCH_API cinch_status cinch_use_executor(cinch_run run, void* context);

/// CINCH_ERROR_RUNTIME unless this thread's arithmetic rounds to nearest and keeps subnormal numbers: every guarantee
/// rests on it, and what computes asks by itself.
CINCH_API cinch_status cinch_check_arithmetic(void);
/// Makes this thread's arithmetic the default one, until as many calls of cinch_end_default_arithmetic().
CINCH_API cinch_status cinch_begin_default_arithmetic(void);
/// Makes it what it was before; CINCH_ERROR_ORDER where nothing was begun.
CINCH_API cinch_status cinch_end_default_arithmetic(void);

/// The k/2 axes of a k-DOP, k = 6, 14, 18 or 26, (k/2, 3), each number -1, 0 or 1; those of coordinates come first.
CINCH_API cinch_status cinch_axes(int32_t kdop, int32_t* axes, size_t count);
/// How an engine stores a map.
typedef enum cinch_layout {
    CINCH_LAYOUT_ROWS_12 = 0,   ///< the rows of (A | t)
    CINCH_LAYOUT_ROWS_16 = 1,   ///< these and 0 0 0 1
    CINCH_LAYOUT_COLUMNS_16 = 2 ///< column after column, as OpenGL and glTF: t in places 12 to 14
} cinch_layout;
/// Maps, (count, 12), from floats in a ::cinch_layout, (count, 12 or 16): exactly. The last row of 16 must be 0 0 0 1.
CINCH_API cinch_status cinch_maps_from_floats(const float* from, int32_t layout, double* maps, size_t count);
/// Boxes, (count, 6), of k-DOPs, (count, k): exactly.
CINCH_API cinch_status cinch_boxes_of(const double* supports, int32_t kdop, double* boxes, size_t count);

/* ---------------------------------------------------- surfaces -------------------------------------------------- */

/// A surface as arrays. Weights of vertex k are entries [weight_row[k], weight_row[k + 1]), at least one each,
/// simulation nodes ascending; not negative, normalised and rounded to multiples of 2^-53.
typedef struct cinch_surface_arrays {
    const double* positions;     ///< (vertex_count, 3), at rest, finite
    size_t vertex_count;         ///< below 2^32
    const uint32_t* triangles;   ///< (triangle_count, 3), indices of vertices
    size_t triangle_count;       ///< below 2^32
    const uint32_t* weight_row;  ///< (vertex_count + 1), from 0 to weight_count
    const uint32_t* weight_node; ///< (weight_count), below node_count
    const double* weight;        ///< (weight_count)
    size_t weight_count;         ///< below 2^32
    uint32_t node_count;         ///< simulation nodes, 2^24 at most
    const double* rest_maps;     ///< (node_count, 12) or null: the pose in which triangles are grouped, for parts with
                                 ///< rest spaces of their own. No bound depends on it, only how tight they are
    const uint32_t* target_row;  ///< (target_count + 1), from 0 to displacement_count, or null without targets
    size_t target_count;         ///< morph targets; 0 to displacement_count are their entries, like weights
    const uint32_t* target_vertex;     ///< (displacement_count), ascending within a target
    const double* target_displacement; ///< (displacement_count, 3), finite
    size_t displacement_count;         ///< of all targets
} cinch_surface_arrays;

/// What a surface has.
typedef struct cinch_surface_sizes {
    size_t vertices;       ///< of the mesh
    size_t triangles;      ///< of the mesh
    size_t nodes;          ///< simulation nodes: maps of a frame
    size_t weights;        ///< above 0
    size_t targets;        ///< morph targets
    size_t normalised;     ///< vertices whose weights did not sum to 1, by more than storing them explains
    double largest_change; ///< share by which they were changed, at most
} cinch_surface_sizes;

/// Copies the arrays.
CINCH_API cinch_status cinch_surface_from_arrays(const cinch_surface_arrays* arrays, cinch_surface** surface);
/// Its sizes.
CINCH_API cinch_status cinch_surface_get_sizes(const cinch_surface* surface, cinch_surface_sizes* sizes);
/// Positions at rest, (vertices, 3), and triangles, (triangles, 3); either may be null with a count of 0: not wanted.
CINCH_API cinch_status cinch_surface_get_mesh(const cinch_surface* surface, double* positions, size_t vertex_count,
                                              uint32_t* triangles, size_t triangle_count);
/// Weights as bounds take them: row, (row_count = vertices + 1), node and weight, (weight_count = weights).
CINCH_API cinch_status cinch_surface_get_weights(const cinch_surface* surface, uint32_t* row, size_t row_count,
                                                 uint32_t* node, double* weight, size_t weight_count);
/// All vertices of a frame, (vertex_count = vertices, 3), bit for bit what bounds are proven to contain. `maps`:
/// (map_count = nodes, 12). `weights`: (weight_count), one per morph target, or null and 0: not displaced.
CINCH_API cinch_status cinch_surface_evaluate(const cinch_surface* surface, const double* maps, size_t map_count,
                                              const double* weights, size_t weight_count, double* vertices,
                                              size_t vertex_count);

/* ------------------------------------------------------ trees --------------------------------------------------- */

/// How much of the rest data a tree has; it takes most of the time.
typedef enum cinch_detail {
    CINCH_DETAIL_ALL = 0,   ///< for all methods
    CINCH_DETAIL_BOXES = 1, ///< what convex, corners, eq12 and limited need
    CINCH_DETAIL_INNER = 2  ///< all but the extreme points of leaves: enough for colliders
} cinch_detail;

/// What a tree has.
typedef struct cinch_bvh_sizes {
    size_t bvs;         ///< level by level, the root first; 0 for a mesh without triangles
    size_t levels;      ///< of them
    size_t triangles;   ///< of the mesh
    size_t influences;  ///< of all BVs
    size_t points;      ///< extreme vertices of all BVs
    size_t bytes;       ///< of all arrays
    int32_t detail;     ///< a ::cinch_detail
    int32_t has_models; ///< 0: without local boxes and models of weights (CINCH_DETAIL_BOXES)
} cinch_bvh_sizes;

/// One BV at rest.
typedef struct cinch_bv {
    double centre[3];           ///< of the rest box
    double half[3];             ///< its half extents
    double oriented_centre[3];  ///< of the oriented rest box
    double oriented_axis[3][3]; ///< its half extents, with direction
    double pivot[3];            ///< mean of the rest vertices
    double slack;               ///< greatest q.x over all vertices <= that over the points + slack |q|
    uint32_t first_triangle;    ///< in CINCH_BVH_TRIANGLES
    uint32_t triangle_count;    ///< from there on
    uint32_t first_child;       ///< the other one is first_child + 1; 0: a leaf
    uint32_t first_influence;   ///< in the influences
    uint32_t influence_count;   ///< from there on
    uint32_t first_point;       ///< in CINCH_BVH_POINTS
    uint32_t point_count;       ///< from there on
    uint32_t vertex_influences; ///< most simulation nodes of any of its vertices
} cinch_bv;

/// What a BV knows of one simulation node that influences it. 0 from `centre` on without models.
typedef struct cinch_influence {
    uint32_t node;      ///< ascending within a BV
    double l;           ///< least weight over the BV's vertices
    double h;           ///< greatest one
    double centre[3];   ///< of a rest box about the vertices that it influences
    double half[3];     ///< half extents of that
    double radius;      ///< of a ball about the centre around these vertices
    double mean;        ///< of the weights, which are near mean + gradient.y, y from the pivot
    double gradient[3]; ///< per unit of length
    double residual;    ///< how far off that is at most
    double moment[3];   ///< |(w - mean) y| per coordinate at most
} cinch_influence;

/// Arrays of indices of a tree.
typedef enum cinch_bvh_indices {
    CINCH_BVH_LEVELS = 0,    ///< (levels + 1): level i is BVs from place i to place i + 1
    CINCH_BVH_TRIANGLES = 1, ///< (triangles), a permutation
    CINCH_BVH_POINTS = 2     ///< (points), vertices
} cinch_bvh_indices;

/// A tree down to at most `leaf_triangles` per leaf. `leaf_vertices` 0: median splits of triangles; else at least 3: of
/// clusters with at most so many different vertices too, fewer and fuller leaves. `detail` is a ::cinch_detail.
CINCH_API cinch_status cinch_bvh_build(const cinch_surface* surface, size_t leaf_triangles, size_t leaf_vertices,
                                       int32_t detail, cinch_bvh** bvh);
/// Its sizes.
CINCH_API cinch_status cinch_bvh_get_sizes(const cinch_bvh* bvh, cinch_bvh_sizes* sizes);
/// All BVs, (bvs).
CINCH_API cinch_status cinch_bvh_get_bvs(const cinch_bvh* bvh, cinch_bv* bvs, size_t count);
/// All influences, (influences).
CINCH_API cinch_status cinch_bvh_get_influences(const cinch_bvh* bvh, cinch_influence* influences, size_t count);
/// One of the arrays of indices, a ::cinch_bvh_indices.
CINCH_API cinch_status cinch_bvh_get_indices(const cinch_bvh* bvh, int32_t which, uint32_t* indices, size_t count);

/* ------------------------------------------------ bounds of frames ---------------------------------------------- */

/// Bounding methods, as bits: several are intersected.
typedef enum cinch_method {
    CINCH_METHOD_CONVEX = 1,     ///< the greatest extremum: all convex weights
    CINCH_METHOD_SPHERE = 2,     ///< accumulated-deformation spheres
    CINCH_METHOD_CORNERS = 4,    ///< all corners of the weight space, O(n^2)
    CINCH_METHOD_EQ12 = 8,       ///< Eq. 12 of the paper
    CINCH_METHOD_LIMITED = 16,   ///< the exact optimum over the weight intervals
    CINCH_METHOD_LOCAL = 32,     ///< a rest box per BV and simulation node
    CINCH_METHOD_SUPPORT = 64,   ///< a reference map's support of the rest vertices, and `local` for the rest
    CINCH_METHOD_LINEAR = 128,   ///< an affine model of the weights with residuals
    CINCH_METHOD_MOMENTS = 256,  ///< first and second moments of the weights
    CINCH_METHOD_BEST = 512,     ///< per BV whichever of local, support, linear, moments is best
    CINCH_METHOD_VERTICES = 1024 ///< the vertices themselves
} cinch_method;

/// How a surface is bounded; 0: the default.
typedef struct cinch_refit_options {
    uint32_t methods; ///< ::cinch_method, together; 0: best
    int32_t kdop;     ///< 6, 14, 18 or 26; 0: 6
    int32_t plain;    ///< 1: without room for rounding, which proves nothing
    int32_t float64;  ///< 1: kernels in doubles; 0: in floats. Both are proven
    int32_t passes;   ///< evaluations for local, support and best, up to 1000; 0: 1
    int32_t oriented; ///< 1: oriented rest boxes for convex, eq12 and limited
    int32_t remember; ///< 1: searches begin where the last frame left them
} cinch_refit_options;

/// What of a frame could not be bounded.
typedef struct cinch_refit_report {
    size_t unbounded_nodes; ///< simulation nodes whose map is not finite, or too large for the arithmetic
    size_t infinite;        ///< supports that are infinite
} cinch_refit_report;

/// Prepares the tree's rest data; with the surface's morph targets, if there are any.
CINCH_API cinch_status cinch_refitter_new(const cinch_bvh* bvh, const cinch_refit_options* options,
                                          cinch_refitter** refitter);
/// Bounds of every BV in every one of `frames` frames: `supports`, (support_count = frames * bvs, k). `maps`,
/// (map_count = frames * nodes, 12). `weights` of morph targets, (weight_count = frames * targets), or null and 0: not
/// displaced. `reports`, (frames), or null.
CINCH_API cinch_status cinch_refitter_refit(cinch_refitter* refitter, size_t frames, const double* maps,
                                            size_t map_count, const double* weights, size_t weight_count,
                                            double* supports, size_t support_count, cinch_refit_report* reports);
/// Bounds over a step in which all maps move linearly from one frame to the next, of the bounds at both ends; all three
/// have `count` numbers, and may be the same array.
CINCH_API cinch_status cinch_swept(const double* first, const double* last, double* supports, size_t count);

/// How a crowd is bounded.
typedef struct cinch_crowd_options {
    int32_t level; ///< of the tree: its BVs, and leaves above it, are the boxes; 0: one box, of the root
    int32_t plain; ///< 1: the formula of engines, which proves nothing
} cinch_crowd_options;

/// Boxes of many bodies of one surface: a box per simulation node and BV, transformed and united, in floats with room
/// for all rounding. The tree needs more than CINCH_DETAIL_BOXES. Morph targets are left out.
CINCH_API cinch_status cinch_crowd_new(const cinch_bvh* bvh, const cinch_crowd_options* options, cinch_crowd** crowd);
/// The BVs whose boxes these are, of which `count` says how many; null: the number alone.
CINCH_API cinch_status cinch_crowd_get_bvs(const cinch_crowd* crowd, uint32_t* bvs, size_t capacity, size_t* count);
/// Boxes of all bodies, (box_count = bodies * BVs, 6). `maps`: (map_count = bodies * nodes, 12).
CINCH_API cinch_status cinch_crowd_refit(const cinch_crowd* crowd, const double* maps, size_t map_count, double* boxes,
                                         size_t box_count);

/* --------------------------------------------------- collisions ------------------------------------------------- */

/// How bodies are bounded; 0: the default.
typedef struct cinch_body_options {
    uint32_t methods; ///< ::cinch_method, together; 0: best
    int32_t kdop;     ///< 6, 14, 18 or 26; 0: 6, and of a body's own options that of the collider, with which it agrees
    int32_t float64;  ///< 1: kernels in doubles
    int32_t oriented; ///< 1: oriented rest boxes for convex, eq12 and limited
    int32_t update;   ///< 0: as the last query suggests; 1: lazy; 2: all leaves from their vertices
    int32_t forget_cut; ///< 1: every BV by the methods when it is wanted. That of the collider too
    int32_t lanes;      ///< 4, 8 or 16: room for a leaf's triangles and vertices; 0: 16, or the collider's likewise
} cinch_body_options;

/// A body's motion in a frame.
typedef struct cinch_body_frame {
    const double* maps;      ///< (map_count = nodes, 12)
    size_t map_count;        ///< of them
    const double* positions; ///< (position_count = vertices, 3) of all vertices where they are there anyway, or null
    size_t position_count;   ///< of them
    const double* weights;   ///< (weight_count = targets); null for a body without morph targets
    size_t weight_count;     ///< of them
} cinch_body_frame;

/// What is asked of a query.
typedef enum cinch_query {
    CINCH_QUERY_PAIRS = 0, ///< all intersecting pairs of triangles
    CINCH_QUERY_ANY = 1,   ///< the first that is found
    CINCH_QUERY_LEAVES = 2 ///< pairs of leaves whose k-DOPs overlap, each given by its first triangle
} cinch_query;

/// What the queries of a frame did.
typedef struct cinch_query_counts {
    uint64_t body_pairs;     ///< whose roots overlap
    uint64_t box_tests;      ///< pairs of BVs
    uint64_t leaf_pairs;     ///< whose k-DOPs overlap
    uint64_t triangle_tests; ///< pairs of triangles whose boxes overlap
    uint64_t in_double;      ///< of these, decided in doubles
    uint64_t in_exact;       ///< and in exact arithmetic; all others in floats
    uint64_t bounds;         ///< BVs bounded by the methods
    uint64_t leaves;         ///< deformed
    uint64_t vertices;       ///< of these leaves
    uint64_t merged;         ///< BVs bounded by their children
} cinch_query_counts;

/// Of options that bodies have by default.
CINCH_API cinch_status cinch_collider_new(const cinch_body_options* options, cinch_collider** collider);
/// Adds a body; its id is 0, 1, 2, ... `bvh`: a tree of this surface, or null: one is built. `own`: its options, or
/// null: the collider's. A surface with morph targets can have neither. Queries need a new frame then.
CINCH_API cinch_status cinch_collider_add(cinch_collider* collider, const cinch_surface* surface, const cinch_bvh* bvh,
                                          const cinch_body_options* own, uint32_t* id);
/// Takes a body away; the others keep their ids. Queries need a new frame then.
CINCH_API cinch_status cinch_collider_remove(cinch_collider* collider, uint32_t id);
/// Its bodies, ascending, or with `unknown` 1 those of which nothing is known in this frame, as a map is not finite:
/// they are in no pair, and to be taken as overlapping everything. `count` says how many; null: the number alone.
CINCH_API cinch_status cinch_collider_get_bodies(const cinch_collider* collider, int32_t unknown, uint32_t* ids,
                                                 size_t capacity, size_t* count);
/// Whether pairs of bodies a < b are wanted.
typedef int32_t (*cinch_filter)(void* context, uint32_t a, uint32_t b);
/// Pairs for which it says 0 are left out; null: none. Called by the thread that queries, in queries alone; it must
/// always say the same within a frame.
CINCH_API cinch_status cinch_collider_set_filter(cinch_collider* collider, cinch_filter filter, void* context);
/// Begins a frame, one for each of cinch_collider_get_bodies(), in their order. Copies what it needs.
CINCH_API cinch_status cinch_collider_update(cinch_collider* collider, const cinch_body_frame* frames, size_t count);
/// Queries the frame, by a ::cinch_query; `count` says how many pairs there are. They stay until the next query,
/// update, add or remove.
CINCH_API cinch_status cinch_collider_query(cinch_collider* collider, int32_t query, size_t* count);
/// The pairs of the last query, (count, 4): body a, triangle of it, body b > a, triangle of it. Exactly those whose
/// closed triangles have a point in common, always in the same order.
CINCH_API cinch_status cinch_collider_get_pairs(const cinch_collider* collider, uint32_t* pairs, size_t count);
/// What the queries of the frame did.
CINCH_API cinch_status cinch_collider_get_counts(const cinch_collider* collider, cinch_query_counts* counts);

/// A body over a step of time.
typedef struct cinch_swept_body {
    const cinch_bvh* bvh;   ///< its tree
    const double* supports; ///< (support_count = bvs, k), no NaN: of cinch_swept() or cinch_clip_bounder_bound()
    size_t support_count;   ///< of them
} cinch_swept_body;
/// Pairs of leaves that may touch at any time of the step: body a, BV of it, body b > a, BV of it; bodies by their
/// places. `count` says how many; the first `capacity` of them are written, (capacity, 4).
CINCH_API cinch_status cinch_swept_leaf_pairs(const cinch_swept_body* bodies, size_t body_count, int32_t kdop,
                                              uint32_t* pairs, size_t capacity, size_t* count);

#ifdef __cplusplus
}
#endif

#include "cinch/cinch_io.h"

#endif
