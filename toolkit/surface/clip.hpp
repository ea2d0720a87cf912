// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace cinch {

/// x ↦ A x + t, row-major: A is m[r][0..2], t is m[r][3]. Applied to column vectors.
struct AffineMap {
    double m[3][4];
};
inline constexpr AffineMap identity_map{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

/// Motion as frames, each made when it is asked for: a clip of a million frames takes the memory of those that are
/// held. Frame i moves simulation node j by frame(i)[j]; all frames have as many maps. Copies share what the frames
/// are made from.
class Clip {
public:
    using Frame = std::vector<AffineMap>;

    Clip() = default;
    /// Frames that are computed. `time_s` and `frame` are called with i < count, by any thread, and always answer the
    /// same.
    Clip(std::string clip_name, std::size_t count, std::function<double(std::size_t)> time_s,
         std::function<Frame(std::size_t)> frame);
    /// Frames that are there already, one per time. Throws std::invalid_argument where their numbers differ.
    Clip(std::string clip_name, std::vector<double> time_s, std::vector<Frame> frames);

    std::size_t frame_count() const { return count_; }
    /// i < frame_count(), else std::out_of_range; in seconds.
    double time_s(std::size_t i) const;
    /// The same for the maps. Throws InputError where a computed frame overflows.
    Frame frame(std::size_t i) const;

    std::string name;

private:
    std::size_t checked(std::size_t i) const;

    std::size_t count_ = 0;
    std::function<double(std::size_t)> time_s_;
    std::function<Frame(std::size_t)> frame_;
};

/// `frames` of the clip, evenly spread, the last one included; 0, and as many as it has or more, keep all. The clip
/// has at most 10¹² frames.
Clip evenly_spread(const Clip& clip, std::size_t frames);

} // namespace cinch
