// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/displacements.hpp"

#include <stdexcept>

namespace cinch::exact {

Displacements::Displacements(std::span<const MorphTarget> targets, std::size_t vertices) : targets_(targets.size())
{
    if (targets.empty())
        return;
    row_.assign(vertices + 1, 0);
    for (const MorphTarget& target : targets) {
        if (!target.half.empty() || target.displacement.size() != target.vertex.size())
            throw std::invalid_argument("morph targets: one known displacement per vertex is needed");
        for (std::size_t n = 0; n < target.vertex.size(); ++n) {
            if (target.vertex[n] >= vertices || !target.displacement[n].allFinite())
                throw std::invalid_argument("morph targets: a vertex that there is not, or a displacement that is not "
                                            "finite");
            ++row_[target.vertex[n] + 1];
        }
    }
    for (std::size_t v = 0; v < vertices; ++v)
        row_[v + 1] += row_[v];
    all_.resize(row_.back());
    std::vector<std::size_t> next(row_.begin(), row_.end() - 1);
    for (std::uint32_t i = 0; i < targets.size(); ++i)
        for (std::size_t n = 0; n < targets[i].vertex.size(); ++n)
            all_[next[targets[i].vertex[n]]++] = {i, targets[i].displacement[n]};
}

} // namespace cinch::exact
