// SPDX-License-Identifier: GPL-3.0-or-later
// Proven boxes of a skinned character, frame by frame: character_frames FILE.glb
#include <cinch/io.hpp>
#include <cinch/refit.hpp>
#include <iostream>

int main(int argc, char** argv)
try {
    const cinch::Character character = cinch::read_gltf(argc > 1 ? argv[1] : "character.glb");
    const cinch::DeformableSurface surface = surface_of(character);
    const cinch::Bvh bvh = build_bvh(surface, 16); // at most 16 triangles per leaf
    cinch::Refitter refit(bvh, surface, {});       // the default method, in float, 6 directions

    const auto& animation = character.animations.empty() ? character.rest : character.animations[0];
    const cinch::Clip clip = sample(character, animation, 30); // 30 frames per second
    std::vector<double> supports(bvh.bvs.size() * 6);
    for (std::size_t f = 0; f < clip.frame_count(); ++f) {
        refit(clip.frame(f), supports);
        const cinch::Aabb box = cinch::Dop(std::span(supports).first(6)).aabb(); // of the root; every BV has its own
        std::cout << clip.time_s(f) << " s: " << box.lower.transpose() << " to " << box.upper.transpose() << '\n';
    }
} catch (const cinch::InputError& error) {
    std::cerr << error.what() << '\n';
    return 2;
}
