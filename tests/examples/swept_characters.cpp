// SPDX-License-Identifier: GPL-3.0-or-later
// Two characters over steps of a clip: leaves that may touch at any time of a step, for continuous collision.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "cinch/collider.hpp"
#include "cinch/io.hpp"

int main(int argc, char** argv)
try {
    const cinch::Character character =
        cinch::read_gltf(argc > 1 ? argv[1] : "character.glb", cinch::Coverage::whole, cinch::Morphs::read);
    const cinch::DeformableSurface surface = cinch::surface_of(character);
    const cinch::Bvh bvh = cinch::build_bvh(surface, 16);
    const auto& clip = character.animations.empty() ? character.rest : character.animations[0];
    cinch::ClipBounder bound(character, clip, surface, bvh);
    const double step = (clip.last_s - clip.first_s) / 10, apart = argc > 2 ? std::atof(argv[2]) : 1;

    std::vector<double> here(6 * bvh.bvs.size()), there = here;
    for (int i = 0; i < 10; ++i) {
        const double t0 = clip.first_s + i * step, t1 = i == 9 ? clip.last_s : t0 + step;
        bound(t0, t1, here); // every vertex, at every time from t0 to t1
        for (std::size_t bv = 0; bv < bvh.bvs.size(); ++bv) {
            std::copy_n(&here[6 * bv], 6, &there[6 * bv]);
            // The other one stands so far along x; sums are rounded up, as a bound −x is one against x.
            there[6 * bv] = std::nextafter(there[6 * bv] + apart, HUGE_VAL);
            there[6 * bv + 1] = std::nextafter(there[6 * bv + 1] - apart, HUGE_VAL);
        }
        const cinch::SweptBody bodies[] = {{&bvh, here}, {&bvh, there}};
        std::printf("%.3f to %.3f s: %zu pairs of leaves\n", t0, t1, cinch::swept_leaf_pairs(bodies).size());
    }
} catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
}
