// SPDX-License-Identifier: GPL-3.0-or-later
// What mechanics demands of the whole step: invariance, conservation, order, and the beam of the textbook.
#include <catch2/catch.hpp>

#include <Eigen/Geometry>

#include "tests/simulate/bodies.hpp"

using namespace cinch;
using test::lattice_body;
using test::moved;
using test::total;

namespace {

Integration explicitly(double longest)
{
    Integration i;
    i.method = Integration::Method::explicit_euler;
    i.step_s = longest;
    return i;
}
Integration implicitly(double step, double tolerance = 1e-8)
{
    Integration i;
    i.step_s = step;
    i.tolerance = tolerance;
    return i;
}

Mat3 turn(double angle) { return Eigen::AngleAxisd(angle, Vec3(1, 2, -1).normalized()).toRotationMatrix(); }

BodySimulation soft(const MeshlessBody& body, double young, double poisson = 0.3)
{
    BodySimulation s(body, {});
    s.add(make_neo_hookean(young, poisson));
    s.add(make_hourglass(body, 1, young));
    return s;
}

Vec3 angular_momentum(const BodySimulation& s)
{
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < s.body().size(); ++i)
        sum += s.body().mass[i] * Vec3(at(s.positions(), i)).cross(Vec3(at(s.velocities(), i)));
    return sum;
}
Vec3 momentum(const BodySimulation& s)
{
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < s.body().size(); ++i)
        sum += s.body().mass[i] * at(s.velocities(), i);
    return sum;
}

// A stretched and spinning start.
void excite(BodySimulation& s, double stretch = 1.15)
{
    Mat3 a = turn(0.4);
    a.col(0) *= stretch;
    Field x = moved(s.body(), a, {1, 2, 3}, 0.005, 2), v = moved(s.body(), Mat3::Zero(), {0.3, -0.2, 0.1}, 0.05, 3);
    for (std::size_t i = 0; i < s.body().size(); ++i)
        at(v, i) += Vec3(0.5, 1, -0.3).cross(s.body().rest[i]);
    s.place(x, v);
}

} // namespace

TEST_CASE("rigid motions create no force")
{
    const MeshlessBody solid = lattice_body({1, 1, 1}, 6, 6, 6, {}, 0.25),
                       sheet = lattice_body({1, 1, 0}, 9, 9, 1, {}, 0.2), rope = lattice_body({1, 1e-9, 0}, 12, 1, 1);
    for (const MeshlessBody* body : {&solid, &sheet, &rope})
        for (const double angle : {0.0, 0.7, 3.1})
            for (const Vec3& shift : {Vec3(0, 0, 0), Vec3(10, -7, 3)}) {
                BodySimulation s = soft(*body, 1e6);
                s.add(make_volume(1e6));
                s.place(moved(*body, turn(angle), shift, 0, 1), Field(4 * body->size(), 0));
                double volume = 0;
                for (const double v : body->volume)
                    volume += v;
                INFO("rank " << int(body->rank[0]) << ", angle " << angle);
                CHECK(whole(s.forces()).lpNorm<Eigen::Infinity>() < 1e-10 * 1e6 * std::pow(volume, 2.0 / 3));
                CHECK(std::abs(s.potential()) < 1e-10 * 1e6 * volume);
            }
}

TEST_CASE("free bodies keep their momentum over 1,000 steps")
{
    BodySimulation s = soft(lattice_body({1, 1, 1}, 5, 5, 5, {}, 0.2), 1e5);
    excite(s);
    const Vec3 p = momentum(s), l = angular_momentum(s);
    const StepReport report = s.advance(1, explicitly(1e-3));
    REQUIRE(report.failure.empty());
    REQUIRE(report.substeps >= 1000);
    CHECK((momentum(s) - p).norm() <= 1e-10 * p.norm());
    CHECK((angular_momentum(s) - l).norm() <= 1e-10 * l.norm());
}

TEST_CASE("the energy of symplectic Euler does not drift over 10,000 steps")
{
    BodySimulation s = soft(lattice_body({1, 1, 1}, 4, 4, 4, {}, 0.2), 1e5);
    excite(s);
    const double start = s.kinetic() + s.potential();
    double early = 0, late = 0;
    int steps = 0;
    for (int block = 0; block < 200; ++block) {
        const StepReport r = s.advance(0.02, explicitly(2e-4));
        REQUIRE(r.failure.empty());
        steps += r.substeps;
        const double off = std::abs(r.kinetic + r.potential - start) / start;
        (block < 50 ? early : late) = std::max(block < 50 ? early : late, off);
    }
    CHECK(steps >= 10000);
    CHECK(late < 0.05);
    CHECK(late < 2 * early + 1e-3); // bounded: it oscillates, and does not grow
}

TEST_CASE("explicit and implicit steps agree as they shrink, each at first order")
{
    const MeshlessBody body = lattice_body({1, 1, 1}, 3, 3, 3, {}, 0.2);
    auto after = [&](const Integration& integration) {
        BodySimulation s = soft(body, 1e4);
        excite(s, 1.05);
        REQUIRE(s.advance(0.1, integration).failure.empty());
        return s.positions();
    };
    const Field reference = after(explicitly(1e-6));
    double last[2] = {0, 0};
    for (const double dt : {4e-4, 2e-4, 1e-4}) {
        const Field e = after(explicitly(dt)), i = after(implicitly(dt));
        const double error[2] = {(whole(e) - whole(reference)).norm(), (whole(i) - whole(reference)).norm()};
        for (int k : {0, 1}) {
            if (last[k] > 0) {
                CHECK(last[k] / error[k] > 1.8);
                CHECK(last[k] / error[k] < 2.3);
            }
            last[k] = error[k];
        }
    }
    CHECK(last[1] < 5e-3 * whole(reference).norm());
}

TEST_CASE("a cantilever bends as Euler and Bernoulli say, at three resolutions, and converges")
{
    const double young = 1e6, gravity = 0.01, height = 0.1, length = 1;
    std::vector<double> ratio;
    for (const int m : {3, 4, 6}) {
        const double cell = height / m;
        MeshlessOptions options;
        options.nearest = 3;
        options.support_factor = 1.3; // neighbours along the lattice's axes
        const MeshlessBody body = lattice_body({length + 2 * cell, height, height}, 10 * m + 2, m, m, options);
        BodySimulation s = soft(body, young);
        s.add(make_gravity({0, 0, -gravity}));
        std::vector<std::uint32_t> held, tip;
        std::vector<Vec3> places;
        const double root = -0.5 * (length + 2 * cell) + 2 * cell; // the beam begins here
        for (std::uint32_t i = 0; i < body.size(); ++i) {
            if (body.rest[i][0] < root) {
                held.push_back(i);
                places.push_back(body.rest[i]);
            } else if (body.rest[i][0] > root + length - cell) {
                tip.push_back(i);
            }
        }
        s.add(fixed_pin(held, places));
        REQUIRE(s.advance(1e4, implicitly(1e4, 1e-9)).failure.empty()); // so long a step is statics
        double down = 0;
        for (const std::uint32_t i : tip)
            down += (body.rest[i][2] - at(s.positions(), i)[2]) / static_cast<double>(tip.size());
        const double inertia = std::pow(height, 4) / 12, load = 1000 * gravity * height * height, x = length - cell / 2;
        ratio.push_back(down /
                        (load * x * x * (6 * length * length - 4 * length * x + x * x) / (24 * young * inertia)));
        CAPTURE(m, ratio.back());
        CHECK(ratio.back() > 0.9);
        CHECK(ratio.back() < 1.1);
    }
    CHECK(std::abs(ratio[2] - ratio[1]) < std::abs(ratio[1] - ratio[0]));
}

TEST_CASE("implicit steps of 1/60 s are stable over four decades of stiffness, and energy never grows without work")
{
    // Size 1 m, density 1000, 550 nodes.
    const MeshlessBody body = lattice_body({1, 1, 1}, 11, 10, 5, {}, 0.2);
    for (const double young : {1e3, 1e4, 1e5, 1e6, 1e7}) {
        BodySimulation s = soft(body, young, 0.35);
        excite(s, 1.3);
        double energy = s.kinetic() + s.potential();
        const double start = energy;
        CAPTURE(young, start);
        for (int step = 0; step < 30; ++step) {
            const StepReport r = s.advance(1.0 / 60, implicitly(1.0 / 60, 1e-3));
            REQUIRE(r.failure.empty());
            REQUIRE(r.substeps == 1); // no cap on the step
            REQUIRE(r.kinetic + r.potential <= energy + 1e-9 * start);
            energy = r.kinetic + r.potential;
        }
        CHECK(energy < start);
    }
}

TEST_CASE("a step of no time changes nothing, and a negative one is refused")
{
    BodySimulation s = soft(lattice_body({1, 1, 1}, 3, 3, 3), 1e4);
    excite(s);
    const Field x = s.positions(), v = s.velocities();
    for (const Integration& integration : {implicitly(0.01), explicitly(0.01)}) {
        CHECK(s.advance(0, integration).substeps == 0);
        CHECK(s.positions() == x);
        CHECK(s.velocities() == v);
        CHECK_THROWS_AS(s.advance(-1, integration), std::invalid_argument);
        CHECK_THROWS_AS(s.advance(NAN, integration), std::invalid_argument);
    }
}

TEST_CASE("a step that cannot be made is reported and keeps the state")
{
    BodySimulation s = soft(lattice_body({1, 1, 1}, 4, 4, 4, {}, 0.2), 1e9);
    excite(s, 1.6);
    const Field x = s.positions(), v = s.velocities();
    Integration hard = implicitly(1, 1e-12);
    hard.most_iterations = 2;
    const StepReport r = s.advance(1, hard);
    CHECK(r.failure.find("2 Newton iterations") != std::string::npos);
    CHECK(s.positions() == x);
    CHECK(s.velocities() == v);
    CHECK(s.time_s() == 0);
    REQUIRE(s.advance(1.0 / 60, implicitly(1.0 / 60, 1e-2)).failure.empty());
}

TEST_CASE("a bar that was held stretched stays longer if it flows, and keeps its volume")
{
    const MeshlessBody body = lattice_body({1, 0.3, 0.3}, 10, 3, 3);
    auto length_after = [&](bool plastic) {
        BodySimulation s = soft(body, 1e5);
        s.add(make_mass_damping(5));
        if (plastic)
            s.add(make_plasticity({0.02, 20, 2}));
        std::vector<std::uint32_t> right, left;
        for (std::uint32_t i = 0; i < body.size(); ++i)
            if (std::abs(body.rest[i][0]) > 0.4)
                (body.rest[i][0] > 0 ? right : left).push_back(i);
        s.add(make_pulling(body, PullingForce{right, {3000, 0, 0}, 0, 1, 0}));
        s.add(make_pulling(body, PullingForce{left, {-3000, 0, 0}, 0, 1, 0}));
        REQUIRE(s.advance(4, implicitly(1.0 / 60, 1e-3)).failure == "");
        for (const Mat3& p : s.plastic_inverse())
            CHECK(p.determinant() == Approx(1).epsilon(1e-9));
        return at(s.positions(), right[0])[0] - at(s.positions(), left[0])[0];
    };
    const double rest = 0.9, elastic = length_after(false), flowed = length_after(true);
    CHECK(elastic == Approx(rest).epsilon(0.01));
    CHECK(flowed > 1.1 * rest);
}

TEST_CASE("a block comes to rest on the ground, and friction stops what slides")
{
    const MeshlessBody body = lattice_body({0.6, 0.4, 0.2}, 6, 4, 2);
    for (const double friction : {0.0, 0.5}) {
        BodySimulation s = soft(body, 1e5);
        s.add(make_gravity({0, 0, -10}));
        s.add(make_viscosity(300));
        Ground ground;
        ground.stiffness = 2e6; // 480 N sink it by 0.24 mm, were all of it to touch
        ground.friction = friction;
        ground.at_nodes = true;
        s.add(make_ground(ground));
        Field x = moved(body, Mat3::Identity(), {0, 0, 0.06}, 0, 1), v = moved(body, Mat3::Zero(), {1, 0, 0}, 0, 1);
        s.place(x, v);
        REQUIRE(s.advance(1.5, implicitly(1.0 / 240, 1e-4)).failure.empty());
        Vec3 moved_by = Vec3::Zero();
        double lowest = 1;
        for (std::size_t i = 0; i < body.size(); ++i) {
            moved_by += (at(s.positions(), i) - body.rest[i]) / static_cast<double>(body.size());
            lowest = std::min(lowest, at(s.positions(), i)[2]);
        }
        CAPTURE(friction, moved_by.transpose(), lowest);
        CHECK(lowest > -0.01);
        CHECK(lowest < 0.001);
        if (friction > 0) {
            CHECK(momentum(s).norm() < 0.02 * 48);          // 48 kg
            CHECK(moved_by[0] == Approx(0.1).margin(0.05)); // v²/(2 μ g)
        } else {
            CHECK(moved_by[0] == Approx(1.5).margin(0.05));
        }
    }
}
