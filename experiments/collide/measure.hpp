// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "experiments/collide/backend.hpp"

namespace cinch {

/// What one backend did on a scene. Times are medians over the frames, each frame's the median over the rounds.
struct Measured {
    std::string backend;
    double evaluate_ms = 0, update_ms = 0, query_ms = 0, total_ms = 0;
    double pairs = 0;            ///< median per frame
    std::size_t frames = 0;      ///< measured; fewer than the scene's after an interrupt
    std::size_t differing = 0;   ///< pairs that only it or only the first backend found, over all frames
    std::size_t megabytes_x10 = 0;
    bool counts = false;
    QueryCounts sums;            ///< over all frames, if it counts
    std::vector<double> total_of_frame; ///< ms
};

struct MeasureOptions {
    std::size_t rounds = 3;  ///< through all frames, backends taking turns; slow ones run once
    bool cold = false;       ///< evict the caches before every frame
    double slow_ms = 100;    ///< a frame of a slow one
};

/// Every backend in turn through all frames of the scene, one thread. Pairs are compared with those of the first backend, frame by frame.
std::vector<Measured> measure(const CollideScene& scene, const std::vector<BackendKind>& kinds, const MeasureOptions& options);

} // namespace cinch
