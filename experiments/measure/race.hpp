// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace cinch {

/// Keeps this thread on one core from now on, so that times compare.
void pin_to_one_core();

/// Median nanoseconds per call of each contestant. They take turns in short batches, so that a change of the machine's
/// speed meets all of them alike. Together about `seconds` long; each runs at least three batches. Throws Interrupted
/// between batches.
std::vector<double> race(const std::vector<std::function<void()>>& contestants, double seconds);

/// Slope of log(ns) over log(size), least squares.
double log_slope(const std::vector<double>& size, const std::vector<double>& ns);

/// A figure with its target, for people: "what  measured  target  reached".
struct Figure {
    std::string what, measured, target;
    bool reached = false;
};
void print(const std::vector<Figure>& figures);

} // namespace cinch
