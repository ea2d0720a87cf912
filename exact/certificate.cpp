// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/certificate.hpp"

#include <cmath>
#include <stdexcept>

#include "exact/certificate_lines.hpp"
#include "exact/sha256.hpp"

namespace cinch::exact {
namespace {

constexpr std::string_view format = "cinch 2";

std::string hash_of_method(const Claim& claim, std::string_view shape)
{
    Sha256 hash;
    hash.add_text(format);
    hash.add_text(name_of(claim.methods));
    hash.add_text(shape);
    hash.add_text(std::to_string(claim.kdop));
    hash.add_text(as_shown(claim.clip));
    for (const std::string& part : claim.missing)
        hash.add_text(as_shown(part));
    return hash.hex();
}

void add_frame(const FramePose& pose, Sha256& hash)
{
    hash.add(pose.time_s);
    for (const AffineMap& map : pose.maps)
        hash.add(std::span<const double>(&map.m[0][0], 12));
    hash.add(pose.weights);
}

std::string hash_of_targets(std::span<const MorphTarget> targets)
{
    Sha256 hash;
    for (const MorphTarget& target : targets) {
        hash.add(static_cast<std::uint32_t>(target.vertex.size()));
        hash.add(std::span<const std::uint32_t>(target.vertex));
        for (const Vec3& d : target.displacement)
            hash.add(std::span<const double>(d.data(), 3));
    }
    return hash.hex();
}

} // namespace

struct CertificateWriter::Parts {
    Claim claim;
    LineSink line;
    std::size_t supports, frames = 0;
    BoundCounts counts;
    Sha256 transforms;
};

void write_surface(const DeformableSurface& surface, const Bvh& bvh, const Claim& claim, const LineSink& sink)
{
    for (const MorphTarget& target : claim.targets)
        if (!target.half.empty())
            throw std::invalid_argument("write_surface: displacements are not exact");
    Line line(sink);
    const std::string_view shape = claim.shape == RestShape::aabb ? "aabb" : "obb";
    line.raw("{\"certificate\":\"").raw(format).raw("\",\"method\":\"").raw(name_of(claim.methods));
    line.raw("\",\"rest_shape\":\"").raw(shape).raw("\",\"kdop\":").integer(static_cast<std::size_t>(claim.kdop));
    line.raw(",\"vertices\":").integer(surface.mesh.vertices.size());
    line.raw(",\"triangles\":").integer(surface.mesh.triangles.size());
    line.raw(",\"nodes\":").integer(surface.weights.node_count).raw(",\"bvs\":").integer(bvh.bvs.size());
    if (!claim.targets.empty())
        line.raw(",\"targets\":").integer(claim.targets.size());
    line.raw(",\"frames\":").integer(claim.frames).raw(",\"clip\":").text(claim.clip);
    line.raw(claim.missing.empty() ? ",\"partial\":false" : ",\"partial\":true").raw(",\"missing\":");
    line.array(claim.missing, [&](const std::string& part) { line.text(part); });
    hash_surface(surface, hash_of_method(claim, shape), line,
                 claim.targets.empty() ? std::string() : hash_of_targets(claim.targets));
    line.raw("}").end();
    write_body(surface, bvh, line);
    for (std::size_t i = 0; i < claim.targets.size(); ++i) {
        line.raw("{\"target\":").integer(i).raw(",\"vertices\":");
        write_displacements(claim.targets[i], line);
    }
}

BoundCounts write_frame(const Claim& claim, std::size_t frame, const FramePose& pose, std::span<const double> supports,
                        const FrameVerdict& verdict, const LineSink& sink)
{
    const auto k = static_cast<std::size_t>(claim.kdop);
    const bool has_lambda =
        claim.methods.within(box_methods) && claim.shape == RestShape::aabb && claim.targets.empty();
    if (frame >= claim.frames || supports.size() % k != 0 || verdict.failed.size() != supports.size() ||
        pose.weights.size() != claim.targets.size())
        throw std::invalid_argument("write_frame: not a frame of what is claimed");
    Line line(sink);
    line.raw("{\"frame\":").integer(frame).raw(",\"time\":").number(pose.time_s).raw(",\"maps\":");
    line.array(pose.maps, [&](const AffineMap& map) { line.numbers({&map.m[0][0], 12}); });
    if (!claim.targets.empty())
        line.raw(",\"morphs\":").numbers(pose.weights);
    line.raw("}").end();
    for (std::size_t i = 0; i < supports.size() / k; ++i) {
        line.raw("{\"frame\":").integer(frame).raw(",\"bv\":").integer(i);
        line.raw(",\"bounds\":").numbers(supports.subspan(i * k, k));
        if (has_lambda) {
            line.raw(",\"lambda\":[");
            for (std::size_t slot = i * k; slot < (i + 1) * k; ++slot) {
                if (slot > i * k)
                    line.raw(",");
                const auto fraction = verdict.exact_lambda.find(slot);
                if (fraction == verdict.exact_lambda.end())
                    line.number(verdict.lambda[slot]);
                else
                    line.raw("\"").raw(fraction->second).raw("\"");
            }
            line.raw("]");
        }
        line.raw("}").end();
    }
    BoundCounts counts;
    for (std::size_t slot = 0; slot < supports.size(); ++slot)
        ++(verdict.failed[slot] ? counts.violated : std::isinf(supports[slot]) ? counts.infinite : counts.proven);
    return counts;
}

void write_end(std::size_t frames, const BoundCounts& counts, const std::string& transforms, const LineSink& sink)
{
    Line line(sink);
    line.raw("{\"end\":\"").raw(format).raw("\",\"frames\":").integer(frames);
    line.raw(",\"proven\":").integer(counts.proven).raw(",\"infinite\":").integer(counts.infinite);
    line.raw(",\"violated\":").integer(counts.violated);
    line.raw(",\"sha256\":{\"transforms\":\"").raw(transforms).raw("\"}}").end();
}

std::string hash_of_transforms(const Clip& clip)
{
    Sha256 hash;
    for (std::size_t f = 0; f < clip.frame_count(); ++f)
        add_frame({clip.time_s(f), clip.frame(f), clip.weights(f)}, hash);
    return hash.hex();
}

CertificateWriter::CertificateWriter(const DeformableSurface& surface, const Bvh& bvh, const Claim& claim,
                                     LineSink line)
    : parts_(new Parts{claim, std::move(line), bvh.bvs.size() * static_cast<std::size_t>(claim.kdop), 0, {}, {}})
{
    write_surface(surface, bvh, claim, parts_->line);
}

CertificateWriter::~CertificateWriter() = default;

void CertificateWriter::frame(const FramePose& pose, std::span<const double> supports, const FrameVerdict& verdict)
{
    Parts& p = *parts_;
    if (supports.size() != p.supports)
        throw std::invalid_argument("CertificateWriter::frame: not a frame of what is claimed");
    const BoundCounts counts = write_frame(p.claim, p.frames, pose, supports, verdict, p.line);
    add_frame(pose, p.transforms);
    p.counts.proven += counts.proven;
    p.counts.infinite += counts.infinite;
    p.counts.violated += counts.violated;
    ++p.frames;
}

void CertificateWriter::end()
{
    Parts& p = *parts_;
    if (p.frames != p.claim.frames)
        throw std::logic_error("CertificateWriter::end: frames are missing");
    write_end(p.frames, p.counts, p.transforms.hex(), p.line);
}

} // namespace cinch::exact
