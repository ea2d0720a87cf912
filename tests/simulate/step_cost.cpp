// SPDX-License-Identifier: GPL-3.0-or-later
// Prints the time of one step, in ns, of a body with gravity and elasticity only. Compiled twice: alone, so that no
// other effect is in the program, and with everything that a scene can name (EVERYTHING).
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <vector>

#include "tests/simulate/bodies.hpp"

#ifdef EVERYTHING
#include "toolkit/simulate/simulation.hpp"
#endif

using namespace cinch;

int main()
{
    const MeshlessBody body = test::lattice_body({1, 1, 1}, 8, 8, 8, {}, 0.2);
#ifdef EVERYTHING
    // The same body, by way of a scene.
    std::string places;
    for (const Vec3& p : body.rest) {
        char text[100];
        std::snprintf(text, sizeof text, "%s[%.17g,%.17g,%.17g]", places.empty() ? "" : ",", p[0], p[1], p[2]);
        places += text;
    }
    Simulation simulation(
        parse_scene("{\"duration\":1,\"bodies\":[{\"surface\":\"box\",\"box\":[1,1,1],\"cells\":[1,1,1],\"places\":[" +
                        places + "]}],\"effects\":[{\"effect\":\"gravity\"},{\"effect\":\"elastic\",\"young\":1e4}]}",
                    "scene", "."),
        "scene");
    BodySimulation& s = simulation.bodies()[0].simulation;
    if (s.effects().size() != 2 || simulation.couplings().size() != 0 || effect_names().size() < 10)
        return 1;
#else
    BodySimulation s(body, {});
    s.add(make_gravity({0, 0, -9.81}));
    s.add(make_neo_hookean(1e4, 0.3));
#endif
    Integration integration;
    integration.method = Integration::Method::explicit_euler;
    integration.step_s = 1e-5;
    std::vector<double> ns;
    for (int round = 0; round < 21; ++round) {
        const auto start = std::chrono::steady_clock::now();
        if (s.advance(1e-3, integration).substeps != 100)
            return 1;
        ns.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() * 1e9 / 100);
    }
    std::nth_element(ns.begin(), ns.begin() + 10, ns.end());
    std::printf("%.0f\n", ns[10]);
    return 0;
}
