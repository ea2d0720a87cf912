// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "exact/time_certificate.hpp"
#include "experiments/bake/baked_clip.hpp"
#include "experiments/bake/timed_body.hpp"
#include "experiments/report/line_file.hpp"

namespace cinch {

/// Proves baked bounds of one of a body's clips.
exact::TimeVerdict prove(const TimedBody& body, const TimedClip& clip, const Bvh& bvh, int kdop,
                         std::span<const BakedInterval> intervals);

/// A certificate of bounds over time, compressed if its name ends in ".gz"; there when it is whole.
class TimeProofFile {
public:
    /// Of all clips of the body. Throws InputError.
    TimeProofFile(const std::string& name, const TimedBody& body, const Bvh& bvh, Methods methods, int kdop);
    /// The next clip's. Throws Interrupted.
    void add(const TimedClip& clip, std::span<const BakedInterval> intervals);
    /// After all of them; `verdict` counts what is known not to hold.
    void commit(const exact::TimeVerdict& verdict);

private:
    const TimedBody& body_;
    LineFile file_;
    exact::TimeCertificateWriter writer_;
};

/// "N bounds for all times, P proven, V violated", with what is undecided; and where the worst vertex is. `of`: times
/// or poses.
std::string verdict_line(const exact::TimeVerdict& verdict, std::string_view of = "times");
std::string worst_line(const exact::TimeVerdict& verdict);

} // namespace cinch
