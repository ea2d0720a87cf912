// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstring>

#include <catch2/catch.hpp>

#include "cinch/bounds.hpp"
#include "tests/collide/random_bodies.hpp"
#include "toolkit/bounds/kernel/project_kernel.hpp"
#include "toolkit/deform/kernel/targets.hpp"
#include "toolkit/hierarchy/lazy_refit.hpp"

using namespace cinch;
using namespace cinch::test;

namespace {

template <class T> void append(std::string& bytes, const T* p, std::size_t count)
{
    bytes.append(reinterpret_cast<const char*>(p), count * sizeof(T));
}

// What each target makes of it; the last argument is for names.
template <class Make> void check_targets(const Make& make)
{
    const auto targets = kernel_targets();
    std::vector<std::string> made;
    for (const std::string& target : targets) {
        REQUIRE(force_kernel_target(target));
        made.push_back(make());
    }
    force_kernel_target("");
    REQUIRE_FALSE(made[0].empty());
    for (std::size_t i = 1; i < made.size(); ++i) {
        INFO(targets[i] << " against " << targets[0]);
        CHECK((made[i] == made[0]));
    }
}

std::vector<Maps> hard_maps(Dice& dice, std::size_t nodes)
{
    std::vector<Maps> all;
    for (const double scale : {1e-40, 1e-3, 1.0, 1e6, 1e25})
        for (const double far : {0.0, 1.0, 1e7})
            all.push_back(around(dice, nodes, scale * dice.rotation(), far * dice.point(), 0.1 * scale));
    all.push_back(all[6]);
    all.back()[1].m[2][3] = std::numeric_limits<double>::quiet_NaN();
    all.back()[2].m[0][1] = std::numeric_limits<double>::infinity();
    all.back()[4].m[0][1] = 1e200;
    return all;
}

} // namespace

TEST_CASE("trees, their leaves and slots: the same bits on every target of this machine")
{
    Dice dice(61);
    const DeformableSurface surface = patchy(dice, brain(150), 13, 6);
    const std::vector<Maps> frames = hard_maps(dice, 13);
    for (const std::size_t lanes : {4u, 8u, 16u})
        for (const int kdop : kdops)
            for (const Update update : {Update::lazy, Update::full}) {
                const Bvh bvh = build_bvh(surface, ClusterSize{lanes, lanes}, RestDetail::inner);
                check_targets([&] {
                    LazyOptions options;
                    options.kdop = kdop;
                    options.update = update;
                    options.lanes = lanes;
                    LazyRefit tree(bvh, surface, options);
                    std::string bytes;
                    for (const Maps& maps : frames) {
                        tree.begin({maps});
                        for (std::uint32_t bv = 0; bv < bvh.bvs.size(); ++bv)
                            if (!tree.link(bv).is_leaf()) {
                                tree.expand(bv);
                                tree.supply();
                            }
                        for (std::uint32_t bv = 0; bv < bvh.bvs.size(); ++bv)
                            if (tree.link(bv).is_leaf() && tree.known())
                                tree.want_slot(bv);
                        if (!tree.known())
                            continue;
                        tree.supply();
                        for (std::uint32_t bv = 0; bv < bvh.bvs.size(); ++bv) {
                            append(bytes, tree.dop(bv), dop_floats(kdop));
                            if (tree.link(bv).is_leaf()) {
                                append(bytes, tree.slot(bv), 3 * lanes);
                                append(bytes, &place_of(tree.slot(bv), lanes), 1);
                            }
                        }
                    }
                    return bytes;
                });
            }
}

TEST_CASE("projected maps: the same bits on every target of this machine")
{
    Dice dice(62);
    for (const std::size_t nodes : {1u, 2u, 3u, 4u, 5u, 7u, 8u, 9u, 33u})
        for (const int kdop : kdops)
            for (const Vec3& rest_origin : {Vec3(0, 0, 0), Vec3(1e5, -3, 0.1)}) {
                const RestExtent rest{rest_origin, {1, 2, 0.5}, rest_origin.cwiseAbs() + Vec3(1, 2, 0.5), 5};
                std::vector<Maps> frames = hard_maps(dice, std::max<std::size_t>(nodes, 5));
                check_targets([&] {
                    std::string bytes;
                    auto add = [&]<class T>(T, const Maps& maps, bool proven, const Vec3& origin) {
                        std::vector<T> records(nodes * 4 * projected_rows(static_cast<std::size_t>(kdop / 2)), T(7));
                        const ProjectionReport report = project_nodes(std::span(maps).first(nodes), rest, axes_of(kdop),
                                                                      proven, origin, records.data());
                        append(bytes, records.data(), records.size());
                        append(bytes, &report.unbounded, 1);
                        append(bytes, &report.vertex_error, 1);
                    };
                    for (const Maps& maps : frames)
                        for (const bool proven : {true, false})
                            for (const Vec3& origin : {Vec3(0, 0, 0), Vec3(4096, 0, -8)}) {
                                add(1.0f, maps, proven, origin);
                                add(1.0, maps, proven, origin);
                            }
                    return bytes;
                });
            }
}
