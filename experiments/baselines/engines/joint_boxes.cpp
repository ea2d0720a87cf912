// SPDX-License-Identifier: GPL-3.0-or-later
// A box per joint of the rest vertices that it influences, transformed by centre and half extents, all united: Godot 4
// (bone AABBs of a mesh), Bevy 0.19 (DynamicSkinnedMeshBounds). As they compute it, in binary32; and in real
// arithmetic, here in doubles.
#include <cmath>

#include "experiments/baselines/engines/engine_formula.hpp"

namespace cinch {
namespace {

struct JointBoxes {
    std::vector<std::uint32_t> joint;
    std::vector<Vec3> centre, half;

    explicit JointBoxes(const EngineCharacter& of)
    {
        std::vector<EngineBound> box(of.surface.weights.node_count, no_box());
        for (std::size_t v = 0; v < of.surface.mesh.vertices.size(); ++v) {
            const Weights::Row row = of.surface.weights.of(v);
            const Vec3& x = of.surface.mesh.vertices[v];
            for (std::size_t i = 0; i < row.node.size(); ++i)
                if (row.weight[i] > 0)
                    box[row.node[i]] = merged(box[row.node[i]], {x, x, {}});
        }
        for (std::uint32_t j = 0; j < box.size(); ++j)
            if (box[j].low[0] <= box[j].high[0]) {
                joint.push_back(j);
                centre.push_back(0.5 * (box[j].low + box[j].high));
                half.push_back(0.5 * (box[j].high - box[j].low));
            }
    }

    template <class T> EngineBound at(std::span<const AffineMap> maps) const
    {
        T low[3], high[3];
        for (int r = 0; r < 3; ++r) {
            low[r] = static_cast<T>(HUGE_VAL);
            high[r] = static_cast<T>(-HUGE_VAL);
        }
        for (std::size_t n = 0; n < joint.size(); ++n)
            for (int r = 0; r < 3; ++r) {
                const auto& m = maps[joint[n]].m[r];
                T middle = static_cast<T>(m[3]), reach = 0;
                for (int c = 0; c < 3; ++c) {
                    middle += static_cast<T>(m[c]) * static_cast<T>(centre[n][c]);
                    reach += std::abs(static_cast<T>(m[c])) * static_cast<T>(half[n][c]);
                }
                low[r] = std::min(low[r], middle - reach);
                high[r] = std::max(high[r], middle + reach);
            }
        return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}, {}};
    }
};

} // namespace

std::optional<ReadyFormula> joint_boxes(const EngineCharacter& of)
{
    return ReadyFormula{false, true,
                        [boxes = JointBoxes(of)](std::span<const AffineMap> maps) { return boxes.at<double>(maps); }};
}

std::optional<ReadyFormula> joint_boxes_float(const EngineCharacter& of)
{
    return ReadyFormula{false, false,
                        [boxes = JointBoxes(of)](std::span<const AffineMap> maps) { return boxes.at<float>(maps); }};
}

std::optional<ReadyFormula> joint_boxes_at_keys(const EngineCharacter& of)
{
    const JointBoxes boxes(of);
    EngineBound all = no_box();
    for (const double t : of.motion.keys)
        all = merged(all, boxes.at<double>(of.motion.at(t)));
    return ReadyFormula{true, false, [all](std::span<const AffineMap>) { return all; }};
}

} // namespace cinch
