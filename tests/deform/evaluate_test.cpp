// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include "cinch/deform.hpp"
#include "tests/support.hpp"

using namespace cinch;

TEST_CASE("evaluation follows Eq. 3 and identity maps leave vertices within rounding")
{
    const test::Example e = test::example(500, 20);
    const auto& mesh = e.surface.mesh;
    std::vector<Vec3> out(mesh.vertices.size());
    const std::vector<AffineMap> identity(20, identity_map);
    evaluate(mesh.vertices, e.surface.weights, identity, out);
    for (std::size_t k = 0; k < out.size(); ++k)
        REQUIRE((out[k] - mesh.vertices[k]).norm() <= 1e-14);

    evaluate(mesh.vertices, e.surface.weights, e.frames[2], out);
    for (std::size_t k = 0; k < out.size(); ++k) {
        Vec3 sum = Vec3::Zero();
        const Weights::Row row = e.surface.weights.of(k);
        for (std::size_t i = 0; i < row.node.size(); ++i) {
            const auto& m = e.frames[2][row.node[i]].m;
            for (int r = 0; r < 3; ++r)
                sum[r] += row.weight[i] * (Vec3(m[r][0], m[r][1], m[r][2]).dot(mesh.vertices[k]) + m[r][3]);
        }
        REQUIRE((out[k] - sum).norm() <= 1e-13);
        REQUIRE(out[k] == evaluate_vertex(mesh.vertices[k], row, e.frames[2]));
    }
}
