// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>

#include "cinch/io.hpp"
#include "experiments/bake/bake.hpp"
#include "experiments/input.hpp"
#include "toolkit/time/motion_interval.hpp"
#include "toolkit/time/pose_limits.hpp"

namespace cinch {

/// A clip with what the exact side reads of it.
struct TimedClip {
    TimedMotion motion;
    const Character::Animation* animation = nullptr; ///< none for simulated and text clips
};

/// Where the weights of morph targets are not those of the clips: the file as it was read, and their limits.
struct AnyWeights {
    std::shared_ptr<const Character> character;
    double least = 0, greatest = 1;
};

/// A surface with clips as functions of real time.
struct TimedBody {
    Input input;
    std::shared_ptr<const Character> character; ///< none for others
    std::optional<AnyWeights> any_weights;      ///< `character` is with_any_weights of its own then
    std::vector<PoseLimit> poses;               ///< of the bones, where poses stand for clips; else none
    std::vector<TimedClip> clips;

    std::span<const MorphTarget> targets() const
    {
        return character ? std::span<const MorphTarget>(character->targets) : std::span<const MorphTarget>();
    }
};

/// All clips of a character that can be used, or the one that was asked for; of others the frames, interpolated. Throws
/// InputError, as load_input does.
std::vector<TimedBody> load_timed(const InputOptions& options, const Engine& engine = {});

/// Every clip of every body, by their numbers: the cells of commands that go clip by clip.
std::vector<std::pair<std::size_t, std::size_t>> all_clips(const std::vector<TimedBody>& bodies);

/// Of all that moves a body, as checksum_of an Input. Throws Interrupted.
std::uint64_t checksum_of(const TimedBody& body, std::uint64_t so_far);

/// The motion that ends when it is asked to; and says what a wrong formula would say, for tests of the exact side.
TimedMotion watched(TimedMotion motion, TimeSabotage how);

} // namespace cinch
