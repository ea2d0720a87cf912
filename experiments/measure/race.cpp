// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/measure/race.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/format.h>
#include <sched.h>

#include "experiments/report/interrupt.hpp"

namespace cinch {
namespace {

double timed(const std::function<void()>& call, std::size_t times)
{
    const auto start = std::chrono::steady_clock::now();
    for (std::size_t i = 0; i < times; ++i)
        call();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

} // namespace

void pin_to_one_core()
{
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(std::max(0, sched_getcpu()), &one);
    sched_setaffinity(0, sizeof one, &one);
}

std::vector<double> race(const std::vector<std::function<void()>>& contestants, double seconds)
{
    constexpr double batch = 1e-3;
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
    std::vector<std::vector<double>> ns(contestants.size());
    for (std::size_t r = 0; r < rounds; ++r)
        for (std::size_t i = 0; i < contestants.size(); ++i) {
            throw_if_interrupted();
            ns[i].push_back(1e9 * timed(contestants[i], times[i]) / static_cast<double>(times[i]));
        }
    std::vector<double> median;
    for (auto& all : ns) {
        const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
        std::nth_element(all.begin(), middle, all.end());
        median.push_back(*middle);
    }
    return median;
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

void print(const std::vector<Figure>& figures)
{
    for (const Figure& f : figures)
        fmt::print("{:<44} {:>7}  target {:<7} {}\n", f.what, f.measured, f.target,
                   f.reached ? "reached" : "FALLS SHORT");
}

} // namespace cinch
