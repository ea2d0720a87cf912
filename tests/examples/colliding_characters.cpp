// SPDX-License-Identifier: GPL-3.0-or-later
// Two characters that play the same clip side by side: which of their triangles intersect, and when.
// colliding_characters FILE.glb DISTANCE
#include <cinch/collider.hpp>
#include <cinch/io.hpp>
#include <cstdlib>
#include <iostream>

int main(int argc, char** argv)
try {
    const cinch::Character character = cinch::read_gltf(argc > 1 ? argv[1] : "character.glb");
    const double distance = argc > 2 ? std::atof(argv[2]) : 0.1;
    const cinch::DeformableSurface surface = surface_of(character);

    cinch::Collider collider;
    const cinch::BodyId left = collider.add(surface), right = collider.add(surface);

    const auto& animation = character.animations.empty() ? character.rest : character.animations[0];
    const cinch::Clip clip = sample(character, animation, 10);
    for (std::size_t f = 0; f < clip.frame_count(); ++f) {
        const std::vector<cinch::AffineMap> here = clip.frame(f);
        std::vector<cinch::AffineMap> beside = here;
        for (cinch::AffineMap& map : beside)
            map.m[0][3] += distance;
        const cinch::BodyFrame frames[] = {{here}, {beside}};
        collider.update(frames);
        const std::vector<cinch::TrianglePair> pairs = collider.pairs(); // exact, and always in the same order
        std::cout << clip.time_s(f) << " s: " << pairs.size() << " pairs of bodies " << left << " and " << right
                  << '\n';
    }
} catch (const cinch::InputError& error) {
    std::cerr << error.what() << '\n';
    return 2;
}
