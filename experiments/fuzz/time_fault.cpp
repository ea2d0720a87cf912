// SPDX-License-Identifier: GPL-3.0-or-later
// Bounds for all times of a small character against the exact side.
#include <cmath>

#include <fmt/format.h>

#include "exact/clip_enclosure.hpp"
#include "exact/time_check.hpp"
#include "experiments/bake/timed_body.hpp"
#include "experiments/fuzz/fuzz_case.hpp"
#include "experiments/fuzz/time_case.hpp"
#include "experiments/report/interrupt.hpp"
#include "toolkit/time/character_motion.hpp"

namespace cinch {
namespace {

TimeSabotage sabotage_of(Defect defect)
{
    switch (defect) {
    case Defect::no_remainder:
        return TimeSabotage::no_remainder;
    case Defect::half_bump:
        return TimeSabotage::half_bump;
    case Defect::skip_key:
        return TimeSabotage::first_half;
    case Defect::still_morphs:
        return TimeSabotage::still_morphs;
    default:
        return TimeSabotage::none;
    }
}

} // namespace

std::string time_fault(const FuzzCase& problem, Defect defect)
{
    TimeCase drawn = draw_time_case(problem.drawn);
    // Now and then a program sets the weights of morph targets.
    std::optional<exact::Enclosure> any_weights;
    const Character read = drawn.character;
    if (problem.trial % 4 == 3) {
        any_weights = exact::Enclosure{-0.25, 1};
        drawn.character = with_any_weights(std::move(drawn.character), any_weights->low, any_weights->high);
    }
    const TimedMotion motion =
        watched(character_motion(drawn.character, drawn.character.rest, drawn.surface), sabotage_of(defect));
    RefitOptions options;
    options.methods =
        std::array{Methods(Method::best), Methods(Method::local), Methods(Method::limited)}[problem.trial % 3];
    options.kdop = problem.kdop;
    options.precision = problem.trial % 2 ? Precision::float64 : Precision::float32;
    const CutInto by = problem.passes ? CutInto::between_keys : problem.trial < 3 ? CutInto::chosen : CutInto::in_a_row;
    const std::vector<double> supports = bounds_over_clip(drawn, motion, options, by);
    std::optional<exact::ClipEnclosure> clip;
    try {
        clip.emplace(read, read.rest, any_weights);
    } catch (const InputError&) { // two keys half a turn apart to the bit
        return "";
    }
    const exact::TimeChecker check(drawn.surface, drawn.bvh, *clip, read.targets, options.kdop, throw_if_interrupted);
    const exact::TimeVerdict verdict = check(motion.first_s(), motion.last_s(), supports);
    if (verdict.worst)
        return fmt::format("vertex {} at {:.17g} s is {:.3g} beyond direction {} of BV {}", verdict.worst->vertex,
                           verdict.worst->time_s, verdict.worst->at_least - verdict.worst->bound,
                           verdict.worst->direction, verdict.worst->bv);
    return verdict.undecided ? fmt::format("{} of {} bounds undecided", verdict.undecided, verdict.bounds) : "";
}

} // namespace cinch
