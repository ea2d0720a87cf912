// SPDX-License-Identifier: GPL-3.0-or-later
// Proven boxes of a character's clips, each for all times: character_bounds FILE.glb
#include <cinch/io.hpp>
#include <iostream>

int main(int argc, char** argv)
try {
    const cinch::Character character =
        cinch::read_gltf(argc > 1 ? argv[1] : "character.glb", cinch::Coverage::whole, cinch::Morphs::read);
    const cinch::DeformableSurface surface = surface_of(character);
    const cinch::Bvh bvh = build_bvh(surface, 4); // at most 4 triangles per leaf
    std::vector<double> supports(bvh.bvs.size() * 6);
    for (const cinch::Character::Animation& clip : character.animations) {
        cinch::ClipBounder bound(character, clip, surface, bvh);
        bound(clip.first_s, clip.last_s, supports);                              // all BVs, at every real time between
        const cinch::Aabb box = cinch::Dop(std::span(supports).first(6)).aabb(); // of the root
        std::cout << clip.name << ": " << box.lower.transpose() << " to " << box.upper.transpose() << '\n';
    }
} catch (const cinch::InputError& error) {
    std::cerr << error.what() << '\n';
    return 2;
}
