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

Range RaceTimes::known(std::vector<double> values) const
{
    std::erase_if(values, [](double x) { return std::isnan(x); });
    const Range range = range_of(std::move(values));
    // Where others had the core, or its other half, caches and units were shared with them: what is known then is known
    // to a tenth at best.
    const double disturbed = cpu_share < 0.9 ? 1.06 : 1;
    return {range.value, range.low / disturbed, range.high * disturbed};
}

Range RaceTimes::of(std::size_t contestant) const { return known(ns[contestant]); }

Range RaceTimes::ratio(std::size_t contestant, std::size_t base) const
{
    std::vector<double> ratios;
    for (std::size_t r = 0; r < ns[contestant].size(); ++r)
        ratios.push_back(ns[contestant][r] / ns[base][r]);
    return contestant == base ? Range(1) : known(std::move(ratios));
}

RaceTimes race(const std::vector<std::function<void()>>& contestants, double seconds)
{
    constexpr double batch = 1e-3, slow = 10 * batch;
    constexpr std::size_t least = 5; // rounds
    const auto start = std::chrono::steady_clock::now();
    const double start_on_core = seconds_on_core();
    std::vector<std::size_t> times;
    std::vector<char> is_slow;
    double fast_round = 1e-9, slow_round = 0; // seconds for one batch of everyone
    for (const auto& call : contestants) {
        throw_if_interrupted();
        call(); // warm
        const double once = std::max(timed(call, 1), 1e-9);
        times.push_back(std::max<std::size_t>(1, static_cast<std::size_t>(batch / once)));
        is_slow.push_back(once > slow);
        (is_slow.back() ? slow_round : fast_round) += once * static_cast<double>(times.back());
    }
    auto rounds_of = [&](double round) { return std::max(least, static_cast<std::size_t>(0.5 * seconds / round)); };
    const std::size_t slow_rounds = slow_round > 0 ? rounds_of(slow_round) : 0,
                      rounds = std::max(slow_rounds, rounds_of(slow_round > 0 ? fast_round : 0.5 * fast_round));
    RaceTimes out;
    out.ns.resize(contestants.size());
    for (std::size_t r = 0; r < rounds; ++r) {
        const bool with_slow = r * slow_rounds / rounds != (r + 1) * slow_rounds / rounds; // evenly among them
        for (std::size_t i = 0; i < contestants.size(); ++i) {
            throw_if_interrupted();
            out.ns[i].push_back(
                is_slow[i] && !with_slow ? NAN : 1e9 * timed(contestants[i], times[i]) / static_cast<double>(times[i]));
        }
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
    return {{"experiment", experiment}, {"figure", f.what},   {"measured", f.measured},
            {"target", f.target},       {"reached", reached}, {"verdict", name_of(f.verdict)}};
}

void print(const std::vector<Figure>& figures)
{
    for (const Figure& f : figures)
        fmt::print("{:<44} {:>7}  target {:<7} {}\n", f.what, f.measured, f.target, said_of_target(f.verdict));
}

} // namespace cinch
