// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>

#include "exact/time_check.hpp"
#include "exact/verifier.hpp"
#include "experiments/audit/audit_clip.hpp"
#include "experiments/baselines/engines/engine_formula.hpp"

namespace cinch {

/// A pose of the clip, with what is true of it but for rounding.
struct Instant {
    double time_s;
    std::vector<AffineMap> maps;
    std::vector<double> weights;
    std::vector<Vec3> places;
    EngineBound box;

    double half_diagonal() const { return (0.5 * (box.high - box.low)).norm(); }
};

constexpr double audit_rounding = 0x1p-40; ///< of sizes: what is less is not said to be outside

/// A bound with so much more on all sides.
EngineBound grown(EngineBound bound);

/// All that the exact side reads of a clip of a body, with the character as one BV. Body and clip must stay alive.
class ExactClip {
public:
    ExactClip(const TimedBody& body, const TimedClip& clip);

    const Bvh& bvh() const { return bvh_; }

    /// Of a box at all times of the interval.
    exact::TimeVerdict over(double first_s, double last_s, const EngineBound& box) const;

    /// Whether the vertex is really outside at exactly this time; `direction` is -1 for balls.
    std::optional<Counterexample> confirm(double time_s, std::uint32_t vertex, int direction,
                                          const EngineBound& bound) const;

    /// Whether all vertices are inside where the matrices of the instant put them.
    bool holds_at(const Instant& at, const EngineBound& bound) const;

private:
    const TimedBody& body_;
    Bvh bvh_;
    exact::Verifier verifier_;
    std::unique_ptr<exact::MotionEnclosure> motion_;
    std::optional<exact::TimeChecker> check_;
};

} // namespace cinch
