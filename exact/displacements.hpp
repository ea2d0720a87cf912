// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "cinch/surface.hpp"

namespace cinch::exact {

/// Morph targets by the vertices that they displace.
class Displacements {
public:
    /// By one target.
    struct One {
        std::uint32_t target;
        Vec3 by;
    };

    /// Of this many vertices. Throws std::invalid_argument for vertices beyond them, numbers of displacements that do
    /// not fit, and displacements that are not finite or not known (MorphTarget::half).
    Displacements(std::span<const MorphTarget> targets, std::size_t vertices);

    std::size_t targets() const { return targets_; }
    /// Of a vertex.
    std::span<const One> of(std::size_t vertex) const
    {
        return row_.empty() ? std::span<const One>()
                            : std::span(all_).subspan(row_[vertex], row_[vertex + 1] - row_[vertex]);
    }

private:
    std::size_t targets_;
    std::vector<std::size_t> row_; // none where there are no targets
    std::vector<One> all_;
};

} // namespace cinch::exact
