// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "exact/motion_enclosure.hpp"
#include "experiments/audit/audit.hpp"
#include "experiments/bake/timed_body.hpp"
#include "experiments/measure/verdict.hpp"

namespace cinch {

/// What is known of a formula on a clip.
enum class AuditVerdict {
    proven,    ///< at all real times, by the exact side
    touches,   ///< the same of a bound grown by 2^-40 of its size: what rounding left out, or touches, is in there
    holds,     ///< at all instants that were tried, each by the exact side; nothing is known between them
    refuted,   ///< by a vertex that is outside at an instant, in real arithmetic
    undecided, ///< none of these
};
std::string name_of(AuditVerdict verdict);

/// A vertex outside of a bound, in real arithmetic.
struct Counterexample {
    double time_s = 0; ///< exactly this double
    std::uint32_t vertex = 0;
    int direction = -1;                    ///< as in axes_of(6); -1: out of a ball
    double bound = 0;                      ///< the support, or the radius of the ball
    Vec3 centre = Vec3::Zero();            ///< of the ball
    std::array<exact::Enclosure, 3> place; ///< of the vertex
    double beyond = 0;                     ///< by about so much
};

/// One formula on one clip.
struct AuditedFormula {
    std::string formula, used_by;
    bool still = false; ///< one bound for the whole clip
    AuditVerdict verdict = AuditVerdict::undecided;
    std::size_t instants = 0; ///< that were tried
    std::optional<Counterexample> worst = {};
    double worst_share = 0;               ///< beyond, of the surface's half diagonal then
    double mean_ratio = 0, max_ratio = 0; ///< its half diagonal (of a ball the radius) / that of the true box
    std::optional<Range> ns = {};         ///< of a bound; none where there is one for the clip
};

/// All formulas of engines, then our own, on one clip of a body.
std::vector<AuditedFormula> audit_clip(const TimedBody& body, const TimedClip& clip, const AuditOptions& options);

} // namespace cinch
