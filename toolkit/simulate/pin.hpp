// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "toolkit/surface/triangle_mesh.hpp"

namespace cinch {

/// Nodes whose places are prescribed; they are left out of what an integrator solves.
struct Pin {
    std::vector<std::uint32_t> nodes;
    std::function<Vec3(std::size_t place_in_nodes, double time_s)> path; ///< m, seen from `origin`
    std::function<double(double from_s, double to_s)>
        turn;                   ///< greatest angle, rad, that it turns by; integrators make steps of at most 0.4
    Vec3 origin = Vec3::Zero(); ///< m
};

/// Turning about an axis by angle(t): ω (t − ramp/2), with a smooth start over `ramp_s`, until `most`, rad, is reached
/// (0: for ever); or swinging, most · sin(2π t / period).
struct Turning {
    Vec3 centre = Vec3::Zero(), axis = Vec3::UnitZ();    ///< m; of any length but 0
    double rate = 0, ramp_s = 0, most = 0, period_s = 0; ///< rad/s, s, rad, s

    double angle(double time_s) const;
    Vec3 apply(const Vec3& p, double time_s) const;
};

/// `start`: the places at time 0.
Pin fixed_pin(std::vector<std::uint32_t> nodes, std::vector<Vec3> start);
Pin turning_pin(std::vector<std::uint32_t> nodes, std::vector<Vec3> start, const Turning& turning);
/// Moving with `velocity`, m/s, until `end_s`.
Pin sliding_pin(std::vector<std::uint32_t> nodes, std::vector<Vec3> start, const Vec3& velocity, double end_s);

} // namespace cinch
