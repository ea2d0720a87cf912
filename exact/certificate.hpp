// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cinch/deform.hpp"
#include "exact/verifier.hpp"

namespace cinch::exact {

/// Takes one line, without its end. Called in order.
using LineSink = std::function<void(std::string_view)>;

/// What a certificate says about one surface's BVH, beside the surface.
struct Claim {
    Methods methods = Method::best;
    int kdop = 6;
    RestShape shape = RestShape::aabb;
    std::string clip;                 ///< name of the motion
    std::size_t frames = 0;           ///< how many will follow
    std::vector<std::string> missing; ///< parts of the input that the surface lacks; any make the certificate partial
    std::span<const MorphTarget> targets = {}; ///< that displace the surface in its frames; exact, not boxes
};

/// A frame of a claim.
struct FramePose {
    double time_s = 0;
    std::span<const AffineMap> maps;      ///< one per simulation node
    std::span<const double> weights = {}; ///< one per morph target
};

/// How many bounds of a certificate's frames are what.
struct BoundCounts {
    std::size_t proven = 0, infinite = 0, violated = 0;
};

/// Writes a certificate: JSON Lines that carry everything needed to prove the bounds again without this program.
/// Doubles are texts of hexadecimal floats; hashes are SHA-256 over little-endian numbers, of 4 bytes (indices, counts)
/// and 8 (doubles). In this order:
///
///   {"certificate":"cinch 2", "method", "rest_shape", "kdop", "vertices", "triangles", "nodes", "bvs", "frames",
///    "clip", "partial", "missing", "sha256": {"positions", "triangles", "weights", "method"}}
///   per vertex        {"vertex", "rest", "nodes", "weights"}
///   per triangle      {"triangle", "vertices"}
///   per BV            {"bv", "triangles": indices of a leaf's, or "children"}
///   per morph target  {"target", "vertices", "displacements"}
///   per frame         {"frame", "time": seconds, "maps": 12 numbers per simulation node, row-major}
///     and per BV      {"frame", "bv", "bounds", "lambda"}, k of each, in the order of axes_of(k)
///   last              {"end":"cinch 2", "frames", "proven", "infinite", "violated": numbers of bounds,
///                      "sha256": {"transforms"}}
///
/// Where morph targets displace the surface, the header also has their number, "targets", and their hash, frames have
/// "morphs", a weight per target, and the statement is of Σ w_j T_j (rest + Σ a_i d_i). The hash of targets is over
/// each one's number of vertices, these and their displacements. The hash of weights is over each vertex's count,
/// simulation nodes and weights, that of transforms over each frame's time, maps and weights of targets, that of the
/// method over format, method, rest shape, k, clip and missing, each as its length, a colon and its bytes. "lambda" is
/// there for the box_methods over axis-aligned rest boxes: D(λ) ≤ bound; where no double λ does it, λ is "p/q"; where
/// vertices are displaced there is none. Rest boxes and weight intervals are not in it: whoever checks it derives them
/// from the vertices.
class CertificateWriter {
public:
    /// Writes all that does not change from frame to frame.
    CertificateWriter(const DeformableSurface& surface, const Bvh& bvh, const Claim& claim, LineSink line);
    ~CertificateWriter();

    /// `verdict` is Verifier::check's of these supports. Throws std::invalid_argument for what is no frame of the
    /// claim.
    void frame(const FramePose& pose, std::span<const double> supports, const FrameVerdict& verdict);
    /// After the last of the frames claimed; a certificate without an end proves nothing.
    void end();

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

/// The same in parts, which may be written by different processes: the lines of the surface, those of each frame, and
/// the last one make a certificate when they stand one after the other.
void write_surface(const DeformableSurface& surface, const Bvh& bvh, const Claim& claim, const LineSink& line);
/// A frame of the claim as in CertificateWriter::frame, by its number.
BoundCounts write_frame(const Claim& claim, std::size_t frame, const FramePose& pose, std::span<const double> supports,
                        const FrameVerdict& verdict, const LineSink& line);
/// `transforms` is hash_of_transforms of all frames.
void write_end(std::size_t frames, const BoundCounts& counts, const std::string& transforms, const LineSink& line);
std::string hash_of_transforms(const Clip& clip);

} // namespace cinch::exact
