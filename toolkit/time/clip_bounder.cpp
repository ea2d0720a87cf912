// SPDX-License-Identifier: Apache-2.0
#include "toolkit/time/bound_over.hpp"
#include "toolkit/time/character_motion.hpp"

namespace cinch {

struct ClipBounder::Parts {
    TimedMotion motion;
    IntervalRefitter refit;
    std::size_t supports;
};

ClipBounder::ClipBounder(const Character& character, const Character::Animation& animation,
                         const DeformableSurface& surface, const Bvh& bvh, const RefitOptions& options)
    : parts_(new Parts{character_motion(character, animation, surface),
                       {bvh, surface, options, character.targets},
                       bvh.bvs.size() * static_cast<std::size_t>(options.kdop)})
{
}

ClipBounder::~ClipBounder() = default;
ClipBounder::ClipBounder(ClipBounder&&) noexcept = default;

void ClipBounder::operator()(double t0_s, double t1_s, std::span<double> supports, double tolerance)
{
    const TimedMotion& motion = parts_->motion;
    if (!(motion.first_s() <= t0_s && t0_s <= t1_s && t1_s <= motion.last_s()))
        throw std::invalid_argument("times " + std::to_string(t0_s) + " to " + std::to_string(t1_s) +
                                    " do not lie in the clip's, " + std::to_string(motion.first_s()) + " to " +
                                    std::to_string(motion.last_s()));
    if (supports.size() != parts_->supports)
        throw std::invalid_argument("supports has " + std::to_string(supports.size()) + " entries; the BVs need " +
                                    std::to_string(parts_->supports));
    bound_over(parts_->refit, motion, t0_s, t1_s, tolerance, supports);
}

} // namespace cinch
