// SPDX-License-Identifier: Apache-2.0
// Clips of a character at evenly spaced times.
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

#include "cinch/environment.hpp"
#include "cinch/surface.hpp"
#include "toolkit/surface/character.hpp"
#include "toolkit/time/character_motion.hpp"

namespace cinch {
namespace {

// What a frame is made from.
struct Motion {
    std::function<Clip::Frame(double)> at;
    double first, last;
    std::size_t steps; // from the first frame to the last

    double time_s(std::size_t i) const
    {
        return i == steps ? last : first + (last - first) * static_cast<double>(i) / static_cast<double>(steps);
    }
};

} // namespace

Clip rest_pose(const Character& character) { return sample(character, character.rest, 1); }

Clip sample(const Character& character, const Character::Animation& animation, double fps)
{
    require_default_arithmetic();
    if (!animation.fault.empty())
        throw InputError(animation.fault);
    const double length = animation.last_s - animation.first_s;
    constexpr double most_frames = 1e12;
    if (!(length * fps < most_frames - 1))
        throw InputError::in_file(character.file,
                                  "clip '" + animation.name + "' lasts " + std::to_string(length) +
                                      " s, a million million frames at this rate; lower the frames per second");
    const auto steps = static_cast<std::size_t>(std::max(length > 0 ? 1.0 : 0.0, std::round(length * fps)));
    auto motion = std::make_shared<const Motion>(
        Motion{joint_maps(character, animation), animation.first_s, animation.last_s, steps});
    return {animation.name, steps + 1, [motion](std::size_t i) { return motion->time_s(i); },
            [motion](std::size_t i) { return motion->at(motion->time_s(i)); }};
}

std::string not_modelled(const std::vector<std::string>& missing)
{
    std::string out = "what is not modelled: ";
    for (std::size_t i = 0; i < missing.size(); ++i)
        out += (i ? "; " : "") + missing[i];
    return out;
}

} // namespace cinch
