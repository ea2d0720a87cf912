// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "toolkit/python/src/objects.hpp"

namespace cinch::python {

/// Motion as somebody hands it in: transforms of one frame, (J, 3, 4), of many, (frames, J, 3, 4), or a Clip; and
/// weights of morph targets, (targets,) or (frames, targets), or the clip's own. Arrays are read where they stand.
class Frames {
public:
    Frames(py::handle maps, py::handle weights, std::size_t nodes, std::size_t targets)
    {
        const auto j = static_cast<py::ssize_t>(nodes);
        if (py::isinstance<ClipObject>(maps)) {
            clip_ = py::cast<std::shared_ptr<ClipObject>>(maps);
            count_ = clip_->clip.frame_count();
            if (clip_->nodes != nodes && count_ > 0)
                throw py::value_error("maps: the clip moves " + std::to_string(clip_->nodes) +
                                      " simulation nodes; the surface has " + std::to_string(nodes));
        } else {
            maps_ = Doubles(maps, "maps");
            single_ = maps_.ndim() == 3;
            if (!fits(maps_.array(), {j, 3, 4}) && !fits(maps_.array(), {any, j, 3, 4}))
                throw py::value_error("maps: an array of shape (" + std::to_string(nodes) + ", 3, 4) or (frames, " +
                                      std::to_string(nodes) + ", 3, 4), or a Clip, is needed, not " +
                                      shape_of(maps_.array()));
            count_ = single_ ? 1 : maps_.shape(0);
        }
        if (weights.is_none()) {
            of_clip_ = clip_ && clip_->clip.displaces() && targets > 0;
            return;
        }
        given_ = Doubles(weights, "weights");
        const auto t = static_cast<py::ssize_t>(targets);
        same_ = fits(given_.array(), {t});
        if (!same_ && (single_ || !fits(given_.array(), {static_cast<py::ssize_t>(count_), t})))
            throw py::value_error("weights: one per morph target, of which there are " + std::to_string(targets) +
                                  ", and frame is needed, not " + shape_of(given_.array()));
        targets_ = targets;
    }

    bool single() const { return single_; }
    std::size_t count() const { return count_; }
    /// Of a frame; until the next is asked for. Throws InputError where a clip's overflow.
    std::span<const AffineMap> maps(std::size_t frame)
    {
        if (clip_)
            return frame_ = clip_->clip.frame(frame);
        const auto all = maps_.rows<AffineMap>();
        const std::size_t each = count_ ? all.size() / count_ : 0;
        return all.subspan(frame * each, each);
    }
    /// The same; empty where no targets displace anything.
    std::span<const double> weights(std::size_t frame)
    {
        if (of_clip_)
            return weights_ = clip_->clip.weights(frame);
        return targets_ == 0 ? std::span<const double>()
                             : given_.values().subspan(same_ ? 0 : frame * targets_, targets_);
    }
    /// Dimensions of a result that has `each` for every frame.
    std::vector<py::ssize_t> shape(std::initializer_list<std::size_t> each) const
    {
        std::vector<py::ssize_t> out;
        if (!single_)
            out.push_back(static_cast<py::ssize_t>(count_));
        for (const std::size_t n : each)
            out.push_back(static_cast<py::ssize_t>(n));
        return out;
    }

private:
    Doubles maps_, given_;
    std::shared_ptr<ClipObject> clip_;
    std::size_t count_ = 0, targets_ = 0;
    bool single_ = false, same_ = false, of_clip_ = false;
    Clip::Frame frame_;
    std::vector<double> weights_;
};

/// A list of MorphTarget, copied. Throws ValueError where one names a vertex that the surface lacks.
inline std::vector<MorphTarget> targets_from(py::handle from, std::size_t vertices)
{
    std::vector<MorphTarget> out;
    for (const py::handle one : from) {
        out.push_back(*needed<MorphTarget>(one, "targets"));
        if (!out.back().vertex.empty() && out.back().vertex.back() >= vertices)
            throw py::value_error("morph target " + std::to_string(out.size() - 1) + " displaces vertex " +
                                  std::to_string(out.back().vertex.back()) + "; there are " + std::to_string(vertices));
    }
    return out;
}

} // namespace cinch::python
