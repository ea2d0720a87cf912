// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/view.hpp"

namespace cinch {

std::vector<ViewRequest> report_views()
{
    ViewRequest brain;
    brain.scene = "brain-pull";
    brain.title = "Fig. 1: a brain, pulled";
    brain.text = "30,000 vertices follow 509 simulation nodes. The outer box is the bound, in time linear in the "
                 "nodes; the inner one is the vertices' own. "
                 "Deeper levels have smaller boxes, and more axes make k-DOPs of them.";
    brain.levels = 7;
    brain.kdop = 26;
    brain.bits = 14;
    brain.level = 0;
    brain.time = 0.6; // the pull is at its end
    brain.surface = "glass";
    brain.show_nodes = true;
    brain.azimuth = -55; // the pull goes to the right
    brain.elevation = 14;
    ViewRequest ring;
    ring.scene = "santa-ring-6";
    ring.title = "Fig. 6: six bodies on a ring";
    ring.text = "A ring that swings holds them at their tops. Triangles that intersect are red.";
    ring.levels = 5;
    ring.kdop = 14;
    ring.bits = 14;
    ring.level = 1;
    ring.time = 0.55;
    ViewRequest fishes;
    fishes.scene = "fishes";
    fishes.title = "Fig. 7: 24 fish";
    fishes.text = "They have 192,000 vertices that follow 2,304 simulation nodes. Triangles that intersect are red.";
    fishes.frames = 24;
    fishes.levels = 5;
    fishes.bits = 14;
    fishes.methods = {Method::best, Method::limited, Method::eq12, Method::sphere, Method::convex};
    fishes.level = 0;
    fishes.elevation = 45;
    return {brain, ring, fishes};
}

} // namespace cinch
