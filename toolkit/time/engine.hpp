// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "cinch/io.hpp"

namespace cinch {

/// How an engine departs from the exact motion of a character. What it renders at any time is then
/// Σ w̃_j M̃_j(t) (y + Σ_i a_i d_i), with rotations of unit length.
struct Engine {
    /// Rotations between keys are normalised sums of quaternions instead of spherical, or either.
    bool nlerp = false;
    /// Skinning in IEEE binary32: weights w̃ as the file stores them, not normalised; the entries of joint matrices
    /// rounded to it once; sums in any order, fused or not.
    bool float32 = false;
    /// Besides, how far a joint matrix may put a point, as a share of the lengths along its chain of bones, each link
    /// with the rest of the chain below it: what an engine's own products of transforms add up to.
    double joint_error = 0;

    bool exact() const { return !nlerp && !float32 && joint_error == 0; }
};

/// By how much, vertex by vertex, what is rendered differs.
class EngineError {
public:
    EngineError(const Engine& engine, const Character& character, const DeformableSurface& surface);

    /// Of vertices that joint j influences. `magnitude`: at least the length of every T_j y and of what it is added up
    /// from, without cancellation; `turned`: how far other rotations put it.
    double of(std::size_t j, double magnitude, double turned) const;
    /// ≥ ‖R̃ − R‖ between two keys of LINEAR rotations. `half_turn`: the angle φ between the quaternions; `is_half`:
    /// that rounding decides which way it goes; `length_ratio`: of the two, ≥ 1.
    double of_turn(double half_turn, bool is_half, double length_ratio) const;

private:
    Engine engine_;
    std::vector<double> stored_; ///< per joint the greatest Σ_j |w̃_j − w_j| of a vertex
    double roundings_ = 0;       ///< on any product of a vertex's sums
};

} // namespace cinch
