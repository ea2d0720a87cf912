// SPDX-License-Identifier: Apache-2.0
#include "toolkit/time/bake_clip.hpp"

#include <cmath>

#include "toolkit/hierarchy/box_radius.hpp"
#include "toolkit/time/bound_over.hpp"

namespace cinch {
namespace {

constexpr double shortest_s = 1.0 / 30, worth_cutting = 0.9;

double root_radius(const BakedInterval& of) { return box_radius(std::span(of.supports).first(6)); }

} // namespace

std::vector<BakedInterval> bake_clip(IntervalRefitter& refit, const TimedMotion& motion, const ClipCuts& cuts,
                                     std::size_t bvs, const std::function<void(double)>& poll)
{
    auto bounded = [&](double a, double b) {
        poll(a);
        BakedInterval out{a, b, std::vector<double>(bvs * refit.kdop()), 0};
        out.intervals = bound_over(refit, motion, a, b, cuts.tolerance, out.supports);
        return out;
    };
    const double first = motion.first_s(), last = motion.last_s(), length = last - first;
    std::vector<BakedInterval> out;
    if (cuts.whole || !(length > 0)) {
        out.push_back(bounded(first, last));
    } else if (cuts.interval_s > 0) {
        const auto count = static_cast<std::size_t>(std::ceil(length / cuts.interval_s));
        auto cut = [&](std::size_t i) { return i == count ? last : first + static_cast<double>(i) * cuts.interval_s; };
        for (std::size_t i = 0; i < count; ++i)
            out.push_back(bounded(cut(i), cut(i + 1)));
    } else {
        std::vector<BakedInterval> open{bounded(first, last)}; // the earliest last
        while (!open.empty()) {
            BakedInterval whole = std::move(open.back());
            open.pop_back();
            const double a = whole.first_s, b = whole.last_s, middle = a + (b - a) / 2;
            if (b - a >= 2 * shortest_s) {
                BakedInterval one = bounded(a, middle), two = bounded(middle, b);
                if ((root_radius(one) + root_radius(two)) / 2 < worth_cutting * root_radius(whole)) {
                    open.push_back(std::move(two));
                    open.push_back(std::move(one));
                    continue;
                }
            }
            out.push_back(std::move(whole));
        }
    }
    return out;
}

} // namespace cinch
