// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cinch/io.hpp"
#include "exact/certificate.hpp"
#include "exact/time_check.hpp"
#include "toolkit/time/pose_limits.hpp"

namespace cinch::exact {

/// Writes a certificate of bounds over intervals of time: JSON Lines that carry everything needed to prove them again
/// without this program. Doubles and hashes are as in CertificateWriter's. In this order:
///
///   {"certificate":"cinch times 2", "method", "kdop", "vertices", "triangles", "nodes", "bvs", "bones", "targets",
///    "weights": none, or the least and the greatest that any morph target may have at any time, "clips", "partial",
///    "missing", "sha256": {"positions", "triangles", "weights", "method"}}
///   per vertex, triangle, BV  as in CertificateWriter's
///   per bone                  {"bone", "parent": before it, or -1, "translation", "rotation": x, y, z, w, "scale",
///                              "matrix": empty, or 16 numbers by columns, which count where no curve moves the bone}
///   per simulation node       {"joint", "bone", "bind": 12 numbers, row-major}; only where there are bones
///   per morph target          {"target", "weight": where no curve sets it, "vertices", "displacements"}
///   per clip                  {"clip": name, "first", "last": seconds, "curves", "morphs", "frames", "limits",
///                              "intervals"}
///     per curve               {"curve", "bone", "moves": "translation", "rotation" or "scale",
///                              "interpolation": as in glTF, "times", "values"}
///     per curve of weights    {"morph", "target": the first, "count", "interpolation", "times", "values"}
///     per frame               {"frame", "time", "maps"}; frames instead of curves are interpolated entry by entry
///     per limit               {"limit": bone, "angle": rad, "move"}; of every bone, or of none
///     per interval            {"interval", "first", "last"}; they follow each other from the clip's first to its last
///       and per BV            {"interval", "bv", "bounds"}
///   last                      {"end":"cinch times 2", "clips", "proven", "infinite", "violated",
///                              "sha256": {"motion"}}
///
/// The statement: with weights w of the vertex's simulation nodes, T_j(t) the product of the transforms of the bones
/// above joint j, each translation · rotation · scale by glTF 2.0's interpolation in real arithmetic, and j's bind, and
/// a_i(t) weights of targets, or any within the limits that the header has, Σ w_j T_j(t) (rest + Σ a_i(t) d_i) lies
/// within the bounds at all real times of the closed interval. Where there are limits, the one interval is an instant,
/// and the statement is of every pose in which each bone's transform to its parent, x ↦ t + M x without curves, is some
/// x ↦ t' + E M x, |t' − t| ≤ move, E a rotation by at most `angle`. The hash of motion is over bones, joints, targets
/// and every clip, in that order, as written.
class TimeCertificateWriter {
public:
    /// `character`: none of clips that are frames. `any_weights`: of all morph targets at all times, instead of what
    /// file and clips say. All must stay alive; `claim`'s clip, frames and shape are not used.
    TimeCertificateWriter(const DeformableSurface& surface, const Bvh& bvh, const Claim& claim,
                          const Character* character, std::optional<Enclosure> any_weights, std::size_t clips,
                          LineSink line);
    ~TimeCertificateWriter();

    /// Begins a clip of so many intervals from `first_s` to `last_s`, of a character or of frames.
    void clip(const Character::Animation& animation, double first_s, double last_s, std::size_t intervals);
    void clip(const Clip& frames, double first_s, double last_s, std::size_t intervals);
    /// Every pose within limits, one per bone, at an instant of the file's pose.
    void poses(const std::string& name, std::span<const PoseLimit> limits, double time_s);
    /// The next interval of it, with the bounds of all BVs.
    void interval(double first_s, double last_s, std::span<const double> supports);
    /// After the last one; `verdict` is that of all bounds.
    void end(const TimeVerdict& verdict);

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

} // namespace cinch::exact
