// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/page/collide_measurement.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "experiments/report/page/html.hpp"

namespace cinch {

using html::figure;
using html::percent;

Traced avoided_evaluation(const CollideTimes& full, const CollideTimes& lazy)
{
    if (!lazy.vertices.known())
        return {};
    Traced unused = 1 - lazy.vertices / lazy.all_vertices; // of a vertex of several leaves each counts
    unused.value = std::clamp(unused.value, 0.0, 1.0);
    return full.evaluate * unused;
}

std::string why_gain(const Results& results, const std::string& scene, double paper_full, double paper_total,
                     double paper_gain)
{
    const CollideTimes full = collide_times(results, scene, "refit-1"),
                       eq12 = collide_times(results, scene, "eq12-aabb"),
                       clusters = collide_times(results, scene, "refit-16"),
                       own = collide_times(results, scene, "cinch");
    const Traced gain = eq12.gain;
    std::string why =
        gain.value >= 1
            ? fmt::format("Eq. 12 on demand is {} times faster than a full update, in the paper {:g}.", figure(gain),
                          paper_gain)
            : fmt::format(
                  "Eq. 12 on demand takes {} times as long as a full update; in the paper it was {:g} times faster.",
                  figure(eq12.total / full.total), paper_gain);
    if (gain.value < paper_gain)
        why += fmt::format(" Since then the full update has become {} times faster, Eq. 12 {} times: to evaluate all "
                           "vertices in order gains more from SIMD than bounds on demand do.",
                           figure(paper_full / full.total), figure(paper_total / eq12.total));
    if (const Traced avoided = avoided_evaluation(full, eq12), saved = full.total - eq12.total, share = avoided / saved;
        avoided.known()) {
        why += fmt::format(
            " It evaluates {} of {} vertices per frame; the evaluation that it avoids is {} of the full update",
            figure(eq12.vertices), figure(eq12.all_vertices), percent(avoided / full.total));
        why += saved.value <= 0   ? ", too little to pay for its bounds."
               : share.value <= 1 ? fmt::format(" and {} of the gain.", percent(share))
                                  : ", more than is gained: its bounds cost the rest.";
    }
    if (clusters.known())
        why += fmt::format(" A full refit with 16-triangle leaves alone gains {}", figure(clusters.gain));
    if (own.known())
        why +=
            fmt::format("{} the default here, on the same leaves, {}", clusters.known() ? ";" : "", figure(own.gain));
    return why + (clusters.known() || own.known() ? "." : "");
}

} // namespace cinch
