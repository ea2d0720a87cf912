// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/input_checksum.hpp"

#include "experiments/report/interrupt.hpp"

namespace cinch {

std::uint64_t checksum_of(const Input& input, std::uint64_t sum)
{
    auto take = [&](const auto& all) {
        sum = checksum({reinterpret_cast<const char*>(all.data()), all.size() * sizeof(all[0])}, sum);
    };
    take(input.surface.mesh.vertices);
    take(input.surface.mesh.triangles);
    take(input.surface.weights.row);
    take(input.surface.weights.node);
    take(input.surface.weights.weight);
    for (std::size_t f = 0; f < input.clip.frame_count(); ++f) {
        throw_if_interrupted();
        take(input.clip.frame(f));
        if (input.clip.displaces())
            take(input.clip.weights(f));
    }
    for (const MorphTarget& target : input.targets) {
        take(target.vertex);
        take(target.displacement);
    }
    return sum;
}

std::uint64_t checksum_of(const Inputs& inputs)
{
    std::uint64_t sum = checksum_of_nothing;
    for (const Input& body : inputs.bodies)
        sum = checksum_of(body, sum);
    return sum;
}

} // namespace cinch
