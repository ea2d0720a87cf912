// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>

#include "cinch/io.hpp"

namespace cinch {
namespace {

struct Sum {
    Vec3 low = Vec3::Zero(), high = Vec3::Zero(), terms = Vec3::Zero(); // terms: of absolute values
};

} // namespace

Character with_any_weights(Character character, double least, double greatest)
{
    if (!(std::isfinite(least) && std::isfinite(greatest) && least <= greatest))
        throw std::invalid_argument("with_any_weights: expected finite limits, the least first");
    std::map<std::uint32_t, Sum> of; // a vertex
    for (const MorphTarget& target : character.targets)
        for (std::size_t n = 0; n < target.vertex.size(); ++n) {
            Sum& sum = of[target.vertex[n]];
            const Vec3 a = least * target.displacement[n], b = greatest * target.displacement[n];
            sum.low += a.cwiseMin(b);
            sum.high += a.cwiseMax(b);
            sum.terms += a.cwiseAbs().cwiseMax(b.cwiseAbs());
        }
    // The sums above, and those of a caller in whatever order, pass at most m + 1 roundings of u each; those of centre
    // and half extents stay below the rest.
    const double roundings = static_cast<double>(character.targets.size() + 5),
                 relative = roundings * std::numeric_limits<double>::epsilon(),
                 absolute = roundings * std::numeric_limits<double>::denorm_min();
    MorphTarget all;
    for (const auto& [vertex, sum] : of) {
        if (!sum.terms.allFinite())
            throw InputError::in_file(character.file, "morph targets displace vertex " + std::to_string(vertex) +
                                                          " beyond all doubles at weights from " +
                                                          std::to_string(least) + " to " + std::to_string(greatest));
        const Vec3 centre = 0.5 * sum.low + 0.5 * sum.high;
        all.vertex.push_back(vertex);
        all.displacement.push_back(centre);
        all.half.push_back((sum.high - centre).cwiseMax(centre - sum.low) + relative * sum.terms +
                           Vec3::Constant(absolute));
    }
    for (MorphTarget& target : character.targets)
        target = {};
    std::fill(character.target_weights.begin(), character.target_weights.end(), 0.0);
    if (!character.targets.empty()) {
        character.targets.front() = std::move(all);
        character.target_weights.front() = 1;
    }
    for (Character::Animation& animation : character.animations)
        animation.morphs.clear();
    character.rest.morphs.clear();
    return character;
}

} // namespace cinch
