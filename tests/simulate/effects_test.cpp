// SPDX-License-Identifier: GPL-3.0-or-later
// Forces are the derivatives of energies, second derivatives those of forces, and effects that are not named are not
// there.
#include <catch2/catch.hpp>

#include <functional>

#include <Eigen/Geometry>

#include "tests/simulate/bodies.hpp"
#include "toolkit/simulate/contact_points.hpp"

using namespace cinch;
using test::lattice_body;
using test::moved;

namespace {

struct Named {
    std::string name;
    std::function<std::unique_ptr<Effect>(const MeshlessBody&)> make;
};

std::vector<std::uint32_t> some(const MeshlessBody& body)
{
    std::vector<std::uint32_t> nodes;
    for (std::uint32_t i = 0; i < body.size(); i += 3)
        nodes.push_back(i);
    return nodes;
}

const std::vector<Named> conservative = {
    {"gravity",
     [](const MeshlessBody&) {
         return make_gravity({1, -2, 3});
     }},
    {"pulling force",
     [](const MeshlessBody& b) {
         return make_pulling(b, PullingForce{some(b), {3, 2, 1}, 0, 10, 0});
     }},
    {"pulling target",
     [](const MeshlessBody& b) {
         return make_pulling(
             b, PullingTarget{some(b), 70, [](std::size_t k, double) { return Vec3(0.1 * double(k), 0, 1); }});
     }},
    {"neo-Hookean", [](const MeshlessBody&) { return make_neo_hookean(1000, 0.3); }},
    {"neo-Hookean, nearly incompressible", [](const MeshlessBody&) { return make_neo_hookean(1000, 0.49); }},
    {"neo-Hookean, auxetic", [](const MeshlessBody&) { return make_neo_hookean(1000, -0.8); }},
    {"StVK", [](const MeshlessBody&) { return make_stvk(1000, 0.3, false); }},
    {"StVK of the paper", [](const MeshlessBody&) { return make_stvk(1000, 0.3, true); }},
    {"volume", [](const MeshlessBody&) { return make_volume(500); }},
    {"hourglass", [](const MeshlessBody& b) { return make_hourglass(b, 0.7, 1000); }},
    {"ground",
     [](const MeshlessBody&) {
         return make_ground({Vec3(0, 0, 0.1), Vec3(0.3, 0, 1), 900, 0, true});
     }},
};

const std::vector<Named> dissipative = {
    {"viscosity", [](const MeshlessBody&) { return make_viscosity(30); }},
    {"damping", [](const MeshlessBody&) { return make_mass_damping(4); }},
};

Mat3 twisted()
{
    Mat3 a = Eigen::AngleAxisd(0.8, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    a.col(0) *= 1.3;
    a(0, 1) += 0.4;
    return a;
}

// A body on which one effect acts, at a place that is not special.
BodySimulation with(const MeshlessBody& body, const Named& named, bool remember)
{
    BodySimulation s(body, {});
    s.add(named.make(body));
    if (remember) { // what dissipates needs a step to have begun
        Integration integration;
        integration.method = Integration::Method::explicit_euler;
        integration.step_s = 1e-5;
        Field v = moved(body, Mat3::Identity(), Vec3::Zero(), 0.5, 3);
        s.place(moved(body, Mat3::Identity(), Vec3::Zero(), 0.01, 2), v);
        REQUIRE(s.advance(1e-5, integration).failure.empty());
    }
    return s;
}

double energy(BodySimulation& s, const Field& x)
{
    // potential() leaves out what dissipates; the effect itself does not.
    return test::energy_at(s, 0, x);
}

Field forces_at(BodySimulation& s, const Field& x)
{
    const Field keep = s.positions(), v(x.size(), 0);
    s.place(x, v);
    const Field f = s.forces();
    s.place(keep, v);
    return f;
}

void check_forces(const MeshlessBody& body, const Named& named, bool remember)
{
    INFO(named.name);
    BodySimulation s = with(body, named, remember);
    for (const double noise : {0.02, 0.15}) {
        const Field x = moved(body, twisted(), {0.1, 0.2, -0.05}, noise * 0.3, 7);
        const Field f = forces_at(s, x);
        double scale = whole(f).norm();
        for (std::size_t k = 0; k < f.size(); k += 5) {
            if (k % 4 == 3)
                continue;
            const double h = 1e-5;
            auto moved_by = [&](double d) {
                Field y = x;
                y[k] += d;
                return energy(s, y);
            };
            const double slope = (8 * (moved_by(h) - moved_by(-h)) - (moved_by(2 * h) - moved_by(-2 * h))) / (12 * h);
            REQUIRE(std::abs(f[k] + slope) <= 1e-6 * scale);
        }
    }
}

} // namespace

TEST_CASE("forces of every effect are the derivatives of its energy")
{
    const MeshlessBody solid = lattice_body({1, 0.8, 0.6}, 4, 3, 3, {}, 0.2), sheet = lattice_body({1, 1, 0}, 5, 5, 1),
                       rope = lattice_body({1, 1e-9, 0}, 6, 1, 1);
    REQUIRE(solid.deficient.empty());
    REQUIRE(sheet.rank[12] == 2);
    REQUIRE(rope.rank[3] == 1);
    for (const MeshlessBody* body : {&solid, &sheet, &rope}) {
        INFO("rank " << int(body->rank[0]));
        for (const Named& named : conservative)
            check_forces(*body, named, false);
        for (const Named& named : dissipative)
            check_forces(*body, named, true);
    }
}

TEST_CASE("second derivatives of every effect are the derivatives of its forces")
{
    const MeshlessBody solid = lattice_body({1, 0.8, 0.6}, 4, 3, 3, {}, 0.2), sheet = lattice_body({1, 1, 0}, 5, 5, 1),
                       rope = lattice_body({1, 1e-9, 0}, 6, 1, 1);
    for (const MeshlessBody* body : {&solid, &sheet, &rope}) {
        std::vector<Named> all = conservative;
        all.insert(all.end(), dissipative.begin(), dissipative.end());
        for (std::size_t k = 0; k < all.size(); ++k) {
            INFO(all[k].name << ", rank " << int(body->rank[0]));
            BodySimulation s = with(*body, all[k], k >= conservative.size());
            const Field x = moved(*body, twisted(), {0.1, 0.2, -0.05}, 0.02, 7),
                        p = moved(*body, Mat3::Zero(), Vec3::Zero(), 1, 11);
            auto at_step = [&](double h) {
                Field y = x;
                whole(y) += h * whole(p);
                return forces_at(s, y);
            };
            const double h = 1e-6;
            const Field more = at_step(h), less = at_step(-h);
            const Field v(x.size(), 0);
            s.place(x, v);
            const Field product = s.stiffness(p);
            const Eigen::VectorXd difference = (whole(more) - whole(less)) / (2 * h) + whole(product);
            CHECK(difference.norm() <= 1e-6 * (whole(product).norm() + whole(more).norm()));
            // Symmetric, as second derivatives are.
            const Field q = moved(*body, Mat3::Zero(), Vec3::Zero(), 1, 12);
            CHECK(whole(q).dot(whole(product)) ==
                  Approx(whole(p).dot(whole(s.stiffness(q)))).epsilon(1e-9).margin(1e-9 * whole(product).norm()));
        }
    }
}

TEST_CASE("a nearly flat neighbourhood is at rest at rest, and under rotations")
{
    MeshlessBody body =
        lattice_body({1, 1, 1e-4}, 6, 6, 1, {}, 0.3); // out of plane by 3e-5: below the rank's threshold
    REQUIRE(body.rank[10] == 2);
    BodySimulation s(body, {});
    s.add(make_neo_hookean(1000, 0.3));
    s.add(make_hourglass(body, 1, 1000));
    const Mat3 r = Eigen::AngleAxisd(2.1, Vec3(1, -1, 2).normalized()).toRotationMatrix();
    CHECK(whole(forces_at(s, moved(body, r, {1, 2, 3}, 0, 1))).lpNorm<Eigen::Infinity>() < 1e-10 * 1000 * 0.01);
}

TEST_CASE("forces on a surface go to the nodes with their power")
{
    const MeshlessBody body = lattice_body({1, 1, 1}, 3, 3, 3, {}, 0.2);
    DeformableSurface surface;
    surface.mesh.vertices = {{0.3, 0.4, 0.5}};
    surface.mesh.triangles = {{0, 0, 0}};
    surface.weights.node_count = 27;
    surface.weights.row = {0, 2};
    surface.weights.node = {3, 17};
    surface.weights.weight = {0.25, 0.75};
    const Field x = moved(body, twisted(), {0.1, 0.2, 0.3}, 0.05, 3),
                dx = moved(body, Mat3::Zero(), Vec3::Zero(), 1, 4);
    MatrixField g(12 * body.size()), dg = g, stress(g.size(), 0);
    gather_gradients(lists_of(body), x, g);
    gather_gradients(lists_of(body), dx, dg);
    const std::vector<Mat3> no_plasticity;
    const Reference reference;
    const Configuration c{body, &surface, reference, x, x, g, g, g, no_plasticity};
    Field force(x.size(), 0);
    std::vector<double> spring;
    const Vec3 f(1, -2, 0.5);
    const ContactPoints points;
    points.add_force(c, 0, f, {force, stress, spring});
    scatter_stresses(lists_of(body), stress, {}, x, force);
    CHECK(whole(force).dot(whole(dx)) == Approx(f.dot(points.change(c, 0, dx, dg))).epsilon(1e-12));
    CHECK((test::total(force) - f).norm() < 1e-12);
    // The map is linear in X: place(x + dx) − place(x) = change(dx), as the nodes are of full rank.
    Field y = x;
    whole(y) += whole(dx);
    MatrixField gy(g.size());
    gather_gradients(lists_of(body), y, gy);
    const Configuration there{body, &surface, reference, y, y, gy, gy, gy, no_plasticity};
    CHECK((points.place(there, 0) - points.place(c, 0) - points.change(c, 0, dx, dg)).norm() < 1e-12);
}

TEST_CASE("effects store nothing before they remember, and J is only computed where one needs it")
{
    const MeshlessBody body = lattice_body({1, 1, 1}, 3, 3, 3);
    BodySimulation s(body, {});
    s.add(make_gravity({0, 0, -1}));
    Integration integration;
    REQUIRE(s.advance(0.1, integration).failure.empty());
    CHECK(s.shared_seconds() == 0); // gravity alone: no J
    CHECK(s.cost(0).calls > 0);
    s.add(make_neo_hookean(1000, 0.3));
    REQUIRE(s.advance(0.1, integration).failure.empty());
    CHECK(s.shared_seconds() > 0);
    CHECK(s.cost(1).calls > 0);
    CHECK(s.plastic_inverse().empty());
    for (const Memory& memory : s.state().memory)
        CHECK(memory.values.empty());
}
