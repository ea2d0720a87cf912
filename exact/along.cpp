// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/along.hpp"

namespace cinch::exact {

void add_place(const Weights::Row& row, const Place& y, const std::vector<MapEnclosure>& maps, bool shift, Place& out)
{
    for (std::size_t i = 0; i < row.node.size(); ++i) {
        const MapEnclosure& map = maps[row.node[i]];
        for (std::size_t r = 0; r < 3; ++r) {
            Interval x = shift ? interval_of(map.m[r][3]) : Interval(0);
            for (std::size_t c = 0; c < 3; ++c)
                x += interval_of(map.m[r][c]) * y[c];
            out[r] += Interval(row.weight[i]) * x;
        }
    }
}

void add_displacement(DisplacedBy by, const std::vector<Enclosure>& weights, Place& out)
{
    for (const auto& [target, d] : by)
        for (std::size_t r = 0; r < 3; ++r)
            out[r] += interval_of(weights[target]) * Interval(d[static_cast<int>(r)]);
}

Interval along(const Axis& axis, bool against, const Place& x)
{
    Interval sum(0);
    for (std::size_t r = 0; r < 3; ++r)
        if (axis[r] != 0)
            sum += (axis[r] > 0) != against ? x[r] : -x[r];
    return sum;
}

Along::Along(const Weights::Row& row, const std::vector<MapEnclosure>& maps, const Axis& axis, bool against)
    : g{Interval(0), Interval(0), Interval(0)}, shift(0)
{
    for (std::size_t i = 0; i < row.node.size(); ++i)
        for (std::size_t r = 0; r < 3; ++r) {
            if (axis[r] == 0)
                continue;
            const Interval w = (axis[r] > 0) != against ? Interval(row.weight[i]) : -Interval(row.weight[i]);
            const MapEnclosure& map = maps[row.node[i]];
            for (std::size_t c = 0; c < 3; ++c)
                g[c] += w * interval_of(map.m[r][c]);
            shift += w * interval_of(map.m[r][3]);
        }
}

Interval displaced_along(const Along& along, DisplacedBy by, const std::vector<Enclosure>& weights, bool greatest)
{
    Interval sum(0);
    for (const auto& [target, d] : by) {
        const Interval one = along.of(d), low = Interval(weights[target].low) * one,
                       high = Interval(weights[target].high) * one;
        sum += Interval(greatest ? std::max(low.inf(), high.inf()) : std::min(low.inf(), high.inf()),
                        std::max(low.sup(), high.sup()));
    }
    return sum;
}

} // namespace cinch::exact
