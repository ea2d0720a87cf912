// SPDX-License-Identifier: GPL-3.0-or-later
// A scene's bodies, simulated, and their proven boxes in every frame: simulated_body SCENE.json
#include <cinch/refit.hpp>
#include <cinch/simulate.hpp>
#include <iostream>

int main(int argc, char** argv)
try {
    cinch::SceneSimulation scene(std::filesystem::path(argc > 1 ? argv[1] : "scene.json"));
    const cinch::DeformableSurface* surface = scene.surface(0);
    if (!surface)
        return 0; // nodes alone
    const cinch::Bvh bvh = build_bvh(*surface, 16);
    cinch::Refitter refit(bvh, *surface, {});
    std::vector<double> supports(bvh.bvs.size() * 6);
    while (scene.frame() + 1 < std::min<std::size_t>(scene.frame_count(), 10)) {
        scene.advance();
        refit(scene.transforms(0), supports);
        const cinch::Aabb box = cinch::Dop(std::span(supports).first(6)).aabb();
        std::cout << scene.time_s() << " s, " << scene.name(0) << ": z from " << box.lower[2] << " to " << box.upper[2]
                  << " m\n";
    }
} catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 2;
}
