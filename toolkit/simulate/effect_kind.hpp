// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <span>

#include "toolkit/simulate/coupling.hpp"

namespace cinch {

class BodyBuilder;
class CouplingBuilder;
class JsonFields;

/// What an effect of a scene does to its bodies, once its fields are read.
struct EffectPlan {
    /// To each of them; empty: nothing.
    std::function<void(BodyBuilder&)> build{};
    /// To them together, when all are built; empty: nothing.
    std::function<std::unique_ptr<Coupling>(CouplingBuilder&)> couple{};
    double young = 0; ///< Pa, of an elastic material, for effects on the same body that ask for it; 0: it is none
    bool follows_clip = false; ///< it takes nodes where their character's clip does, so that the body begins there
};

/// An effect that a scene can name. Defined in the effect's own file, simulate/effects/NAME.cpp, as effects::NAME; the
/// list of names in toolkit/CMakeLists.txt makes it known.
struct EffectKind {
    const char* name;
    EffectPlan (*read)(JsonFields&); ///< throws InputError for what is wrong
    /// JSON: what may be written, as an array of forms. Each has "description", "properties" and "required" as in a
    /// JSON schema, of the fields that are the effect's own, and "example", an object with as many of them as can stand
    /// together. Tests run the examples.
    const char* forms;
};

/// All of them, in the order in which they are listed.
std::span<const EffectKind* const> effect_kinds();

} // namespace cinch
