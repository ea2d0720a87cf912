// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/rest_data.hpp"

#include <cmath>
#include <cstdio>
#include <map>
#include <stdexcept>

#include "exact/number.hpp"
#include "exact/oriented_check.hpp"

namespace cinch::exact {
namespace {

[[noreturn]] void refuse(const std::string& what) { throw std::invalid_argument(what); }

std::string hex(double x)
{
    char text[64];
    std::snprintf(text, sizeof text, "%a", x);
    return text;
}

bool contains(double centre, double half, double x)
{
    if (!std::isfinite(centre) || !(half >= 0))
        return false;
    if (std::isinf(half)) // so large a box that its half overflowed
        return true;
    const Exact offset = Exact(x) - Exact(centre);
    return offset <= Exact(half) && -offset <= Exact(half);
}

// Whether |w − mean − gradient·y| ≤ residual and |(w − mean) y_i| ≤ moment_i, as far as N can tell. What is not finite
// says nothing.
template <class N> bool model_holds(const WeightModel& model, double weight, const Vec3& x, const Vec3& pivot)
{
    const N delta = N(weight) - N(model.mean);
    N rho = delta;
    for (int s = 0; s < 3; ++s) {
        const N y = N(x[s]) - N(pivot[s]);
        rho = rho - N(model.gradient[s]) * y;
        if (std::isfinite(model.moment[s]) && !certainly(absolute(delta * y) <= N(model.moment[s])))
            return false;
    }
    return !std::isfinite(model.residual) || certainly(absolute(rho) <= N(model.residual));
}

template <class N> bool ball_holds(const RestBox& box, double radius, const Vec3& x)
{
    if (!std::isfinite(radius))
        return true;
    N squared(0);
    for (int s = 0; s < 3; ++s) {
        const N d = N(x[s]) - N(box.centre[s]);
        squared = squared + d * d;
    }
    return certainly(squared <= N(radius) * N(radius));
}

// Local boxes and balls, and the weight models. The points are the exact tests' business: a linear program each.
std::string model_fault(const DeformableSurface& surface, const RestBv& rest, const OrientedBox& oriented,
                        std::span<const std::uint32_t> vertices)
{
    std::int64_t units = 0;
    for (std::size_t j = 0; j < rest.node.size(); ++j) {
        const WeightModel& model = rest.model[j];
        const double scaled = model.mean * 0x1p53;
        if (!(scaled >= 0 && scaled <= 0x1p53) || scaled != std::floor(scaled))
            return "simulation node " + std::to_string(rest.node[j]) + ": mean weight " + hex(model.mean) +
                   " is no multiple of 2^-53 up to 1";
        units += static_cast<std::int64_t>(scaled);
        if (units > std::int64_t{1} << 53)
            break;
        for (double g : {model.gradient[0], model.gradient[1], model.gradient[2]})
            if (!std::isfinite(g))
                return "simulation node " + std::to_string(rest.node[j]) + ": the gradient of its weight is not finite";
    }
    if (units != std::int64_t{1} << 53)
        return "the mean weights do not sum to exactly 1";
    std::vector<double> weight(rest.node.size(), 0.0); // of one vertex
    std::vector<std::size_t> places;
    struct Doubt {
        std::uint32_t vertex;
        std::size_t j;
        double weight;
    };
    std::vector<Doubt> balls, models; // where intervals do not decide
    const DirectedRounding upward;    // Exact is integers, whatever the rounding
    const OrientedCheck own_box(oriented);
    for (std::uint32_t k : vertices) {
        const Vec3& x = surface.mesh.vertices[k];
        const Weights::Row row = surface.weights.of(k);
        places.clear();
        if (!own_box.contains(x))
            return "vertex " + std::to_string(k) + " lies outside the oriented box";
        for (std::size_t i = 0; i < row.node.size(); ++i) {
            const auto j = static_cast<std::size_t>(std::lower_bound(rest.node.begin(), rest.node.end(), row.node[i]) -
                                                    rest.node.begin());
            places.push_back(j);
            weight[j] = row.weight[i];
            for (int s = 0; s < 3; ++s)
                if (!(absolute(Interval(x[s]) - Interval(rest.local[j].centre[s])).sup() <= rest.local[j].half[s]) &&
                    !contains(rest.local[j].centre[s], rest.local[j].half[s], x[s]))
                    return "vertex " + std::to_string(k) + ", simulation node " + std::to_string(row.node[i]) +
                           ": lies outside its local box";
            if (!ball_holds<Interval>(rest.local[j], rest.radius[j], x))
                balls.push_back({k, j, 0});
        }
        for (std::size_t j = 0; j < rest.node.size(); ++j)
            if (!model_holds<Interval>(rest.model[j], weight[j], x, rest.pivot))
                models.push_back({k, j, weight[j]});
        for (std::size_t j : places)
            weight[j] = 0;
    }
    auto where = [&](const Doubt& d) {
        return "vertex " + std::to_string(d.vertex) + ", simulation node " + std::to_string(rest.node[d.j]);
    };
    for (const Doubt& d : balls)
        if (!ball_holds<Exact>(rest.local[d.j], rest.radius[d.j], surface.mesh.vertices[d.vertex]))
            return where(d) + ": lies outside its local ball";
    for (const Doubt& d : models)
        if (!model_holds<Exact>(rest.model[d.j], d.weight, surface.mesh.vertices[d.vertex], rest.pivot))
            return where(d) + ": the model of its weight does not hold";
    return {};
}

} // namespace

void require_dyadic_weights(const DeformableSurface& surface)
{
    const Weights& weights = surface.weights;
    if (weights.row.empty() || weights.row.front() != 0 || weights.vertex_count() != surface.mesh.vertices.size())
        refuse("the weights are not those of the mesh");
    if (!std::is_sorted(weights.row.begin(), weights.row.end()) || weights.row.back() != weights.node.size() ||
        weights.node.size() != weights.weight.size())
        refuse("the rows of the weights do not fit together");
    for (std::size_t k = 0; k < weights.vertex_count(); ++k) {
        const Weights::Row row = weights.of(k);
        std::int64_t units = 0;
        for (std::size_t i = 0; i < row.node.size(); ++i) {
            const double scaled = row.weight[i] * 0x1p53;
            if (!(scaled >= 1 && scaled <= 0x1p53) || scaled != std::floor(scaled))
                refuse("vertex " + std::to_string(k) + ": weight " + hex(row.weight[i]) +
                       " is not a positive multiple of 2^-53 up to 1");
            if (row.node[i] >= weights.node_count || (i > 0 && row.node[i] <= row.node[i - 1]))
                refuse("vertex " + std::to_string(k) + ": simulation nodes do not ascend or are out of range");
            units += static_cast<std::int64_t>(scaled); // fewer than 2^10 terms of at most 2^53 each could overflow,
            if (units > std::int64_t{1} << 53)          // so the sum is cut off here
                refuse("vertex " + std::to_string(k) + ": weights sum to more than 1");
        }
        if (units != std::int64_t{1} << 53)
            refuse("vertex " + std::to_string(k) + ": weights do not sum to exactly 1");
    }
}

void require_tree(const DeformableSurface& surface, const Bvh& bvh)
{
    const std::size_t triangles = surface.mesh.triangles.size();
    for (const Vec3& v : surface.mesh.vertices)
        if (!(std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2])))
            refuse("a rest vertex is not finite");
    for (const Triangle& t : surface.mesh.triangles)
        for (std::uint32_t v : t)
            if (v >= surface.mesh.vertices.size())
                refuse("a triangle has a vertex that does not exist");
    if (bvh.triangle.size() != triangles || bvh.bvs.empty() != (triangles == 0))
        refuse("the BVH is not over the mesh's triangles");
    std::vector<bool> seen(triangles, false), child(bvh.bvs.size(), false);
    for (std::uint32_t t : bvh.triangle) {
        if (t >= triangles || seen[t])
            refuse("the BVH's triangles are not a permutation of the mesh's");
        seen[t] = true;
    }
    for (std::size_t i = 0; i < bvh.bvs.size(); ++i) {
        const Bv& bv = bvh.bvs[i];
        const std::string name = "BV " + std::to_string(i);
        if (std::size_t{bv.first_triangle} + bv.triangle_count > triangles || bv.triangle_count == 0)
            refuse(name + " has triangles out of range");
        if (i == 0 && bv.triangle_count != triangles)
            refuse("the root does not hold every triangle");
        if (std::size_t{bv.first_influence} + bv.influence_count > bvh.node.size() || bvh.l.size() != bvh.node.size() ||
            bvh.h.size() != bvh.node.size())
            refuse(name + " has weight intervals out of range");
        if (bv.is_leaf())
            continue;
        if (bv.first_child <= i || std::size_t{bv.first_child} + 1 >= bvh.bvs.size() || child[bv.first_child] ||
            child[bv.first_child + 1])
            refuse(name + " has no children of its own after it");
        child[bv.first_child] = child[bv.first_child + 1] = true;
        const Bv &left = bvh.bvs[bv.first_child], &right = bvh.bvs[bv.first_child + 1];
        if (left.first_triangle != bv.first_triangle ||
            right.first_triangle != left.first_triangle + left.triangle_count ||
            left.triangle_count + right.triangle_count != bv.triangle_count)
            refuse(name + " does not hold its children's triangles");
    }
    for (std::size_t i = 1; i < bvh.bvs.size(); ++i)
        if (!child[i])
            refuse("BV " + std::to_string(i) + " has no parent");
}

std::vector<std::uint32_t> vertices_of(const DeformableSurface& surface, const Bvh& bvh, std::size_t bv)
{
    std::vector<std::uint32_t> vertices;
    for (std::uint32_t t = 0; t < bvh.bvs[bv].triangle_count; ++t)
        for (std::uint32_t v : surface.mesh.triangles[bvh.triangle[bvh.bvs[bv].first_triangle + t]])
            vertices.push_back(v);
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    return vertices;
}

std::string rest_data_fault(const DeformableSurface& surface, const Bvh& bvh, std::size_t index,
                            std::span<const std::uint32_t> vertices)
{
    const Bv& bv = bvh.bvs[index];
    const RestBv rest = bvh.rest(index);
    if (rest.node.empty())
        return "no simulation node is listed";
    for (std::size_t j = 0; j < rest.node.size(); ++j) {
        const std::string where = "simulation node " + std::to_string(rest.node[j]);
        if (rest.node[j] >= surface.weights.node_count || (j > 0 && rest.node[j] <= rest.node[j - 1]))
            return "simulation nodes do not ascend or are out of range";
        if (!(0 <= rest.space.l[j] && rest.space.l[j] <= rest.space.h[j] && rest.space.h[j] <= 1))
            return where + ": not 0 <= l <= h <= 1 but l = " + hex(rest.space.l[j]) + ", h = " + hex(rest.space.h[j]);
    }
    // Extremes of the box first, in doubles, which are exact; then one exact comparison for each side of each axis.
    for (int axis = 0; axis < 3; ++axis) {
        double low = surface.mesh.vertices[vertices[0]][axis], high = low;
        for (std::uint32_t k : vertices) {
            low = std::min(low, surface.mesh.vertices[k][axis]);
            high = std::max(high, surface.mesh.vertices[k][axis]);
        }
        for (double x : {low, high})
            if (!contains(bv.box.centre[axis], bv.box.half[axis], x))
                return "the rest box does not contain " + std::string(1, static_cast<char>('x' + axis)) + " = " +
                       hex(x);
    }
    std::vector<std::uint32_t> influenced(rest.node.size(), 0); // how many vertices a node influences
    for (std::uint32_t k : vertices) {
        const Weights::Row row = surface.weights.of(k);
        if (row.node.size() > bv.vertex_influences)
            return "vertex " + std::to_string(k) + " has more influences than the BV says";
        for (std::size_t i = 0; i < row.node.size(); ++i) {
            const auto it = std::lower_bound(rest.node.begin(), rest.node.end(), row.node[i]);
            const std::string where =
                "vertex " + std::to_string(k) + ", simulation node " + std::to_string(row.node[i]);
            if (it == rest.node.end() || *it != row.node[i])
                return where + ": influences the BV but is not listed";
            const auto j = static_cast<std::size_t>(it - rest.node.begin());
            if (!(rest.space.l[j] <= row.weight[i] && row.weight[i] <= rest.space.h[j]))
                return where + ": weight " + hex(row.weight[i]) + " lies outside [" + hex(rest.space.l[j]) + ", " +
                       hex(rest.space.h[j]) + "]";
            ++influenced[j];
        }
    }
    for (std::size_t j = 0; j < rest.node.size(); ++j)
        if (influenced[j] < vertices.size() && rest.space.l[j] > 0)
            return "simulation node " + std::to_string(rest.node[j]) + ": l = " + hex(rest.space.l[j]) +
                   ", but a vertex has weight 0";
    return model_fault(surface, rest, bv.oriented, vertices);
}

} // namespace cinch::exact
