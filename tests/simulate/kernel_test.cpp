// SPDX-License-Identifier: GPL-3.0-or-later
// The kernels of the simulation give the same bits on every instruction set, and what the formulas say.
#include <catch2/catch.hpp>

#include "tests/simulate/bodies.hpp"
#include "toolkit/deform/kernel/targets.hpp"

using namespace cinch;
using test::lattice_body;
using test::moved;

namespace {

struct Results {
    Field force;
    MatrixField gradient;
    double energy, kinetic;
    Field positions;

    bool operator==(const Results&) const = default;
};

Results all_of(const MeshlessBody& body)
{
    Results r;
    Mat3 a;
    a << 1.1, 0.2, 0, -0.1, 0.9, 0.3, 0.05, 0, 1.2;
    const Field x = moved(body, a, {3, -2, 1}, 0.05, 3), v = moved(body, Mat3::Zero(), {0, 0, 1}, 1, 4);
    r.gradient.resize(12 * body.size());
    gather_gradients(lists_of(body), x, r.gradient);
    BodySimulation s(body, {});
    s.add(make_neo_hookean(1e4, 0.3));
    s.add(make_hourglass(body, 1, 1e4));
    s.place(x, v);
    r.force = s.forces();
    r.energy = s.potential();
    for (const auto method : {Integration::Method::explicit_euler, Integration::Method::implicit_euler}) {
        Integration integration;
        integration.method = method;
        integration.step_s = 0.01;
        REQUIRE(s.advance(0.02, integration).failure.empty());
    }
    r.positions = s.positions();
    r.kinetic = s.kinetic();
    return r;
}

} // namespace

TEST_CASE("simulation kernels: the same bits on every target")
{
    for (const MeshlessBody& body : {lattice_body({1, 1, 1}, 5, 4, 3, {}, 0.2), lattice_body({1, 1, 0}, 5, 5, 1),
                                     lattice_body({1, 1, 1}, 1, 1, 1)}) {
        const Results best = all_of(body);
        REQUIRE(kernel_targets().size() >= 2);
        for (const std::string& target : kernel_targets()) {
            INFO(target);
            REQUIRE(force_kernel_target(target));
            const bool same = all_of(body) == best;
            force_kernel_target("");
            CHECK(same);
        }
    }
}

TEST_CASE("gradients and their transpose are what the sums say")
{
    const MeshlessBody body = lattice_body({1, 1, 1}, 5, 4, 3, {}, 0.2);
    const Field x = moved(body, Mat3::Identity(), Vec3::Zero(), 0.2, 5);
    MatrixField g(12 * body.size()), s = moved(lattice_body({1, 1, 1}, 15, 4, 3), Mat3::Zero(), Vec3::Zero(), 1, 6);
    gather_gradients(lists_of(body), x, g);
    std::vector<double> spring(body.size());
    for (std::size_t i = 0; i < spring.size(); ++i)
        spring[i] = 0.1 * double(i);
    Field f(4 * body.size(), 0), expected = f;
    scatter_stresses(lists_of(body), s, spring, x, f);
    for (std::size_t i = 0; i < body.size(); ++i) {
        Mat3 sum = Mat3::Zero();
        for (std::uint32_t e = body.row[i]; e < body.row[i + 1]; ++e) {
            const std::uint32_t j = body.neighbour[e];
            const Vec3 d = body.d(e), offset = at(x, j) - at(x, i);
            sum += offset * d.transpose();
            const Vec3 t = matrix_at(s, i) * d - spring[i] * body.kernel(e) * offset;
            at(expected, j) += t;
            at(expected, i) -= t;
        }
        CHECK((sum - matrix_at(g, i)).norm() < 1e-13);
    }
    CHECK((whole(f) - whole(expected)).norm() < 1e-12 * whole(f).norm());
    CHECK(test::total(f).norm() < 1e-12 * whole(f).norm());
    // Affine motions are reproduced exactly where the neighbours span space.
    Mat3 a;
    a << 1, 2, 3, 0, 1, -1, 2, 0, 1;
    gather_gradients(lists_of(body), moved(body, a, {5, 6, 7}, 0, 1), g);
    for (std::size_t i = 0; i < body.size(); ++i)
        CHECK((matrix_at(g, i) - a).norm() < 1e-12);
}
