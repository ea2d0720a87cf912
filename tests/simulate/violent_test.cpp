// SPDX-License-Identifier: GPL-3.0-or-later
// Impacts, spins and frictions at which an integrator might gain energy, or fail.
#include <catch2/catch.hpp>

#include <Eigen/Geometry>

#include "tests/simulate/bodies.hpp"

using namespace cinch;
using test::lattice_body;
using test::moved;

namespace {

Integration steps(Integration::Method method, double step)
{
    Integration i;
    i.method = method;
    i.step_s = step;
    return i;
}

BodySimulation block(const MeshlessBody& body, double young, double poisson = 0.3)
{
    BodySimulation s(body, {});
    s.add(make_neo_hookean(young, poisson));
    s.add(make_hourglass(body, 1, young));
    return s;
}

void spin(BodySimulation& s, const Vec3& omega, const Vec3& velocity = Vec3::Zero())
{
    const Field x = moved(s.body(), Mat3::Identity(), Vec3::Zero(), 0, 1);
    Field v(x.size(), 0);
    for (std::size_t i = 0; i < s.body().size(); ++i)
        at(v, i) = velocity + omega.cross(Vec3(at(x, i)));
    s.place(x, v);
}

} // namespace

TEST_CASE("the explicit integrator survives impacts on a ground of any stiffness")
{
    const MeshlessBody body = lattice_body({1, 1, 1}, 3, 3, 3);
    for (const double stiffness : {1e5, 1e7, 1e9})
        for (const double young : {1e4, 1e6})
            for (const double friction : {0.0, 0.5}) {
                BodySimulation s = block(body, young);
                s.add(make_gravity({0, 0, -9.81}));
                s.add(make_ground({Vec3(0, 0, -0.6), Vec3::UnitZ(), stiffness, friction, true}));
                spin(s, Vec3::Zero(), {friction, 0, -2});
                const double fall = 9.81 * 1000 * 0.6, start = s.kinetic();
                CAPTURE(stiffness, young, friction);
                for (int frame = 0; frame < 40; ++frame) {
                    const StepReport r = s.advance(1.0 / 60, steps(Integration::Method::explicit_euler, 1.0 / 60));
                    REQUIRE(r.failure.empty());
                    REQUIRE(r.kinetic < 1.5 * (start + fall));
                }
            }
}

TEST_CASE("the explicit integrator survives spins that tear the material")
{
    const MeshlessBody body = lattice_body({1, 1, 1}, 3, 3, 3);
    struct Case {
        Vec3 omega;
        double young, poisson, volume;
    };
    for (const Case& c :
         {Case{{100, 20, 3}, 1e3, 0.45, 1e7}, Case{{300, 1000, 0}, 1e5, 0.3, 0}, Case{{30, 0, 0}, 1e4, 0.3, 0}}) {
        BodySimulation s = block(body, c.young, c.poisson);
        if (c.volume > 0)
            s.add(make_volume(c.volume));
        spin(s, c.omega);
        const double start = s.kinetic();
        CAPTURE(c.omega.transpose());
        std::string failure;
        for (int frame = 0; frame < 10 && failure.empty(); ++frame) {
            const StepReport r = s.advance(1.0 / 60, steps(Integration::Method::explicit_euler, 1.0 / 60));
            failure = r.failure; // may give up, and say so
            REQUIRE(r.kinetic + r.potential < 1.5 * start);
        }
    }
}

TEST_CASE("the explicit integrator takes steps that the viscosity allows")
{
    for (const double viscosity : {0.0, 1e3, 1e5}) {
        BodySimulation s = block(lattice_body({1, 1, 1}, 4, 4, 4), 1e4);
        s.add(make_mass_damping(viscosity * 1e-2));
        if (viscosity > 0)
            s.add(make_viscosity(viscosity));
        s.place(moved(s.body(), Vec3(1.2, 0.9, 1).asDiagonal(), Vec3::Zero(), 0, 1),
                moved(s.body(), Mat3::Zero(), Vec3::Zero(), 0.5, 2));
        const double start = s.kinetic() + s.potential();
        for (int frame = 0; frame < 6; ++frame) {
            const StepReport r = s.advance(1.0 / 60, steps(Integration::Method::explicit_euler, 1.0 / 60));
            REQUIRE(r.failure.empty());
            REQUIRE(r.kinetic + r.potential < 1.1 * start);
        }
        CHECK((viscosity == 0 || s.kinetic() + s.potential() < 0.7 * start));
    }
}

TEST_CASE("implicit steps make no energy, however a body spins, collapses or is arranged")
{
    struct Case {
        int x, y, z;
        Vec3 omega;
        double poisson;
    };
    for (const Case& c : {Case{2, 2, 1, {50, 10, 0}, 0.3}, Case{3, 3, 1, {0, 0, 40}, 0.45},
                          Case{3, 3, 3, {80, 3, 0}, 0.3}, Case{2, 1, 1, {0, 20, 5}, 0.3}}) {
        const MeshlessBody body = lattice_body({1, 1, 1}, c.x, c.y, c.z);
        BodySimulation s = block(body, 1e3, c.poisson);
        spin(s, c.omega);
        double energy = s.kinetic() + s.potential();
        const double start = energy;
        CAPTURE(c.x, c.y, c.z, c.omega.transpose());
        for (int frame = 0; frame < 30; ++frame) {
            const StepReport r = s.advance(1.0 / 60, steps(Integration::Method::implicit_euler, 1.0 / 60));
            REQUIRE(r.failure.empty());
            CHECK(r.kinetic + r.potential <= energy + 1e-6 * start);
            energy = r.kinetic + r.potential;
        }
    }
}

TEST_CASE("implicit friction: impacts are solved, a slope holds what it should, also for a single node")
{
    for (const double stiffness : {1e5, 1e6, 1e7})
        for (const double young : {1e4, 1e6}) {
            BodySimulation s = block(lattice_body({1, 1, 1}, 3, 3, 3), young);
            s.add(make_gravity({0, 0, -9.81}));
            s.add(make_ground({Vec3(0, 0, -0.6), Vec3::UnitZ(), stiffness, 0.5, true}));
            spin(s, {0, 1, 0}, {1, 0, -2});
            CAPTURE(stiffness, young);
            for (int frame = 0; frame < 60; ++frame)
                REQUIRE(s.advance(1.0 / 60, steps(Integration::Method::implicit_euler, 1.0 / 60)).failure == "");
        }
    {
        BodySimulation s(lattice_body({1, 1, 1}, 1, 1, 1), {});
        s.add(make_gravity({0, 0, -9.81}));
        s.add(make_ground({Vec3(0, 0, -0.6), Vec3::UnitZ(), 1e5, 0.5, true}));
        for (int frame = 0; frame < 60; ++frame)
            REQUIRE(s.advance(1.0 / 60, steps(Integration::Method::implicit_euler, 1.0 / 60)).failure == "");
    }
    // A slope of tangent 0.3 under friction 0.5: a creep of about the speed below which friction fades (1 mm/s),
    // whatever the step.
    for (const double step : {1.0 / 60, 1.0 / 1000}) {
        BodySimulation s = block(lattice_body({0.6, 0.4, 0.2}, 6, 4, 2), 1e6);
        s.add(make_gravity({-10 * std::sin(std::atan(0.3)), 0, -10 * std::cos(std::atan(0.3))}));
        s.add(make_mass_damping(5));
        s.add(make_ground({Vec3(0, 0, -0.05), Vec3::UnitZ(), 1e7, 0.5, true}));
        REQUIRE(s.advance(0.5, steps(Integration::Method::implicit_euler, step)).failure == "");
        const double before = at(s.positions(), 0)[0];
        REQUIRE(s.advance(1, steps(Integration::Method::implicit_euler, step)).failure == "");
        CAPTURE(step);
        CHECK(std::abs(at(s.positions(), 0)[0] - before) < 3e-3);
    }
}

TEST_CASE("what cannot be is reported, not done")
{
    const MeshlessBody body = lattice_body({1, 1, 1}, 2, 2, 2);
    {
        BodySimulation s = block(body, 1e4);
        std::vector<std::uint32_t> all{0, 1, 2, 3, 4, 5, 6, 7};
        s.add(sliding_pin(all, body.rest, {1e308, 0, 0}, 1e9));
        const StepReport r = s.advance(10, steps(Integration::Method::implicit_euler, 10));
        CHECK_FALSE(r.failure.empty());
        CHECK(whole(s.positions()).allFinite());
    }
    {
        BodySimulation s = block(body, 1e4);
        CHECK(s.advance(1, steps(Integration::Method::implicit_euler, 1e-12)).failure.find("a million steps") !=
              std::string::npos);
        Integration stopped = steps(Integration::Method::implicit_euler, 1e-3);
        stopped.cancelled = [] { return true; };
        CHECK(s.advance(1, stopped).failure == "cancelled");
        CHECK(s.time_s() == 0);
    }
}
