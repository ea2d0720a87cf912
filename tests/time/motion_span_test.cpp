// SPDX-License-Identifier: GPL-3.0-or-later
// What is said of intervals in a row by their two ends, against the places of vertices at times between.
#include <cmath>
#include <random>

#include <catch2/catch.hpp>

#include "experiments/fuzz/time_case.hpp"
#include "tests/support.hpp"
#include "toolkit/time/character_motion.hpp"
#include "toolkit/time/motion_span.hpp"

using namespace cinch;

TEST_CASE("intervals in a row keep below a parabola over both of their ends, and not by far")
{
    std::mt19937_64 random(29);
    std::size_t checks = 0;
    double nearest = 0;
    for (std::size_t i = 0, cases = test::share_of(200); i < cases; ++i) {
        TimeCase subject = draw_time_case(random());
        subject.character.targets.clear();
        subject.character.target_weights.clear();
        subject.character.rest.morphs.clear();
        const TimedMotion motion = character_motion(subject.character, subject.character.rest, subject.surface);
        const std::vector<double>& keys = motion.keys;
        if (keys.size() < 3)
            continue;
        const std::size_t first = random() % (keys.size() - 2), last = first + 2 + random() % (keys.size() - first - 2);
        std::vector<std::shared_ptr<const MotionInterval>> intervals;
        for (std::size_t n = first; n < last; ++n)
            intervals.push_back(std::make_shared<const MotionInterval>(motion.over(keys[n], keys[n + 1])));
        const int kdop = kdops[i % kdops.size()];
        const auto k = static_cast<std::size_t>(kdop);
        const auto axes = axes_of(kdop);
        const MotionSpan span = motion_span(intervals, subject.bvh, kdop);
        auto place = [&](std::span<const AffineMap> maps, std::size_t v) {
            Vec3 x = Vec3::Zero();
            const Weights::Row row = subject.surface.weights.of(v);
            for (std::size_t n = 0; n < row.node.size(); ++n)
                x += row.weight[n] * apply(maps[row.node[n]], subject.surface.mesh.vertices[v]);
            return x;
        };
        for (std::size_t n = first; n < last; ++n)
            for (int part = 0; part <= 8; ++part) {
                const MotionInterval& interval = *intervals[n - first];
                const double t = part == 8 ? keys[n + 1] : keys[n] + (keys[n + 1] - keys[n]) * part / 8;
                const std::vector<AffineMap> maps = part == 0   ? interval.first
                                                    : part == 8 ? interval.last
                                                                : motion.at(t);
                const double tau = (t - keys[first]) / (keys[last] - keys[first]);
                for (std::size_t v = 0; v < subject.surface.mesh.vertices.size(); ++v) {
                    const Vec3 from = place(intervals.front()->first, v), to = place(intervals.back()->last, v),
                               above = place(maps, v) - ((1 - tau) * from + tau * to);
                    const double size = from.norm() + to.norm() + above.norm();
                    const Weights::Row row = subject.surface.weights.of(v);
                    for (std::size_t d = 0; d < k; ++d) {
                        const auto& g = axes[d / 2];
                        double rise = 0, bump = 0, error = 0;
                        for (std::size_t j = 0; j < row.node.size(); ++j) {
                            rise += row.weight[j] * span.rise[row.node[j] * k + d];
                            bump += row.weight[j] * span.bump[row.node[j] * k + d];
                            error = std::max(error, span.error[row.node[j]]);
                        }
                        if (!(rise + bump < HUGE_VAL))
                            continue; // nothing is known
                        const double reach = (d % 2 ? -1 : 1) * (g[0] * above[0] + g[1] * above[1] + g[2] * above[2]),
                                     parabola = 4 * tau * (1 - tau) * rise;
                        CAPTURE(i, n, part, v, d, reach, parabola, bump);
                        CHECK(reach <= parabola + bump + 3 * error + 1e-13 * size);
                        ++checks;
                        if ((part == 0 || part == 8) && bump < 0.01 * reach)
                            nearest = std::max(nearest, reach / (parabola + bump));
                    }
                }
            }
    }
    CHECK(checks > 0);
    CHECK(nearest > 0.9);
}
