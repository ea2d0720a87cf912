// SPDX-License-Identifier: GPL-3.0-or-later
// What the tests of Python's module compare it with: the same by C++ itself, called through ctypes.
#include <chrono>
#include <cstring>
#include <memory>

#include "cinch/collider.hpp"
#include "cinch/deform.hpp"
#include "cinch/refit.hpp"

namespace {

using namespace cinch;

struct Reference {
    DeformableSurface surface;
    Bvh bvh;
    std::unique_ptr<Refitter> refit;
    std::size_t k;
};

std::span<const AffineMap> frame(const double* maps, std::size_t nodes, std::size_t f)
{
    return {reinterpret_cast<const AffineMap*>(maps) + f * nodes, nodes};
}

} // namespace

extern "C" {

Reference* reference_make(const double* vertices, std::size_t vertex_count, const std::uint32_t* triangles,
                          std::size_t triangle_count, const double* data, const std::uint32_t* indices,
                          const std::uint32_t* indptr, std::uint32_t nodes, std::size_t leaf, const char* method,
                          int kdop, bool in_double)
{
    auto out = std::make_unique<Reference>();
    const auto* points = reinterpret_cast<const Vec3*>(vertices);
    out->surface.mesh.vertices.assign(points, points + vertex_count);
    for (std::size_t t = 0; t < triangle_count; ++t)
        out->surface.mesh.triangles.push_back({triangles[3 * t], triangles[3 * t + 1], triangles[3 * t + 2]});
    Influences influences;
    influences.node_count = nodes;
    influences.row.assign(indptr, indptr + vertex_count + 1);
    influences.node.assign(indices, indices + influences.row.back());
    influences.weight.assign(data, data + influences.row.back());
    out->surface.weights = to_dyadic(influences);
    out->bvh = build_bvh(out->surface, leaf);
    RefitOptions options;
    options.methods = *named_methods(method);
    options.kdop = kdop;
    options.precision = in_double ? Precision::float64 : Precision::float32;
    out->refit = std::make_unique<Refitter>(out->bvh, out->surface, options);
    out->k = static_cast<std::size_t>(kdop);
    return out.release();
}

void reference_free(Reference* self) { delete self; }

std::size_t reference_bvs(const Reference* self) { return self->bvh.bvs.size(); }

void reference_weights(const Reference* self, double* out)
{
    std::copy(self->surface.weights.weight.begin(), self->surface.weights.weight.end(), out);
}

/// Supports of all frames; returns nanoseconds.
double reference_refit(Reference* self, const double* maps, std::size_t frames, double* out)
{
    const auto begin = std::chrono::steady_clock::now();
    const std::size_t each = self->bvh.bvs.size() * self->k;
    for (std::size_t f = 0; f < frames; ++f)
        (*self->refit)(frame(maps, self->surface.weights.node_count, f), std::span(out + f * each, each));
    return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - begin).count();
}

void reference_evaluate(const Reference* self, const double* maps, double* out)
{
    evaluate(self->surface.mesh.vertices, self->surface.weights, frame(maps, self->surface.weights.node_count, 0),
             {reinterpret_cast<Vec3*>(out), self->surface.mesh.vertices.size()});
}

void reference_crowd(const Reference* self, const double* maps, std::size_t bodies, int level, double* out,
                     std::size_t* boxes)
{
    const CrowdRefitter crowd(self->bvh, self->surface, {level, Rounding::proven});
    *boxes = crowd.bvs().size();
    if (out)
        crowd({reinterpret_cast<const AffineMap*>(maps), bodies * self->surface.weights.node_count},
              {reinterpret_cast<Aabb*>(out), bodies * crowd.bvs().size()});
}

/// The pairs of two bodies with the same surface; at most `most` rows of four are written.
std::size_t reference_pairs(const Reference* self, const double* first, const double* second, std::uint32_t* out,
                            std::size_t most)
{
    Collider collider;
    collider.add(self->surface);
    collider.add(self->surface);
    const std::uint32_t nodes = self->surface.weights.node_count;
    const BodyFrame frames[] = {{frame(first, nodes, 0)}, {frame(second, nodes, 0)}};
    collider.update(frames);
    const std::vector<TrianglePair> pairs = collider.pairs();
    std::memcpy(out, pairs.data(), std::min(most, pairs.size()) * sizeof(TrianglePair));
    return pairs.size();
}

} // extern "C"
