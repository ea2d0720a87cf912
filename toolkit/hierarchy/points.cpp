// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "toolkit/bounds/rounding.hpp"
#include "toolkit/deform/dyadic.hpp"
#include "toolkit/deform/parallel.hpp"
#include "toolkit/hierarchy/rest_data.hpp"
#include "toolkit/surface/length.hpp"

namespace cinch {
namespace {

// A net of directions: the points of a grid on the surface of the cube [−1, 1]³, scaled to integers, and the triangles
// between them. A direction q in the cone of a triangle is Σ c_i u_i with c_i ≥ 0 and Σ c_i = |q|_∞, as every u_i has
// |u_i|_∞ = 1 on one face.
struct Net {
    static constexpr int cells = 4; // per half edge of the cube
    std::vector<Vec3> direction;    // in units of 1/cells
    std::vector<std::array<std::uint32_t, 3>> triangle;

    Net()
    {
        constexpr int side = 2 * cells + 1;
        std::vector<std::uint32_t> place(side * side * side, std::numeric_limits<std::uint32_t>::max());
        auto at = [&](int x, int y, int z) {
            std::uint32_t& p = place[static_cast<std::size_t>(((x + cells) * side + y + cells) * side + z + cells)];
            if (p == std::numeric_limits<std::uint32_t>::max()) {
                p = static_cast<std::uint32_t>(direction.size());
                direction.emplace_back(x, y, z);
            }
            return p;
        };
        for (int axis = 0; axis < 3; ++axis)
            for (int face : {-cells, cells})
                for (int i = -cells; i < cells; ++i)
                    for (int j = -cells; j < cells; ++j) {
                        auto corner = [&](int a, int b) {
                            int p[3];
                            p[axis] = face;
                            p[(axis + 1) % 3] = a;
                            p[(axis + 2) % 3] = b;
                            return at(p[0], p[1], p[2]);
                        };
                        const auto a = corner(i, j), b = corner(i + 1, j), c = corner(i, j + 1),
                                   d = corner(i + 1, j + 1);
                        triangle.push_back({a, b, d});
                        triangle.push_back({a, c, d});
                    }
    }
};

struct Points {
    std::vector<std::uint32_t> vertex;
    double slack = 0;
};

// More for large BVs, where the simulation nodes take the time anyway.
std::size_t most_points(const Bv& bv) { return std::clamp<std::size_t>(bv.influence_count, 32, 64); }

// At least ‖x − (a point of the hull)‖₂, by pairwise Frank-Wolfe from the nearest point of the hull; stops below
// `enough`. The coefficients are made dyadic with sum exactly 1, so that the origin of the coordinates drops out and
// any end is valid. x and the hull are off by u·m each, m = max |coordinate|, the sum of n products passes n + 1
// roundings more, and the scaled norm 6.
double distance_to_hull(const Vec3& x, std::span<const Vec3> hull, double enough, std::vector<double>& alpha)
{
    alpha.assign(hull.size(), 0.0);
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < hull.size(); ++i)
        if ((hull[i] - x).squaredNorm() < (hull[nearest] - x).squaredNorm())
            nearest = i;
    alpha[nearest] = 1;
    Vec3 r = x - hull[nearest];
    for (int step = 0; step < 200 && r.squaredNorm() > 0.98 * enough * enough; ++step) {
        std::size_t to = 0, from = nearest;
        double highest = -std::numeric_limits<double>::infinity(), lowest = -highest;
        for (std::size_t i = 0; i < hull.size(); ++i) {
            const double along = r.dot(hull[i]);
            if (along > highest) {
                highest = along;
                to = i;
            }
            if (alpha[i] > 0 && along < lowest) {
                lowest = along;
                from = i;
            }
        }
        const Vec3 d = hull[to] - hull[from];
        const double squared = d.squaredNorm();
        if (!(r.dot(x - r) + 1e-3 * r.squaredNorm() < highest) || !(squared > 0)) // within 0.1 % of the distance
            break;
        const double move = std::min(alpha[from], r.dot(d) / squared);
        alpha[from] = move == alpha[from] ? 0 : alpha[from] - move;
        alpha[to] += move;
        r -= move * d;
    }
    double most = x.lpNorm<Eigen::Infinity>();
    for (const Vec3& p : hull)
        most = std::max(most, p.lpNorm<Eigen::Infinity>());
    const double n = static_cast<double>(hull.size()),
                 rounding = 4 * (n + 8) * unit_roundoff * most + n * smallest_subnormal;
    // r and the sum of alpha have passed 200 steps of less than 8u·m each at most, together less than 45 times
    // `rounding`: less than 0.01 of `enough`, as is what 0.98 leaves.
    if (r.squaredNorm() <= 0.98 * enough * enough && rounding < 2e-4 * enough)
        return enough;
    round_dyadic(alpha);
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < hull.size(); ++i)
        sum += alpha[i] * hull[i];
    return succ(length(x - sum) + rounding);
}

// The triangle of the net that the points so far leave farthest from h: max_i (h(u_i) − u_i·p) of its corners, for the
// best point p. It only shrinks as points are added, so that what was computed of a triangle before the last points is
// at least what it is: only those on top are brought up to date.
class WorstTriangle {
public:
    WorstTriangle(const Net& net, std::span<const double> height, std::span<const Vec3> points)
        : net_(net), height_(height), left_(net.triangle.size(), std::numeric_limits<double>::infinity()),
          seen_(left_.size(), 0), points_(points.begin(), points.end())
    {
        std::vector<double> gap(height.size());
        for (const Vec3& y : points) {
            for (std::size_t d = 0; d < gap.size(); ++d)
                gap[d] = height[d] - net.direction[d].dot(y);
            for (std::size_t t = 0; t < left_.size(); ++t) {
                const auto& [a, b, c] = net.triangle[t];
                left_[t] = std::min(left_[t], std::max({gap[a], gap[b], gap[c]}));
            }
        }
        for (std::uint32_t t = 0; t < left_.size(); ++t) {
            seen_[t] = points_.size();
            heap_.push_back(t);
        }
        std::make_heap(heap_.begin(), heap_.end(), order());
    }

    void add(const Vec3& point) { points_.push_back(point); }

    /// The first of those with the most left; empty where nothing is.
    std::optional<std::uint32_t> operator()()
    {
        for (;;) {
            if (heap_.empty())
                return {};
            const std::uint32_t t = heap_.front();
            if (seen_[t] == points_.size())
                return left_[t] > 0 ? std::optional(t) : std::nullopt;
            std::pop_heap(heap_.begin(), heap_.end(), order());
            for (; seen_[t] < points_.size(); ++seen_[t]) {
                double most = -std::numeric_limits<double>::infinity();
                for (const std::uint32_t d : net_.triangle[t])
                    most = std::max(most, height_[d] - net_.direction[d].dot(points_[seen_[t]]));
                left_[t] = std::min(left_[t], most);
            }
            std::push_heap(heap_.begin(), heap_.end(), order());
        }
    }

    /// Leaves out the one that was found.
    void settle()
    {
        std::pop_heap(heap_.begin(), heap_.end(), order());
        heap_.pop_back();
    }

    /// The corner of a triangle along which h is farthest beyond the points.
    std::uint32_t farthest_corner(std::uint32_t t) const
    {
        auto short_of = [&](std::uint32_t d) {
            double reached = -std::numeric_limits<double>::infinity();
            for (const Vec3& y : points_)
                reached = std::max(reached, net_.direction[d].dot(y));
            return height_[d] - reached;
        };
        std::uint32_t corner = net_.triangle[t][0];
        for (const std::uint32_t d : net_.triangle[t])
            if (short_of(d) > short_of(corner))
                corner = d;
        return corner;
    }

private:
    struct Order {
        const std::vector<double>& left;
        bool operator()(std::uint32_t a, std::uint32_t b) const
        {
            return left[a] < left[b] || (left[a] == left[b] && a > b);
        }
    };
    Order order() const { return {left_}; }

    const Net& net_;
    std::span<const double> height_;
    std::vector<double> left_;
    std::vector<std::size_t> seen_; // points that left_ knows of
    std::vector<Vec3> points_;
    std::vector<std::uint32_t> heap_; // the worst on top
};

// Greedy: for every triangle of the net the best point p so far leaves max_i (h(u_i) − u_i·p), h the support of all
// vertices, which bounds how far the hull of the points falls short of h in its cone. The next point is the extreme one
// along a corner of the worst triangle. How far the vertices are from the hull then is the slack.
Points choose(const TriangleMesh& mesh, const Bv& bv, std::vector<std::uint32_t> vertices)
{
    static const Net net;
    Points out;
    const std::size_t most = most_points(bv);
    if (vertices.size() <= most) {
        out.vertex = std::move(vertices);
        return out;
    }
    std::vector<Vec3> y;
    for (std::uint32_t k : vertices)
        y.push_back(mesh.vertices[k] - bv.pivot);
    const std::size_t directions = net.direction.size();
    std::vector<double> height(directions);
    std::vector<std::uint32_t> extreme(directions, 0);
    for (std::size_t d = 0; d < directions; ++d) {
        const Vec3& u = net.direction[d];
        height[d] = u.dot(y[0]);
        for (std::uint32_t k = 1; k < y.size(); ++k)
            if (const double h = u.dot(y[k]); h > height[d]) {
                height[d] = h;
                extreme[d] = k;
            }
    }
    std::vector<bool> chosen(vertices.size(), false);
    std::vector<Vec3> first;
    auto take = [&](std::uint32_t k) {
        if (chosen[k])
            return false;
        chosen[k] = true;
        out.vertex.push_back(vertices[k]);
        return true;
    };
    for (std::size_t d = 0; d < directions; ++d) // the extremes along the axes
        if (net.direction[d].lpNorm<1>() == Net::cells && take(extreme[d]))
            first.push_back(y[extreme[d]]);
    WorstTriangle worst(net, height, first);
    while (out.vertex.size() < most) {
        const auto t = worst();
        if (!t)
            break;
        const std::uint32_t k = extreme[worst.farthest_corner(*t)];
        if (take(k))
            worst.add(y[k]);
        else
            worst.settle(); // all three extremes are there: as good as the net can tell
    }
    std::vector<Vec3> hull;
    for (std::size_t k = 0; k < y.size(); ++k)
        if (chosen[k])
            hull.push_back(y[k]);
    std::vector<double> alpha;
    auto include = [&](std::uint32_t k) {
        if (!chosen[k])
            out.slack = std::max(out.slack, distance_to_hull(y[k], hull, out.slack, alpha));
    };
    for (std::uint32_t k : extreme) // likely the farthest, so that most others need no more than a look
        include(k);
    for (std::uint32_t k = 0; k < y.size(); ++k)
        include(k);
    return out;
}

} // namespace

void choose_points(const DeformableSurface& surface, Bvh& bvh, bool leaves)
{
    std::vector<Points> points(bvh.bvs.size());
    parallel_blocks(bvh.bvs.size(), 4, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
            if (leaves || !bvh.bvs[i].is_leaf())
                points[i] = choose(surface.mesh, bvh.bvs[i], vertices_of(surface, bvh, bvh.bvs[i]));
    });
    for (std::size_t i = 0; i < bvh.bvs.size(); ++i) {
        Bv& bv = bvh.bvs[i];
        bv.slack = points[i].slack;
        bv.first_point = static_cast<std::uint32_t>(bvh.point.size());
        bv.point_count = static_cast<std::uint32_t>(points[i].vertex.size());
        bvh.point.insert(bvh.point.end(), points[i].vertex.begin(), points[i].vertex.end());
    }
}

} // namespace cinch
