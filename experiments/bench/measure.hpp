// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace cinch::bench {

/// Median seconds of one call, over repetitions that last about `total_seconds` together (at least three).
double median_seconds(const std::function<void()>& call, double total_seconds = 1);

struct Child {
    int status = 0; ///< exit status, or 128 + signal
    double seconds = 0;
    double peak_mb = 0; ///< largest resident size
    std::string out;
};
/// Runs a program and waits; its standard output is kept, standard error passed on. Killed after `limit_seconds`.
Child run(const std::vector<std::string>& command, double limit_seconds);
/// Runs a function in a process of its own, for its peak memory.
Child run(const std::function<void()>& call);

/// One line of a benchmark: what was measured, and whether it reaches its target.
struct Figure {
    std::string what, measured, target;
    bool reached;
};
void print(const std::vector<Figure>& figures);

int exact(const std::string& program);

} // namespace cinch::bench
