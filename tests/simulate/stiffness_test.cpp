// SPDX-License-Identifier: GPL-3.0-or-later
// How stiff a body is changes nothing in how it moves freely, and what rounding leaves of a motion is told.
#include <catch2/catch.hpp>

#include <Eigen/Geometry>

#include "tests/simulate/bodies.hpp"
#include "toolkit/simulate/simulation.hpp"

using namespace cinch;
using test::lattice_body;

namespace {

Integration steps(double step)
{
    Integration i;
    i.step_s = step;
    return i;
}

BodySimulation elastic(const MeshlessBody& body, double young)
{
    BodySimulation s(body, {});
    s.add(make_neo_hookean(young, 0.3));
    s.add(make_hourglass(body, 1, young));
    return s;
}

Field velocities(const MeshlessBody& body, const Vec3& velocity, const Vec3& spin = Vec3::Zero())
{
    Field v(4 * body.size(), 0);
    for (std::size_t i = 0; i < body.size(); ++i)
        at(v, i) = velocity + spin.cross(body.rest[i]);
    return v;
}

Vec3 centre(const BodySimulation& s)
{
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < s.body().size(); ++i)
        sum += at(s.positions(), i) / static_cast<double>(s.body().size());
    return sum;
}

} // namespace

TEST_CASE("gravity moves what it acts on, however weak it is and however stiff the body")
{
    const MeshlessBody body = lattice_body({1, 0.6, 0.6}, 5, 3, 3, {}, 0.2);
    for (const double young : {1e4, 1e12, 1e16, 1e18})
        for (const double g : {1e-12, 1e-5, 9.81, 1e6}) {
            CAPTURE(young, g);
            BodySimulation s = elastic(body, young);
            s.add(make_gravity({0, 0, -g}));
            const Vec3 before = centre(s);
            const StepReport r = s.advance(0.5, steps(1.0 / 60));
            REQUIRE(r.failure == "");
            CHECK((r.at_rounding || r.residual / g <= 1.01e-5));
            CHECK((before - centre(s))[2] == Approx(g * 30 * 31 / 2 / 3600).epsilon(1e-4)); // implicit Euler's parabola
        }
}

TEST_CASE("a body spins as it began, however small, stiff or flat it is")
{
    const double pi = std::acos(-1.0);
    for (const double size : {1e-6, 1.0})
        for (const double young : {size < 1 ? 1e-3 : 1e5, size < 1 ? 1e5 : 1e12, size < 1 ? 1e7 : 1e16})
            for (const int layers : {3, 1}) {
                CAPTURE(size, young, layers);
                const MeshlessBody body = lattice_body({size, 0.6 * size, layers == 1 ? 0 : 0.6 * size}, 5, 3, layers);
                BodySimulation s = elastic(body, young);
                const Vec3 spin(0, 0, 2 * pi);
                s.place(Vec3::Zero(), Mat3::Identity(), velocities(body, Vec3::Zero(), spin));
                const double start = s.kinetic();
                std::string failure;
                for (int frame = 0; frame < 15 && failure.empty(); ++frame)
                    failure = s.advance(1.0 / 60, steps(1.0 / 480)).failure;
                REQUIRE(failure == "");
                CHECK(s.kinetic() > 0.8 * start); // implicit Euler takes a share of ω Δt with every radian
                const Vec3 was = body.rest[0].cwiseProduct(Vec3(1, 1, 0)),
                           is = Vec3(at(s.positions(), 0)).cwiseProduct(Vec3(1, 1, 0));
                CHECK(is.norm() / was.norm() == Approx(1).epsilon(0.02));
                CHECK(std::abs(was.dot(is)) / was.squaredNorm() < 0.15); // a quarter of a turn
            }
}

TEST_CASE("what rounding leaves is a failure, or within the tolerance")
{
    // Ends that are turned by their places in the world, and steel a million times too stiff: a rounding of the places
    // strains it by more than gravity does.
    const MeshlessBody body = lattice_body({1, 0.3, 0.3}, 8, 3, 3);
    for (const double young : {1e5, 1e8, 1e11, 1e14, 1e17, 1e20}) {
        BodySimulation s = elastic(body, young);
        s.add(make_gravity({0, 0, -9.81}));
        std::vector<std::uint32_t> held;
        std::vector<Vec3> places;
        for (std::uint32_t i = 0; i < body.size(); ++i)
            if (body.rest[i][0] < -0.3) {
                held.push_back(i);
                places.push_back(body.rest[i]);
            }
        Turning turning;
        turning.axis = Vec3(1, 1, 0);
        turning.rate = 3;
        s.add(turning_pin(held, places, turning));
        const Field x = s.positions();
        CAPTURE(young);
        StepReport r = s.advance(1.0 / 60, steps(1.0 / 60));
        for (int frame = 1; frame < 10 && r.failure.empty(); ++frame)
            r = s.advance(1.0 / 60, steps(1.0 / 60));
        if (young <= 1e8)
            CHECK(r.failure == "");
        if (young >= 1e17) {
            CHECK(r.failure.find("rounding: accelerations are off by ") == 0);
            CHECK((s.positions() == x));
        }
        UNSCOPED_INFO(young << ": " << r.failure << " " << r.residual << " of " << r.acceleration << " "
                            << r.at_rounding);
        if (r.failure.empty() && !r.at_rounding)
            CHECK(r.residual <= 1e-5 * r.acceleration);
    }
}

TEST_CASE("a body at rest stays there, strained or not, also where nothing but rounding is left of its forces")
{
    const MeshlessBody solid = lattice_body({1, 0.3, 0.3}, 8, 3, 3), sheet = lattice_body({1, 1, 0}, 5, 5, 1),
                       rope = lattice_body({1, 1e-9, 0}, 6, 1, 1);
    const Mat3 turned = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    for (const MeshlessBody* body : {&solid, &sheet, &rope})
        for (const double young : {1e4, 1e9, 1e14}) {
            CAPTURE(int(body->rank[0]), young);
            BodySimulation s = elastic(*body, young);
            const Field x = test::moved(*body, turned, {3, -2, 1}, 0, 1);
            s.place(x, Field(x.size(), 0));
            REQUIRE(s.advance(0.1, steps(1.0 / 60)).failure == "");
            CHECK((whole(s.positions()) - whole(x)).norm() < 1e-12);
        }
    // Held twice as long as at rest, until it no longer rings: forces of 1e5 Pa that leave no acceleration.
    BodySimulation s = elastic(solid, 1e5);
    s.add(make_mass_damping(30));
    std::vector<std::uint32_t> ends;
    std::vector<Vec3> places;
    for (std::uint32_t i = 0; i < solid.size(); ++i)
        if (std::abs(solid.rest[i][0]) > 0.4) {
            ends.push_back(i);
            places.push_back(solid.rest[i].cwiseProduct(Vec3(2, 1, 1)));
        }
    s.add(fixed_pin(ends, places));
    for (int frame = 0; frame < 60; ++frame)
        REQUIRE(s.advance(1.0 / 30, steps(1.0 / 30)).failure == "");
    CHECK(std::sqrt(2 * s.kinetic()) < 1e-6);
}
