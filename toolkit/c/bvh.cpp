// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "toolkit/c/arrays.hpp"
#include "toolkit/c/call.hpp"
#include "toolkit/c/objects.hpp"

namespace {

using namespace cinch;
using namespace cinch::c;

void put_point(const Vec3& from, double (&to)[3]) { std::copy_n(from.data(), 3, to); }

cinch_bv bv_of(const Bv& bv)
{
    cinch_bv out{};
    put_point(bv.box.centre, out.centre);
    put_point(bv.box.half, out.half);
    put_point(bv.oriented.centre, out.oriented_centre);
    for (std::size_t i = 0; i < 3; ++i)
        put_point(bv.oriented.axis[i], out.oriented_axis[i]);
    put_point(bv.pivot, out.pivot);
    out.slack = bv.slack;
    out.first_triangle = bv.first_triangle;
    out.triangle_count = bv.triangle_count;
    out.first_child = bv.first_child;
    out.first_influence = bv.first_influence;
    out.influence_count = bv.influence_count;
    out.first_point = bv.first_point;
    out.point_count = bv.point_count;
    out.vertex_influences = bv.vertex_influences;
    return out;
}

cinch_influence influence_of(const Bvh& bvh, std::size_t i)
{
    cinch_influence out{};
    out.node = bvh.node[i];
    out.l = bvh.l[i];
    out.h = bvh.h[i];
    if (bvh.model.empty())
        return out;
    put_point(bvh.local[i].centre, out.centre);
    put_point(bvh.local[i].half, out.half);
    out.radius = bvh.radius[i];
    out.mean = bvh.model[i].mean;
    put_point(bvh.model[i].gradient, out.gradient);
    out.residual = bvh.model[i].residual;
    put_point(bvh.model[i].moment, out.moment);
    return out;
}

RestDetail detail_of(std::int32_t detail)
{
    constexpr RestDetail all[] = {RestDetail::all, RestDetail::boxes, RestDetail::inner};
    if (detail < CINCH_DETAIL_ALL || detail > CINCH_DETAIL_INNER)
        throw std::invalid_argument("there is no detail " + std::to_string(detail));
    return all[detail];
}

std::int32_t detail_of(RestDetail detail)
{
    return detail == RestDetail::all     ? CINCH_DETAIL_ALL
           : detail == RestDetail::boxes ? CINCH_DETAIL_BOXES
                                         : CINCH_DETAIL_INNER;
}

} // namespace

cinch_status cinch_bvh_build(const cinch_surface* surface, size_t leaf_triangles, size_t leaf_vertices, int32_t detail,
                             cinch_bvh** bvh)
{
    return call([&] {
        given(bvh, "bvh") = nullptr;
        const auto of = get<Surface>(surface);
        const RestDetail wanted = detail_of(detail);
        *bvh = put(std::make_shared<Tree>(Tree{
            of, leaf_vertices == 0 ? build_bvh(*of->surface, leaf_triangles, wanted)
                                   : build_bvh(*of->surface, ClusterSize{leaf_triangles, leaf_vertices}, wanted)}));
    });
}

cinch_status cinch_bvh_get_sizes(const cinch_bvh* bvh, cinch_bvh_sizes* sizes)
{
    return call([&] {
        const auto tree = get<Tree>(bvh);
        const Bvh& all = tree->bvh;
        given(sizes, "sizes") = {all.bvs.size(),        all.level.empty() ? 0 : all.level.size() - 1,
                                 all.triangle.size(),   all.node.size(),
                                 all.point.size(),      all.bytes(),
                                 detail_of(all.detail), all.model.empty() ? 0 : 1};
    });
}

cinch_status cinch_bvh_get_bvs(const cinch_bvh* bvh, cinch_bv* bvs, size_t count)
{
    return call([&] {
        const auto tree = get<Tree>(bvh);
        const auto out = array_of<cinch_bv>(bvs, count, tree->bvh.bvs.size(), "bvs");
        std::transform(tree->bvh.bvs.begin(), tree->bvh.bvs.end(), out.begin(), bv_of);
    });
}

cinch_status cinch_bvh_get_influences(const cinch_bvh* bvh, cinch_influence* influences, size_t count)
{
    return call([&] {
        const auto tree = get<Tree>(bvh);
        const auto out = array_of<cinch_influence>(influences, count, tree->bvh.node.size(), "influences");
        for (std::size_t i = 0; i < count; ++i)
            out[i] = influence_of(tree->bvh, i);
    });
}

cinch_status cinch_bvh_get_indices(const cinch_bvh* bvh, int32_t which, uint32_t* indices, size_t count)
{
    return call([&] {
        const auto tree = get<Tree>(bvh);
        if (which < CINCH_BVH_LEVELS || which > CINCH_BVH_POINTS)
            throw std::invalid_argument("there are no indices " + std::to_string(which));
        const std::vector<std::uint32_t>* const all[] = {&tree->bvh.level, &tree->bvh.triangle, &tree->bvh.point};
        const std::vector<std::uint32_t>& wanted = *all[which];
        const auto out = array_of<std::uint32_t>(indices, count, wanted.size(), "indices");
        std::copy(wanted.begin(), wanted.end(), out.begin());
    });
}
