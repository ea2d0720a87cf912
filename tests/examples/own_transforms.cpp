// SPDX-License-Identifier: GPL-3.0-or-later
// A surface, weights and transforms of one's own: a flag of two simulation nodes, the right one swinging up, in an
// 18-DOP.
#include <cinch/deform.hpp>
#include <cinch/refit.hpp>
#include <iostream>

int main()
{
    constexpr std::uint32_t columns = 20;
    cinch::TriangleMesh mesh;
    cinch::Influences influences;
    influences.node_count = 2;
    for (std::uint32_t i = 0; i <= columns; ++i)
        for (const double y : {0.0, 1.0}) {
            const double x = static_cast<double>(i) / columns;
            mesh.vertices.push_back({x, y, 0});
            for (const std::uint32_t node : {0u, 1u}) { // any weights: they are normalised
                influences.node.push_back(node);
                influences.weight.push_back(node == 0 ? 1 - x : x);
            }
            influences.row.push_back(static_cast<std::uint32_t>(influences.node.size()));
        }
    for (std::uint32_t i = 0; i < columns; ++i) {
        mesh.triangles.push_back({2 * i, 2 * i + 2, 2 * i + 1});
        mesh.triangles.push_back({2 * i + 1, 2 * i + 2, 2 * i + 3});
    }
    const cinch::DeformableSurface surface{mesh, to_dyadic(influences)};
    const cinch::Bvh bvh = build_bvh(surface, 4);
    cinch::RefitOptions options;
    options.kdop = 18;
    cinch::Refitter refit(bvh, surface, options);

    std::vector<double> supports(bvh.bvs.size() * 18);
    std::vector<cinch::Vec3> vertices(mesh.vertices.size());
    for (const double height : {0.0, 0.5, 1.0}) {
        std::vector<cinch::AffineMap> maps(2, cinch::identity_map);
        maps[1].m[2][3] = height; // z += height
        refit(maps, supports);
        evaluate(mesh.vertices, surface.weights, maps, vertices);
        const cinch::Dop bound{std::span(supports).first(18)};
        for (const cinch::Vec3& v : vertices)
            if (!bound.aabb().contains(v))
                return 1; // never
        std::cout << "z from " << bound.aabb().lower[2] << " to " << bound.aabb().upper[2] << '\n';
    }
}
