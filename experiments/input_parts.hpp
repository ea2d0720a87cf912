// SPDX-License-Identifier: GPL-3.0-or-later
// Internal to load_input: what its kinds of files have in common.
#pragma once

#include <fmt/format.h>

#include "experiments/input.hpp"

namespace cinch {

/// Throws InputError for an option that does not apply. `scripted`: the input has no motion of its own; `clips`: it can
/// have many; `sampled`: they are functions of time.
void refuse_options(const InputOptions& options, bool scripted, bool clips, bool sampled);

/// Adds to the load report what normalising the weights of a file changed.
void report_weights(Input& input, const Influences& influences);

/// Puts the first lines of the load report before the others; `motion`: the rest of the second one.
void head_report(Input& input, const std::string& motion);

/// A glTF file, for load_input.
void load_character(Input& input, const InputOptions& options);

/// The clip of this name, or the first one; throws InputError that lists those of the file.
template <class Named>
const Named& choose_clip(const std::vector<Named>& clips, const std::string& wanted, const std::string& file)
{
    std::string known;
    for (const Named& clip : clips) {
        if (clip.name == wanted || wanted.empty())
            return clip;
        known += (known.empty() ? "" : ", ") + clip.name;
    }
    throw InputError::in_file(file, fmt::format("has no clip '{}'; it has {}", wanted, known.empty() ? "none" : known));
}

} // namespace cinch
