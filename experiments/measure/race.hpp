// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "experiments/measure/verdict.hpp"

namespace cinch {

/// Keeps this thread on one core from now on, so that times compare.
void pin_to_one_core();

/// What else the machine did while something was timed.
struct Load {
    double cpu_share = 1; ///< of the time that went by, what this thread had a core for
    double load = 0;      ///< of the machine, its mean over a minute at the end
};
/// A line for people: marks, and the load where there was some.
std::string describe(const Load& load);
/// "~" behind what is not settled.
const char* mark(const Range& range);

/// Nanoseconds per call of each contestant, round by round.
struct RaceTimes : Load {
    std::vector<std::vector<double>> ns; ///< by contestant and round; NaN where it sat one out

    Range of(std::size_t contestant) const;
    /// Over another contestant, in the same rounds: what slows both down shows in neither.
    Range ratio(std::size_t contestant, std::size_t base) const;

private:
    Range known(std::vector<double> values) const;
};

/// They take turns in short batches, so that a change of the machine's speed meets all of them alike; measured in time
/// of this thread on a core, so that other processes that take it away do not count. For calls that use this thread
/// alone. Together about `seconds` long; each runs at least five batches, and those of which one takes
/// long not many more. Throws Interrupted between batches.
RaceTimes race(const std::vector<std::function<void()>>& contestants, double seconds);

/// Slope of log(ns) over log(size), least squares.
double log_slope(const std::vector<double>& size, const std::vector<double>& ns);

/// A figure with its target, for people: "what  measured  target  reached".
struct Figure {
    std::string what, measured, target;
    Verdict verdict;

    Figure(std::string name, std::string value, std::string aim, Verdict is)
        : what(std::move(name)), measured(std::move(value)), target(std::move(aim)), verdict(is)
    {
    }
    /// Of what is exact.
    Figure(std::string name, std::string value, std::string aim, bool reached)
        : Figure(std::move(name), std::move(value), std::move(aim), reached ? Verdict::holds : Verdict::fails)
    {
    }
};
/// Its record: "reached" is null where that is not known.
nlohmann::ordered_json record_of(const Figure& figure, const char* experiment);
void print(const std::vector<Figure>& figures);

} // namespace cinch
