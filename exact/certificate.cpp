// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/certificate.hpp"

#include <charconv>
#include <cmath>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "exact/sha256.hpp"

namespace cinch::exact {
namespace {

constexpr std::string_view format = "cinch 2";

std::string escaped(const std::string& text)
{
    return nlohmann::json(text).dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
}

/// Builds one line of JSON in a buffer that is reused.
class Line {
public:
    explicit Line(LineSink sink) : sink_(std::move(sink)) {}

    Line& raw(std::string_view text)
    {
        text_ += text;
        return *this;
    }
    Line& integer(std::size_t value) { return raw(std::to_string(value)); }
    Line& text(const std::string& value) { return raw(escaped(value)); }
    Line& number(double value) // "0x1.8p+0"; std::to_chars leaves out 0x
    {
        text_ += '"';
        if (std::signbit(value)) {
            text_ += '-';
            value = -value;
        }
        if (std::isfinite(value))
            text_ += "0x";
        char digits[32];
        text_.append(digits, std::to_chars(digits, digits + sizeof digits, value, std::chars_format::hex).ptr);
        text_ += '"';
        return *this;
    }
    template <class Range, class Write> Line& array(const Range& range, Write&& write)
    {
        text_ += '[';
        bool first = true;
        for (const auto& item : range) {
            if (!first)
                text_ += ',';
            first = false;
            write(item);
        }
        text_ += ']';
        return *this;
    }
    Line& numbers(std::span<const double> values)
    {
        return array(values, [&](double x) { number(x); });
    }
    Line& integers(std::span<const std::uint32_t> values)
    {
        return array(values, [&](std::uint32_t x) { integer(x); });
    }
    void end()
    {
        sink_(text_);
        text_.clear();
    }

private:
    LineSink sink_;
    std::string text_;
};

std::string hash_of_positions(const DeformableSurface& surface)
{
    Sha256 hash;
    for (const Vec3& v : surface.mesh.vertices)
        hash.add(std::span<const double>(v.data(), 3));
    return hash.hex();
}

std::string hash_of_triangles(const DeformableSurface& surface)
{
    Sha256 hash;
    for (const Triangle& t : surface.mesh.triangles)
        hash.add(std::span<const std::uint32_t>(t));
    return hash.hex();
}

std::string hash_of_weights(const DeformableSurface& surface)
{
    Sha256 hash;
    for (std::size_t k = 0; k < surface.mesh.vertices.size(); ++k) {
        const Weights::Row row = surface.weights.of(k);
        hash.add(static_cast<std::uint32_t>(row.node.size()));
        hash.add(row.node);
        hash.add(row.weight);
    }
    return hash.hex();
}

std::string hash_of_method(const Claim& claim, std::string_view shape)
{
    auto as_shown = [](const std::string& text) { // valid UTF-8
        return nlohmann::json::parse(escaped(text)).get<std::string>();
    };
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

} // namespace

struct CertificateWriter::Parts {
    Line line;
    std::size_t bvs, kdop;
    std::size_t frames_claimed, frames = 0;
    bool has_lambda;
    std::size_t proven = 0, infinite = 0, violated = 0;
    Sha256 transforms;
};

CertificateWriter::CertificateWriter(const DeformableSurface& surface, const Bvh& bvh, const Claim& claim,
                                     LineSink sink)
    : parts_(new Parts{Line(std::move(sink)),
                       bvh.bvs.size(),
                       static_cast<std::size_t>(claim.kdop),
                       claim.frames,
                       0,
                       claim.methods.within(box_methods) && claim.shape == RestShape::aabb,
                       0,
                       0,
                       0,
                       {}})
{
    Line& line = parts_->line;
    const std::string_view shape = claim.shape == RestShape::aabb ? "aabb" : "obb";
    line.raw("{\"certificate\":\"").raw(format).raw("\",\"method\":\"").raw(name_of(claim.methods));
    line.raw("\",\"rest_shape\":\"").raw(shape).raw("\",\"kdop\":").integer(parts_->kdop);
    line.raw(",\"vertices\":").integer(surface.mesh.vertices.size());
    line.raw(",\"triangles\":").integer(surface.mesh.triangles.size());
    line.raw(",\"nodes\":").integer(surface.weights.node_count).raw(",\"bvs\":").integer(bvh.bvs.size());
    line.raw(",\"frames\":").integer(claim.frames).raw(",\"clip\":").text(claim.clip);
    line.raw(claim.missing.empty() ? ",\"partial\":false" : ",\"partial\":true").raw(",\"missing\":");
    line.array(claim.missing, [&](const std::string& part) { line.text(part); });
    line.raw(",\"sha256\":{\"positions\":\"").raw(hash_of_positions(surface));
    line.raw("\",\"triangles\":\"").raw(hash_of_triangles(surface));
    line.raw("\",\"weights\":\"").raw(hash_of_weights(surface));
    line.raw("\",\"method\":\"").raw(hash_of_method(claim, shape)).raw("\"}}").end();
    for (std::size_t k = 0; k < surface.mesh.vertices.size(); ++k) {
        const Weights::Row row = surface.weights.of(k);
        line.raw("{\"vertex\":").integer(k).raw(",\"rest\":").numbers({surface.mesh.vertices[k].data(), 3});
        line.raw(",\"nodes\":").integers(row.node).raw(",\"weights\":").numbers(row.weight).raw("}").end();
    }
    for (std::size_t t = 0; t < surface.mesh.triangles.size(); ++t)
        line.raw("{\"triangle\":").integer(t).raw(",\"vertices\":").integers(surface.mesh.triangles[t]).raw("}").end();
    for (std::size_t i = 0; i < bvh.bvs.size(); ++i) {
        const Bv& bv = bvh.bvs[i];
        line.raw("{\"bv\":").integer(i);
        if (bv.is_leaf())
            line.raw(",\"triangles\":").integers(std::span(bvh.triangle).subspan(bv.first_triangle, bv.triangle_count));
        else
            line.raw(",\"children\":[").integer(bv.first_child).raw(",").integer(bv.first_child + 1).raw("]");
        line.raw("}").end();
    }
}

CertificateWriter::~CertificateWriter() = default;

void CertificateWriter::frame(double time_s, std::span<const AffineMap> maps, std::span<const double> supports,
                              const FrameVerdict& verdict)
{
    Parts& p = *parts_;
    if (p.frames == p.frames_claimed || supports.size() != p.bvs * p.kdop || verdict.failed.size() != supports.size())
        throw std::invalid_argument("CertificateWriter::frame: not a frame of what is claimed");
    p.transforms.add(time_s);
    for (const AffineMap& map : maps)
        p.transforms.add(std::span<const double>(&map.m[0][0], 12));
    Line& line = p.line;
    line.raw("{\"frame\":").integer(p.frames).raw(",\"time\":").number(time_s).raw(",\"maps\":");
    line.array(maps, [&](const AffineMap& map) { line.numbers({&map.m[0][0], 12}); }).raw("}").end();
    for (std::size_t i = 0; i < p.bvs; ++i) {
        line.raw("{\"frame\":").integer(p.frames).raw(",\"bv\":").integer(i);
        line.raw(",\"bounds\":").numbers(supports.subspan(i * p.kdop, p.kdop));
        if (p.has_lambda) {
            line.raw(",\"lambda\":[");
            for (std::size_t slot = i * p.kdop; slot < (i + 1) * p.kdop; ++slot) {
                if (slot > i * p.kdop)
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
    for (std::size_t slot = 0; slot < supports.size(); ++slot)
        ++(verdict.failed[slot] ? p.violated : std::isinf(supports[slot]) ? p.infinite : p.proven);
    ++p.frames;
}

void CertificateWriter::end()
{
    Parts& p = *parts_;
    if (p.frames != p.frames_claimed)
        throw std::logic_error("CertificateWriter::end: frames are missing");
    p.line.raw("{\"end\":\"").raw(format).raw("\",\"frames\":").integer(p.frames).raw(",\"proven\":").integer(p.proven);
    p.line.raw(",\"infinite\":").integer(p.infinite).raw(",\"violated\":").integer(p.violated);
    p.line.raw(",\"sha256\":{\"transforms\":\"").raw(p.transforms.hex()).raw("\"}}").end();
}

} // namespace cinch::exact
