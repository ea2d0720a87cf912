// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "experiments/collide/backend.hpp"
#include "experiments/measure/verdict.hpp"

namespace cinch {

/// What one backend did on a scene. On one thread times are those that the process had a core for, so that other
/// processes that take it away do not count. Times are medians over the frames, each frame's the median over the
/// rounds.
struct Measured {
    std::string backend;
    double evaluate_ms = 0, update_ms = 0, query_ms = 0, total_ms = 0;
    double total_ms_low = 0, total_ms_high = 0; ///< of the rounds, each one's median over its frames
    double pairs = 0;                           ///< median per frame
    std::size_t frames = 0;                     ///< measured
    std::size_t frames_wanted = 0, rounds = 0,
                rounds_wanted =
                    0; ///< more than measured after an interrupt; a slow backend wants one round, of every fourth frame

    Range total() const { return {total_ms, total_ms_low, total_ms_high}; }
    bool is_complete() const { return frames == frames_wanted && rounds == rounds_wanted; }
    std::size_t differing = 0; ///< pairs that only it or only the first backend found, over all frames
    double megabytes = 0;      ///< per body
    bool counts = false;
    QueryCounts sums;                                   ///< over all frames, if it counts
    std::vector<double> total_of_frame, pairs_of_frame; ///< ms
};

struct MeasureOptions {
    std::size_t rounds = 3; ///< through all frames, backends taking turns; slow ones once through every fourth of many
    int threads = 1;        ///< one: on one core
    bool cold = false;      ///< evict the caches before every frame
};

/// Every backend in turn through all frames of the scene. Pairs are compared with those of the first backend, frame by
/// frame. An interrupt leaves the whole frames of the backends that have some; before there are any, Interrupted is
/// thrown.
std::vector<Measured> measure(const CollideScene& scene, const std::vector<BackendKind>& kinds,
                              const MeasureOptions& options);

} // namespace cinch
