// SPDX-License-Identifier: Apache-2.0
#include "toolkit/time/engine.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace cinch {
namespace {

constexpr double u = 0x1p-24, wider = 1 + 0x1p-40;

} // namespace

EngineError::EngineError(const Engine& engine, const Character& character, const DeformableSurface& surface)
    : engine_(engine), stored_(character.joints.size(), 0)
{
    std::size_t influences = 0;
    const Influences& given = character.influences;
    for (std::size_t v = 0; v < surface.weights.vertex_count(); ++v) {
        std::map<std::uint32_t, double> off; // w̃ − w
        for (std::uint32_t i = given.row[v]; i < given.row[v + 1]; ++i)
            off[given.node[i]] += given.weight[i];
        influences = std::max(influences, off.size());
        const Weights::Row row = surface.weights.of(v);
        for (std::size_t i = 0; i < row.node.size(); ++i)
            off[row.node[i]] -= row.weight[i];
        double sum = 0;
        for (const auto& [node, difference] : off)
            sum += std::abs(difference);
        for (const auto& [node, difference] : off)
            stored_[node] = std::max(stored_[node], sum * wider);
    }
    // Of a rest position that was stored as integers, of displacements, of M y, of the sum over joints, and of weights
    // times matrices where those are added up first: in any order no product passes more.
    roundings_ = static_cast<double>(influences + character.targets.size()) + 10;
}

double EngineError::of(std::size_t j, double magnitude, double turned) const
{
    double error = turned + engine_.joint_error * magnitude;
    if (engine_.float32) {
        // Without cancellation |M| |y| + |t|, which is at most √3 of ‖M‖ ‖y‖ + ‖t‖, each product off by one rounding of
        // the matrix and by γ of the sums; what is below the least normal number of binary32 by 2⁻¹⁴⁹ each.
        const double gamma = (roundings_ + 1) * u / (1 - (roundings_ + 1) * u);
        const double reached = (magnitude + error) * (1 + stored_[j]);
        error += stored_[j] * (magnitude + error) + 1.7320508075688774 * wider * gamma * reached +
                 roundings_ * 0x1p-140 * (1 + magnitude);
        if (!(reached < 0x1p+126))
            return HUGE_VAL;
    }
    return error * wider;
}

double EngineError::of_turn(double half_turn, bool is_half, double length_ratio) const
{
    if (engine_.exact() || half_turn == 0)
        return 0;
    if (is_half && (engine_.float32 || engine_.joint_error > 0))
        return 2;
    // An angle between the two of a normalised sum differs by at most 0.0185 φ³ (tests/time/engine_test.py has its
    // greatest over s and φ), that of the rotation by twice this; and as the ratio λ of the lengths changes it by at
    // most tan(φ/2)/2 of log λ, it differs by tan(φ/2) log λ where keys are not of one length.
    return std::min(2.0, ((engine_.nlerp ? 0.037 * half_turn * half_turn * half_turn : 0) +
                          std::tan(half_turn / 2) * std::log(length_ratio)) *
                             wider);
}

} // namespace cinch
