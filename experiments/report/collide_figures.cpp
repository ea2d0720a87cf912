// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/collide_figures.hpp"

#include <fmt/format.h>

namespace cinch {

CollideTimes collide_times(const Results& results, const std::string& scene, const char* backend, bool cold)
{
    for (const Record* r :
         results.where({{"experiment", "collide"}, {"scene", scene}, {"backend", backend}, {"cold", cold}})) {
        if (r->number("frames_done") < r->number("frames"))
            continue;
        auto number = [&](const char* field) { return Results::number(*r, field); };
        const Traced evaluate = number("evaluate_ms");
        return {evaluate,
                evaluate + number("update_ms"),
                number("query_ms"),
                number("total_ms"),
                number("gain"),
                number("mean_vertices"),
                number("vertices") * number("bodies")};
    }
    return {};
}

std::string ring_scene(int number) { return fmt::format("santa-ring-{}", number); }

int ring_of(const std::string& scene)
{
    for (int ring = 1; ring <= 8; ++ring)
        if (scene == ring_scene(ring))
            return ring;
    return 0;
}

std::string row_of_table_3(int ring)
{
    const int first = (ring - 1) / 2 * 2 + 1;
    return fmt::format("{}, {}", first, first + 1);
}

} // namespace cinch
