// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>

#include <catch2/catch.hpp>

#include "cinch/bounds.hpp"
#include "toolkit/bounds/bound_box.hpp"
#include "toolkit/bounds/bound_vertex.hpp"
#include "toolkit/bounds/greatest_mean.hpp"
#include "toolkit/bounds/rounding.hpp"

using namespace cinch;

namespace {

struct Bounded {
    std::vector<AffineMap> maps{identity_map, identity_map};
    std::vector<std::uint32_t> node{0, 1};
    std::vector<double> l{0, 0.25}, h{0.75, 1};
    Vec3 centre{1, 2, 3}, half{0.5, 0.25, 0.125};

    std::vector<double> supports(Method method, int kdop, Rounding rounding = Rounding::proven) const
    {
        BoundScratch scratch;
        std::vector<double> out(static_cast<std::size_t>(kdop));
        bound_box({{centre, half}, node, {l, h}, {}, {}, Vec3::Zero(), {}, {}, 0, 2}, maps, method, rounding,
                  axes_of(kdop), scratch, out);
        return out;
    }
};

} // namespace

TEST_CASE("the axes are those of the standard k-DOPs")
{
    CHECK(axes_of(6).size() == 3);
    CHECK(axes_of(14).size() == 7);
    CHECK(axes_of(18).size() == 9);
    CHECK(axes_of(26).size() == 13);
    for (const Axis& axis : axes_of(14).subspan(3))
        CHECK(std::abs(axis[0]) + std::abs(axis[1]) + std::abs(axis[2]) == 3);
    for (const Axis& axis : axes_of(18).subspan(3))
        CHECK(std::abs(axis[0]) + std::abs(axis[1]) + std::abs(axis[2]) == 2);
    for (int k : kdops)
        for (std::size_t a = 0; a < 3; ++a)
            CHECK(axes_of(k)[a] == all_axes[a]);
    CHECK_FALSE(is_kdop(8));
}

TEST_CASE("identity maps bound the rest box, up to the guard")
{
    for (Method method : ladder_methods) {
        const auto s = Bounded{}.supports(method, 26);
        const double wanted[] = {1.5, -0.5, 2.25, -1.75, 3.125, -2.875, 6.875, -5.125};
        for (std::size_t d = 0; d < 8; ++d) {
            CHECK(s[d] >= wanted[d]);
            CHECK(s[d] <= wanted[d] + 1e-13);
        }
        CHECK(Bounded{}.supports(method, 6, Rounding::plain)[0] == 1.5);
    }
}

TEST_CASE("moving one node moves the bound by its greatest weight, and by all for convex")
{
    Bounded moved;
    moved.maps[0].m[0][3] = 8;
    CHECK(moved.supports(Method::limited, 6, Rounding::plain)[0] == 1.5 + 0.75 * 8);
    CHECK(moved.supports(Method::eq12, 6, Rounding::plain)[0] == 1.5 + 0.75 * 8);
    CHECK(moved.supports(Method::convex, 6, Rounding::plain)[0] == 1.5 + 8);
    CHECK(moved.supports(Method::limited, 6, Rounding::plain)[1] == -0.5); // w₁ = 1 is allowed
}

TEST_CASE("a map that is not finite gives infinite supports, one that overflows in the directions it reaches")
{
    for (Method method : box_methods)
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 4; ++c) {
                for (double x : {std::numeric_limits<double>::quiet_NaN(), infinite, -infinite}) {
                    Bounded b;
                    b.maps[1].m[r][c] = x;
                    for (double support : b.supports(method, 6))
                        CHECK(support == infinite);
                }
                Bounded b;
                b.maps[1].m[r][c] = std::numeric_limits<double>::max();
                const auto s = b.supports(method, 6);
                for (int d = 0; d < 6; ++d)
                    if (d / 2 != r)
                        CHECK(s[static_cast<std::size_t>(d)] < 5);
                    else if (c < 3 || d % 2 == 0) // times a coordinate above 1, or plus one
                        CHECK(s[static_cast<std::size_t>(d)] == infinite);
            }
}

TEST_CASE("a corner that overflows downwards hides no other one")
{
    // Weights 7/8 and 1/8 give −1.70625·10^308; what goes through −∞ on the way there must not be passed over.
    Bounded b;
    b.l = {0.125, 0.125};
    b.h = {1, 0.5};
    b.centre = b.half = Vec3::Zero();
    b.maps[0].m[0][3] = -1.70e308;
    b.maps[1].m[0][3] = -1.75e308;
    for (const Method method : {Method::convex, Method::corners, Method::eq12, Method::limited}) {
        CAPTURE(name_of(method));
        CHECK(b.supports(method, 6)[0] >= -1.70625e308);
    }
}

TEST_CASE("the greatest mean of numbers at the end of the range")
{
    const double eta = smallest_subnormal;
    const std::vector<std::uint32_t> node{0, 1};
    const std::vector<double> l{0.375, 0.25}, h{0.75, 0.625};
    const RestBv bv{{Vec3::Zero(), Vec3::Zero()}, node, {l, h}, {}, {}, Vec3::Zero(), {}, {}, 0, 2};
    const double c[2] = {2 * eta, eta};
    CHECK(greatest_mean(bv, [&](std::size_t j) { return c[j]; }) == 2 * eta); // 3/4 and 1/4 give 1.75 η
}

TEST_CASE("bound_vertex gives the vertex, and infinity for what is not finite")
{
    std::vector<AffineMap> maps{identity_map};
    const std::vector<std::uint32_t> node{0};
    const std::vector<double> weight{1};
    std::vector<double> s(14);
    bound_vertex({1, 2, 3}, {node, weight}, maps, Rounding::plain, axes_of(14), s);
    CHECK(s == std::vector<double>{1, -1, 2, -2, 3, -3, 6, -6, 0, 0, 2, -2, -4, 4});
    bound_vertex({1, 2, 3}, {node, weight}, maps, Rounding::proven, axes_of(14), s);
    CHECK(s[6] > 6);
    CHECK(s[6] < 6 + 1e-13);
    maps[0].m[0][3] = -infinite;
    bound_vertex({1, 2, 3}, {node, weight}, maps, Rounding::proven, axes_of(14), s);
    CHECK(s[0] == infinite);
    CHECK(s[1] == infinite);
}
