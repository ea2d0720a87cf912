// SPDX-License-Identifier: Apache-2.0
#include "cinch/deform.hpp"

#include <memory>
#include <stdexcept>

#include "cinch/environment.hpp"

namespace cinch {

Clip::Clip(std::string clip_name, std::size_t count, std::function<double(std::size_t)> time_s,
           std::function<Frame(std::size_t)> frame, std::function<std::vector<double>(std::size_t)> weights)
    : name(std::move(clip_name)), count_(count), time_s_(std::move(time_s)), frame_(std::move(frame)),
      weights_(std::move(weights))
{
}

Clip::Clip(std::string clip_name, std::vector<double> time_s, std::vector<Frame> frames)
    : name(std::move(clip_name)), count_(frames.size())
{
    if (time_s.size() != frames.size())
        throw std::invalid_argument("clip: one time per frame is needed");
    time_s_ = [times = std::make_shared<const std::vector<double>>(std::move(time_s))](std::size_t i) {
        return (*times)[i];
    };
    frame_ = [stored = std::make_shared<const std::vector<Frame>>(std::move(frames))](std::size_t i) {
        return (*stored)[i];
    };
}

std::size_t Clip::checked(std::size_t i) const
{
    if (i >= count_)
        throw std::out_of_range("clip '" + name + "' has " + std::to_string(count_) + " frames, not one of index " +
                                std::to_string(i));
    return i;
}

double Clip::time_s(std::size_t i) const { return time_s_(checked(i)); }

Clip::Frame Clip::frame(std::size_t i) const
{
    require_default_arithmetic();
    return frame_(checked(i));
}

std::vector<double> Clip::weights(std::size_t i) const
{
    require_default_arithmetic();
    checked(i);
    return weights_ ? weights_(i) : std::vector<double>();
}

Clip evenly_spread(const Clip& clip, std::size_t frames)
{
    const std::size_t all = clip.frame_count();
    if (frames == 0 || frames >= all)
        return clip;
    auto chosen = [all, frames](std::size_t i) {
        return frames == 1 ? all - 1 : (i * (all - 1) + (frames - 1) / 2) / (frames - 1);
    };
    std::function<std::vector<double>(std::size_t)> weights;
    if (clip.displaces())
        weights = [clip, chosen](std::size_t i) { return clip.weights(chosen(i)); };
    return {clip.name, frames, [clip, chosen](std::size_t i) { return clip.time_s(chosen(i)); },
            [clip, chosen](std::size_t i) { return clip.frame(chosen(i)); }, weights};
}

} // namespace cinch
