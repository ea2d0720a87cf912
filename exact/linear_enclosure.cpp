// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "exact/motion_enclosure.hpp"
#include "exact/number.hpp"

namespace cinch::exact {

LinearEnclosure::LinearEnclosure(const Clip& clip) : clip_(clip)
{
    for (std::size_t i = 0; i < clip.frame_count(); ++i)
        time_s_.push_back(clip.time_s(i));
    keys_ = time_s_;
    keys_.erase(std::unique(keys_.begin(), keys_.end()), keys_.end());
}

void LinearEnclosure::at(double a_s, double b_s, double piece_a_s, double piece_b_s, std::vector<MapEnclosure>& maps,
                         std::vector<MapEnclosure>& slopes) const
{
    // The last frame at or before the piece's middle; of those at one time the last.
    const double middle = piece_a_s + (piece_b_s - piece_a_s) / 2;
    std::size_t i = 0;
    while (i + 1 < time_s_.size() && time_s_[i + 1] <= middle)
        ++i;
    const bool moves = i + 1 < time_s_.size();
    if (kept_ != i) { // frames may be read from files or made anew: before rounding is directed
        first_ = clip_.frame(i);
        last_ = moves ? clip_.frame(i + 1) : first_;
        kept_ = i;
    }
    const DirectedRounding rounding;
    const Interval length = moves ? Interval(time_s_[i + 1]) - Interval(time_s_[i]) : Interval(1),
                   s = moves ? (Interval(a_s, b_s) - Interval(time_s_[i])) / length : Interval(0);
    auto enclosed = [](const Interval& x) { // an overflow leaves no interval
        return x.inf() <= x.sup() ? Enclosure{x.inf(), x.sup()} : Enclosure{-HUGE_VAL, HUGE_VAL};
    };
    maps.resize(first_.size());
    slopes.resize(first_.size());
    for (std::size_t j = 0; j < first_.size(); ++j)
        for (std::size_t r = 0; r < 3; ++r)
            for (std::size_t c = 0; c < 4; ++c) {
                const Interval from(first_[j].m[r][c]), to(last_[j].m[r][c]);
                maps[j].m[r][c] = enclosed((1 - s) * from + s * to);
                slopes[j].m[r][c] = moves ? enclosed((to - from) / length) : Enclosure{};
            }
}

} // namespace cinch::exact
