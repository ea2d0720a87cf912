// SPDX-License-Identifier: GPL-3.0-or-later
// Boxes that pipelines bake: the union of the true ones at key times, or at 30 frames per second.
#include <cmath>

#include "experiments/baselines/engines/engine_formula.hpp"

namespace cinch {
namespace {

ReadyFormula union_at(const EngineCharacter& of, const std::vector<double>& times)
{
    EngineBound all = no_box();
    for (const double t : times)
        all = merged(all, box_of(of.places_at(t)));
    return {true, false, [all](std::span<const AffineMap>) { return all; }};
}

} // namespace

std::optional<ReadyFormula> union_at_keys(const EngineCharacter& of) { return union_at(of, of.motion.keys); }

std::optional<ReadyFormula> union_at_30_fps(const EngineCharacter& of)
{
    const double first = of.motion.first_s(), last = of.motion.last_s();
    std::vector<double> times;
    const auto frames = static_cast<std::size_t>(std::floor((last - first) * 30));
    for (std::size_t f = 0; f <= frames; ++f)
        times.push_back(std::min(last, first + static_cast<double>(f) / 30));
    return union_at(of, times);
}

} // namespace cinch
