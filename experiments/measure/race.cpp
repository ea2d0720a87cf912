// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/measure/race.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ctime>

#include <fmt/format.h>
#include <sched.h>

#include "experiments/report/interrupt.hpp"

namespace cinch {
namespace {

// What this thread has had a core for.
double seconds_on_core()
{
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double timed(const std::function<void()>& call, std::size_t times)
{
    const double start = seconds_on_core();
    for (std::size_t i = 0; i < times; ++i)
        call();
    return seconds_on_core() - start;
}

} // namespace

void pin_to_one_core()
{
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(std::max(0, sched_getcpu()), &one);
    sched_setaffinity(0, sizeof one, &one);
}

std::string describe(const Load& load)
{
    return fmt::format("Times are medians over rounds, in time on a core; ~: the quartiles are over 10 % apart.\n"
                       "The machine's load was {:.1f}; this measurement had a core for {:.0f} % of its time.",
                       load.load, 100 * load.cpu_share);
}

const char* mark(const Range& range) { return range.is_settled() ? "" : "~"; }

Range RaceTimes::ratio(std::size_t contestant, std::size_t base) const
{
    std::vector<double> ratios;
    for (std::size_t r = 0; r < ns[contestant].size(); ++r)
        ratios.push_back(ns[contestant][r] / ns[base][r]);
    return range_of(std::move(ratios));
}

RaceTimes race(const std::vector<std::function<void()>>& contestants, double seconds)
{
    constexpr double batch = 1e-3;
    const auto start = std::chrono::steady_clock::now();
    const double start_on_core = seconds_on_core();
    std::vector<std::size_t> times;
    double round = 0; // seconds for one batch of everyone
    for (const auto& call : contestants) {
        throw_if_interrupted();
        call(); // warm
        const double once = std::max(timed(call, 1), 1e-9);
        times.push_back(std::max<std::size_t>(1, static_cast<std::size_t>(batch / once)));
        round += once * static_cast<double>(times.back());
    }
    const auto rounds = std::max<std::size_t>(3, static_cast<std::size_t>(seconds / round));
    RaceTimes out;
    out.ns.resize(contestants.size());
    for (std::size_t r = 0; r < rounds; ++r)
        for (std::size_t i = 0; i < contestants.size(); ++i) {
            throw_if_interrupted();
            out.ns[i].push_back(1e9 * timed(contestants[i], times[i]) / static_cast<double>(times[i]));
        }
    const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    out.cpu_share = std::min(1.0, (seconds_on_core() - start_on_core) / wall);
    if (getloadavg(&out.load, 1) != 1)
        out.load = 0;
    return out;
}

double log_slope(const std::vector<double>& size, const std::vector<double>& ns)
{
    double sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (std::size_t i = 0; i < size.size(); ++i) {
        const double x = std::log(size[i]), y = std::log(ns[i]);
        sx += x;
        sy += y;
        sxx += x * x;
        sxy += x * y;
    }
    const double n = static_cast<double>(size.size());
    return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

nlohmann::ordered_json record_of(const Figure& f, const char* experiment)
{
    nlohmann::ordered_json reached;
    if (f.verdict == Verdict::holds || f.verdict == Verdict::fails)
        reached = f.verdict == Verdict::holds;
    return {{"experiment", experiment}, {"figure", f.what},    {"measured", f.measured},
            {"target", f.target},       {"reached", reached}, {"verdict", name_of(f.verdict)}};
}

void print(const std::vector<Figure>& figures)
{
    for (const Figure& f : figures)
        fmt::print("{:<44} {:>7}  target {:<7} {}\n", f.what, f.measured, f.target,
                   said_of_target(f.verdict));
}

} // namespace cinch
