// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "experiments/bake/timed_body.hpp"
#include "experiments/baselines/engines/engine_formula.hpp"

namespace cinch {

/// A body as engines have it, in one of its clips; both must stay alive.
EngineCharacter engine_character(const TimedBody& body, const TimedClip& clip);

/// A formula of engine_formulas(), ready for it. Throws InputError for a name that is none, and for a body that lacks
/// what the formula needs.
ReadyFormula ready_formula(const std::string& name, const TimedBody& body, const TimedClip& clip);

} // namespace cinch
