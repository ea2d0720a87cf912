// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "cinch/deform.hpp"
#include "toolkit/c/arrays.hpp"
#include "toolkit/c/call.hpp"
#include "toolkit/c/objects.hpp"

namespace {

using namespace cinch;
using namespace cinch::c;

constexpr std::uint32_t most_nodes = 1 << 24;

[[noreturn]] void refuse(const std::string& why) { throw std::invalid_argument("surface: " + why); }

template <class T> std::vector<T> copy_of(std::span<const T> values) { return {values.begin(), values.end()}; }

void require_indexable(std::size_t count, const char* name)
{
    if (count > std::numeric_limits<std::uint32_t>::max())
        refuse(std::string(name) + " are 2^32 and more");
}

std::vector<Vec3> finite_points(const double* points, std::size_t count, const char* name)
{
    const auto in = array<Vec3>(points, count, name);
    for (std::size_t i = 0; i < count; ++i)
        if (!in[i].allFinite())
            refuse(std::string(name) + ", row " + std::to_string(i) + ": not finite");
    return copy_of(in);
}

// Of rows [row[i], row[i + 1]) of `entries`: begins at 0, ends with them, never falls, and nothing occurs twice or
// reaches `end`.
std::span<const std::uint32_t> checked_rows(const std::uint32_t* row, std::size_t rows,
                                            std::span<const std::uint32_t> entries, std::size_t end, const char* name)
{
    const std::string of = name;
    const auto in = array<std::uint32_t>(row, rows + 1, (of + "_row").c_str());
    if (in.front() != 0 || in.back() != entries.size())
        refuse(of + "_row goes from " + std::to_string(in.front()) + " to " + std::to_string(in.back()) +
               ", and not from 0 to " + std::to_string(entries.size()));
    for (std::size_t i = 0; i < rows; ++i)
        if (in[i] > in[i + 1])
            refuse(of + "_row falls after row " + std::to_string(i));
    for (std::size_t i = 0; i < rows; ++i)
        for (std::uint32_t n = in[i]; n < in[i + 1]; ++n) {
            if (entries[n] >= end)
                refuse(of + ", row " + std::to_string(i) + ": index " + std::to_string(entries[n]) +
                       " is not less than " + std::to_string(end));
            if (n > in[i] && entries[n] <= entries[n - 1])
                refuse(of + ", row " + std::to_string(i) + ": indices do not ascend");
        }
    return in;
}

TriangleMesh mesh_of(const cinch_surface_arrays& in)
{
    require_indexable(in.vertex_count, "vertices");
    require_indexable(in.triangle_count, "triangles");
    TriangleMesh mesh{finite_points(in.positions, in.vertex_count, "positions"),
                      copy_of(array<Triangle>(in.triangles, in.triangle_count, "triangles"))};
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (const std::uint32_t v : mesh.triangles[t])
            if (v >= in.vertex_count)
                refuse("triangle " + std::to_string(t) + ": vertex " + std::to_string(v) + " is not less than " +
                       std::to_string(in.vertex_count));
    return mesh;
}

Influences influences_of(const cinch_surface_arrays& in)
{
    require_indexable(in.weight_count, "weights");
    if (in.node_count > most_nodes) // whose frames have gigabytes: what no array stands behind must not take memory
        refuse("there are " + std::to_string(in.node_count) + " simulation nodes, and can be " +
               std::to_string(most_nodes));
    const auto node = array<std::uint32_t>(in.weight_node, in.weight_count, "weight_node");
    const auto weight = array<double>(in.weight, in.weight_count, "weight");
    const auto row = checked_rows(in.weight_row, in.vertex_count, node, in.node_count, "weight");
    for (std::size_t i = 0; i < weight.size(); ++i)
        if (!(weight[i] >= 0 && std::isfinite(weight[i])))
            refuse("weight " + std::to_string(i) + " is negative or not finite");
    return {in.node_count, copy_of(row), copy_of(node), copy_of(weight)};
}

std::vector<MorphTarget> targets_of(const cinch_surface_arrays& in)
{
    if (in.target_count == 0)
        return {};
    require_indexable(in.target_count, "targets");
    require_indexable(in.displacement_count, "displacements");
    const auto vertex = array<std::uint32_t>(in.target_vertex, in.displacement_count, "target_vertex");
    const auto row = checked_rows(in.target_row, in.target_count, vertex, in.vertex_count, "target");
    const std::vector<Vec3> displacement =
        finite_points(in.target_displacement, in.displacement_count, "target_displacement");
    std::vector<MorphTarget> targets(in.target_count);
    for (std::size_t i = 0; i < targets.size(); ++i) {
        targets[i].vertex.assign(vertex.begin() + row[i], vertex.begin() + row[i + 1]);
        targets[i].displacement.assign(displacement.begin() + row[i], displacement.begin() + row[i + 1]);
    }
    return targets;
}

std::vector<Vec3> laid_out(const cinch_surface_arrays& in, const TriangleMesh& mesh, const Weights& weights)
{
    if (!in.rest_maps)
        return {};
    std::vector<Vec3> layout(mesh.vertices.size());
    evaluate(mesh.vertices, weights, array<AffineMap>(in.rest_maps, in.node_count, "rest_maps"), layout);
    for (std::size_t v = 0; v < layout.size(); ++v)
        if (!layout[v].allFinite())
            refuse("rest_maps put vertex " + std::to_string(v) + " where nothing is finite");
    return layout;
}

} // namespace

cinch_status cinch_surface_from_arrays(const cinch_surface_arrays* arrays, cinch_surface** surface)
{
    return call([&] {
        given(surface, "surface") = nullptr;
        const cinch_surface_arrays& in = given(arrays, "arrays");
        auto made = std::make_shared<Surface>();
        DeformableSurface all;
        all.mesh = mesh_of(in);
        all.weights = to_dyadic(influences_of(in), &made->report);
        all.layout = laid_out(in, all.mesh, all.weights);
        made->surface = std::make_shared<const DeformableSurface>(std::move(all));
        made->targets = std::make_shared<const std::vector<MorphTarget>>(targets_of(in));
        *surface = put(std::move(made));
    });
}

cinch_status cinch_surface_get_sizes(const cinch_surface* surface, cinch_surface_sizes* sizes)
{
    return call([&] {
        const auto of = get<Surface>(surface);
        given(sizes, "sizes") = {of->surface->mesh.vertices.size(),
                                 of->surface->mesh.triangles.size(),
                                 of->nodes(),
                                 of->surface->weights.weight.size(),
                                 of->targets->size(),
                                 of->report.normalised,
                                 of->report.largest_change};
    });
}

cinch_status cinch_surface_get_mesh(const cinch_surface* surface, double* positions, size_t vertex_count,
                                    uint32_t* triangles, size_t triangle_count)
{
    return call([&] {
        const auto of = get<Surface>(surface);
        const TriangleMesh& mesh = of->surface->mesh;
        const auto points = array_of<Vec3>(positions, vertex_count, positions ? mesh.vertices.size() : 0, "positions");
        const auto corners =
            array_of<Triangle>(triangles, triangle_count, triangles ? mesh.triangles.size() : 0, "triangles");
        std::copy_n(mesh.vertices.begin(), points.size(), points.begin());
        std::copy_n(mesh.triangles.begin(), corners.size(), corners.begin());
    });
}

cinch_status cinch_surface_get_weights(const cinch_surface* surface, uint32_t* row, size_t row_count, uint32_t* node,
                                       double* weight, size_t weight_count)
{
    return call([&] {
        const auto of = get<Surface>(surface);
        const Weights& weights = of->surface->weights;
        const auto rows = array_of<std::uint32_t>(row, row_count, weights.row.size(), "row");
        const auto nodes = array_of<std::uint32_t>(node, weight_count, weights.node.size(), "node");
        const auto values = array_of<double>(weight, weight_count, weights.weight.size(), "weight");
        std::copy(weights.row.begin(), weights.row.end(), rows.begin());
        std::copy(weights.node.begin(), weights.node.end(), nodes.begin());
        std::copy(weights.weight.begin(), weights.weight.end(), values.begin());
    });
}

cinch_status cinch_surface_evaluate(const cinch_surface* surface, const double* maps, size_t map_count,
                                    const double* weights, size_t weight_count, double* vertices, size_t vertex_count)
{
    return call([&] {
        const auto of = get<Surface>(surface);
        const std::vector<Vec3>& rest = of->surface->mesh.vertices;
        const auto moved = array_of<AffineMap>(maps, map_count, of->nodes(), "maps");
        const auto by = array_of<double>(weights, weight_count, weight_count ? of->targets->size() : 0, "weights");
        const auto out = array_of<Vec3>(vertices, vertex_count, rest.size(), "vertices");
        if (by.empty())
            return evaluate(rest, of->surface->weights, moved, out);
        std::vector<Vec3> displaced = rest;
        displace(*of->targets, by, displaced);
        evaluate(displaced, of->surface->weights, moved, out);
    });
}
