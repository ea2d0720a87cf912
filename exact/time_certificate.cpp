// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/time_certificate.hpp"

#include <cmath>
#include <stdexcept>

#include "exact/certificate_lines.hpp"
#include "exact/sha256.hpp"

namespace cinch::exact {
namespace {

constexpr std::string_view format = "cinch times 2";

std::string hash_of_method(const Claim& claim, std::span<const double> any_weights)
{
    Sha256 hash;
    hash.add_text(format);
    hash.add_text(name_of(claim.methods));
    hash.add_text(std::to_string(claim.kdop));
    for (const double weight : any_weights)
        hash.add_text(number_text(weight));
    for (const std::string& part : claim.missing)
        hash.add_text(as_shown(part));
    return hash.hex();
}

std::string_view name_of(Curve::Interpolation interpolation)
{
    switch (interpolation) {
    case Curve::Interpolation::step:
        return "STEP";
    case Curve::Interpolation::linear:
        return "LINEAR";
    case Curve::Interpolation::cubic_spline:
        return "CUBICSPLINE";
    }
    throw std::logic_error("name_of: no interpolation");
}

std::string_view name_of(Curve::Target target)
{
    switch (target) {
    case Curve::Target::translation:
        return "translation";
    case Curve::Target::rotation:
        return "rotation";
    case Curve::Target::scale:
        return "scale";
    }
    throw std::logic_error("name_of: no target");
}

} // namespace

struct TimeCertificateWriter::Parts {
    std::size_t supports, kdop, clips, intervals = 0, clips_done = 0, interval = 0, infinite = 0, bounds = 0;
    Sha256 motion;
    Line line;
    LineSink sink;

    Parts(std::size_t bounds_of_all, std::size_t k, std::size_t clip_count, LineSink to)
        : supports(bounds_of_all), kdop(k), clips(clip_count), line([this](std::string_view text) {
              if (hashes) {
                  motion.add(text);
                  motion.add("\n");
              }
              sink(text);
          }),
          sink(std::move(to))
    {
    }
    bool hashes = false; // lines are motion

    void begin_clip(const std::string& name, double first_s, double last_s, std::size_t curves, std::size_t morphs,
                    std::size_t frames, std::size_t limits, std::size_t count)
    {
        if (clips_done == clips || interval != intervals || count == 0)
            throw std::invalid_argument("TimeCertificateWriter::clip: not what is claimed");
        ++clips_done;
        intervals = count;
        interval = 0;
        hashes = true;
        line.raw("{\"clip\":").text(name).raw(",\"first\":").number(first_s).raw(",\"last\":").number(last_s);
        line.raw(",\"curves\":").integer(curves).raw(",\"morphs\":").integer(morphs);
        line.raw(",\"frames\":").integer(frames).raw(",\"limits\":").integer(limits);
        line.raw(",\"intervals\":").integer(count).raw("}").end();
    }
    void keys(Curve::Interpolation interpolation, std::span<const double> times)
    {
        line.raw(",\"interpolation\":\"").raw(name_of(interpolation)).raw("\",\"times\":").numbers(times);
        line.raw(",\"values\":");
    }
};

TimeCertificateWriter::TimeCertificateWriter(const DeformableSurface& surface, const Bvh& bvh, const Claim& claim,
                                             const Character* character, std::optional<Enclosure> any_weights,
                                             std::size_t clips, LineSink sink)
    : parts_(new Parts(bvh.bvs.size() * static_cast<std::size_t>(claim.kdop), static_cast<std::size_t>(claim.kdop),
                       clips, std::move(sink)))
{
    std::vector<double> limits;
    if (any_weights)
        limits = {any_weights->low, any_weights->high};
    Line& line = parts_->line;
    line.raw("{\"certificate\":\"").raw(format).raw("\",\"method\":\"").raw(cinch::name_of(claim.methods));
    line.raw("\",\"kdop\":").integer(static_cast<std::size_t>(claim.kdop));
    line.raw(",\"vertices\":").integer(surface.mesh.vertices.size());
    line.raw(",\"triangles\":").integer(surface.mesh.triangles.size());
    line.raw(",\"nodes\":").integer(surface.weights.node_count).raw(",\"bvs\":").integer(bvh.bvs.size());
    line.raw(",\"bones\":").integer(character ? character->bones.size() : 0);
    line.raw(",\"targets\":").integer(character ? character->targets.size() : 0);
    line.raw(",\"weights\":").numbers(limits).raw(",\"clips\":").integer(clips);
    line.raw(claim.missing.empty() ? ",\"partial\":false" : ",\"partial\":true").raw(",\"missing\":");
    line.array(claim.missing, [&](const std::string& part) { line.text(part); });
    hash_surface(surface, hash_of_method(claim, limits), line);
    line.raw("}").end();
    write_body(surface, bvh, line);
    if (!character)
        return;
    parts_->hashes = true;
    for (std::size_t i = 0; i < character->bones.size(); ++i) {
        const Bone& bone = character->bones[i];
        line.raw("{\"bone\":").integer(i).raw(",\"parent\":").raw(std::to_string(bone.parent));
        line.raw(",\"translation\":").numbers(bone.translation).raw(",\"rotation\":").numbers(bone.rotation);
        line.raw(",\"scale\":").numbers(bone.scale).raw(",\"matrix\":");
        line.numbers(bone.is_matrix ? std::span<const double>(bone.matrix) : std::span<const double>());
        line.raw("}").end();
    }
    for (std::size_t j = 0; j < character->joints.size(); ++j) {
        const Joint& joint = character->joints[j];
        line.raw("{\"joint\":").integer(j).raw(",\"bone\":").integer(joint.bone);
        line.raw(",\"bind\":").numbers({&joint.inverse_bind.m[0][0], 12}).raw("}").end();
    }
    for (std::size_t i = 0; i < character->targets.size(); ++i) {
        const MorphTarget& target = character->targets[i];
        line.raw("{\"target\":").integer(i).raw(",\"weight\":").number(character->target_weights[i]);
        line.raw(",\"vertices\":");
        write_displacements(target, line);
    }
    parts_->hashes = false;
}

TimeCertificateWriter::~TimeCertificateWriter() = default;

void TimeCertificateWriter::clip(const Character::Animation& animation, double first_s, double last_s,
                                 std::size_t intervals)
{
    Parts& p = *parts_;
    p.begin_clip(animation.name, first_s, last_s, animation.curves.size(), animation.morphs.size(), 0, 0, intervals);
    for (std::size_t i = 0; i < animation.curves.size(); ++i) {
        const Curve& curve = animation.curves[i];
        p.line.raw("{\"curve\":").integer(i).raw(",\"bone\":").integer(curve.bone);
        p.line.raw(",\"moves\":\"").raw(name_of(curve.target)).raw("\"");
        p.keys(curve.interpolation, curve.time_s);
        const std::size_t size = curve.target == Curve::Target::rotation ? 4 : 3;
        p.line.array(curve.value, [&](const std::array<double, 4>& x) { p.line.numbers({x.data(), size}); });
        p.line.raw("}").end();
    }
    for (std::size_t i = 0; i < animation.morphs.size(); ++i) {
        const WeightCurve& curve = animation.morphs[i];
        p.line.raw("{\"morph\":").integer(i).raw(",\"target\":").integer(curve.first_target);
        p.line.raw(",\"count\":").integer(curve.count);
        p.keys(curve.interpolation, curve.time_s);
        p.line.numbers(curve.value).raw("}").end();
    }
    p.hashes = false;
}

void TimeCertificateWriter::clip(const Clip& frames, double first_s, double last_s, std::size_t intervals)
{
    Parts& p = *parts_;
    p.begin_clip(frames.name, first_s, last_s, 0, 0, frames.frame_count(), 0, intervals);
    for (std::size_t i = 0; i < frames.frame_count(); ++i) {
        const Clip::Frame maps = frames.frame(i);
        p.line.raw("{\"frame\":").integer(i).raw(",\"time\":").number(frames.time_s(i)).raw(",\"maps\":");
        p.line.array(maps, [&](const AffineMap& map) { p.line.numbers({&map.m[0][0], 12}); }).raw("}").end();
    }
    p.hashes = false;
}

void TimeCertificateWriter::poses(const std::string& name, std::span<const PoseLimit> limits, double time_s)
{
    Parts& p = *parts_;
    p.begin_clip(name, time_s, time_s, 0, 0, 0, limits.size(), 1);
    for (std::size_t i = 0; i < limits.size(); ++i) {
        p.line.raw("{\"limit\":").integer(i).raw(",\"angle\":").number(limits[i].angle);
        p.line.raw(",\"move\":").number(limits[i].move).raw("}").end();
    }
    p.hashes = false;
}

void TimeCertificateWriter::interval(double first_s, double last_s, std::span<const double> supports)
{
    Parts& p = *parts_;
    if (p.interval == p.intervals || supports.size() != p.supports)
        throw std::invalid_argument("TimeCertificateWriter::interval: not one of the clip");
    Line& line = p.line;
    line.raw("{\"interval\":").integer(p.interval).raw(",\"first\":").number(first_s);
    line.raw(",\"last\":").number(last_s).raw("}").end();
    for (std::size_t i = 0; i < supports.size() / p.kdop; ++i) {
        line.raw("{\"interval\":").integer(p.interval).raw(",\"bv\":").integer(i);
        line.raw(",\"bounds\":").numbers(supports.subspan(i * p.kdop, p.kdop)).raw("}").end();
    }
    for (const double x : supports)
        p.infinite += std::isinf(x);
    p.bounds += supports.size();
    ++p.interval;
}

void TimeCertificateWriter::end(const TimeVerdict& verdict)
{
    Parts& p = *parts_;
    if (p.clips_done != p.clips || p.interval != p.intervals)
        throw std::logic_error("TimeCertificateWriter::end: clips or intervals are missing");
    const std::size_t not_proven = verdict.violated + verdict.undecided;
    p.line.raw("{\"end\":\"").raw(format).raw("\",\"clips\":").integer(p.clips);
    p.line.raw(",\"proven\":").integer(p.bounds - p.infinite - not_proven).raw(",\"infinite\":").integer(p.infinite);
    p.line.raw(",\"violated\":").integer(not_proven);
    p.line.raw(",\"sha256\":{\"motion\":\"").raw(p.motion.hex()).raw("\"}}").end();
}

} // namespace cinch::exact
