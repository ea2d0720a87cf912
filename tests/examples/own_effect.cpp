// SPDX-License-Identifier: GPL-3.0-or-later
// A force of one's own: a wind that blows on a box of jelly, which slides away with it.
#include <cinch/simulate.hpp>
#include <iostream>

class Wind : public cinch::OwnForce { // U = −Σ m a·X
public:
    explicit Wind(const cinch::Vec3& acceleration) : acceleration_(acceleration) {}
    double energy(const Nodes& nodes) const override
    {
        double sum = 0;
        for (std::size_t i = 0; i < nodes.mass.size(); ++i)
            sum -= nodes.mass[i] * acceleration_.dot(nodes.position[i]);
        return sum;
    }
    void add(const Nodes& nodes, std::span<cinch::Vec3> force) const override
    {
        for (std::size_t i = 0; i < nodes.mass.size(); ++i)
            force[i] += nodes.mass[i] * acceleration_;
    }

private:
    cinch::Vec3 acceleration_; // m/s²
};

int main()
try {
    cinch::SceneSimulation scene(R"({
        "name": "jelly", "duration": 0.5,
        "bodies": [{"name": "box", "surface": "box", "box": [1, 1, 1], "cells": [2, 2, 2], "lattice": [4, 4, 4]}],
        "effects": [{"effect": "elastic", "young": 1e4}]
    })",
                                 "jelly", ".");
    scene.add(0, std::make_unique<Wind>(cinch::Vec3(2, 0, 0)));
    while (scene.frame() + 1 < scene.frame_count())
        scene.advance();
    const cinch::AffineMap map = scene.transforms(0)[0]; // where it takes the first node's surroundings
    const double moved = map.m[0][3];
    std::cout << "after " << scene.time_s() << " s the wind has moved the box by " << moved << " m\n";
    return moved > 0.2 && moved < 0.3 ? 0 : 1; // ½ a t² = 0.25 m
} catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 2;
}
