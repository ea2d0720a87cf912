// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/vertex_enclosure.hpp"

#include "exact/along.hpp"
#include "exact/rest_data.hpp"

namespace cinch::exact {
namespace {

Interval square_of_distance(const std::array<Enclosure, 3>& place, const Vec3& centre)
{
    Interval sum(0);
    for (int r = 0; r < 3; ++r)
        sum += CGAL::square(interval_of(place[static_cast<std::size_t>(r)]) - Interval(centre[r]));
    return sum;
}

} // namespace

InstantEnclosure::InstantEnclosure(const DeformableSurface& surface, const MotionEnclosure& clip,
                                   std::span<const MorphTarget> targets, double t_s)
    : surface_(surface), displacements_(targets, surface.mesh.vertices.size())
{
    std::vector<MapEnclosure> slopes;
    std::vector<Enclosure> weight_slopes;
    clip.at(t_s, t_s, t_s, t_s, maps_, slopes);
    if (!targets.empty())
        clip.weights_at(t_s, t_s, t_s, t_s, weights_, weight_slopes);
}

std::array<Enclosure, 3> InstantEnclosure::place(std::uint32_t vertex) const
{
    const DirectedRounding rounding;
    const Vec3& rest = surface_.mesh.vertices[vertex];
    Place y{Interval(rest[0]), Interval(rest[1]), Interval(rest[2])}, x{Interval(0), Interval(0), Interval(0)};
    add_displacement(displacements_.of(vertex), weights_, y);
    add_place(surface_.weights.of(vertex), y, maps_, true, x);
    return {Enclosure{x[0].inf(), x[0].sup()}, {x[1].inf(), x[1].sup()}, {x[2].inf(), x[2].sup()}};
}

bool is_outside(const std::array<Enclosure, 3>& place, const Vec3& centre, double radius)
{
    const DirectedRounding rounding;
    return square_of_distance(place, centre).inf() > (Interval(radius) * Interval(radius)).sup();
}

bool is_inside(const std::array<Enclosure, 3>& place, const Vec3& centre, double radius)
{
    const DirectedRounding rounding;
    return square_of_distance(place, centre).sup() <= (Interval(radius) * Interval(radius)).inf();
}

bool rest_boxes_hold(const DeformableSurface& surface, std::span<const Vec3> low, std::span<const Vec3> high)
{
    require_dyadic_weights(surface);
    for (std::size_t v = 0; v < surface.mesh.vertices.size(); ++v) {
        const Weights::Row row = surface.weights.of(v);
        for (std::size_t i = 0; i < row.node.size(); ++i)
            for (int c = 0; c < 3; ++c) { // comparisons of doubles are exact
                const double x = surface.mesh.vertices[v][c];
                if (row.weight[i] > 0 && !(low[row.node[i]][c] <= x && x <= high[row.node[i]][c]))
                    return false;
            }
    }
    return true;
}

} // namespace cinch::exact
