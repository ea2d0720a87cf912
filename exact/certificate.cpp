// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/certificate.hpp"

#include <charconv>
#include <cmath>

namespace cinch::exact {
namespace {

/// Builds one line of JSON in a buffer that is reused.
class Line {
public:
    explicit Line(const LineSink& sink) : sink_(sink) {}

    Line& raw(std::string_view text)
    {
        text_ += text;
        return *this;
    }
    Line& integer(std::size_t value) { return raw(std::to_string(value)); }
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
    const LineSink& sink_;
    std::string text_;
};

} // namespace

void certify_rest(const DeformableSurface& surface, const Bvh& bvh, Methods methods, int kdop, std::size_t frames, const LineSink& sink, RestShape shape)
{
    Line line(sink);
    line.raw(R"({"certificate":"cinch 1","vertices":)").integer(surface.mesh.vertices.size());
    line.raw(",\"triangles\":").integer(surface.mesh.triangles.size()).raw(",\"nodes\":").integer(surface.weights.node_count);
    line.raw(",\"bvs\":").integer(bvh.bvs.size()).raw(",\"frames\":").integer(frames).raw(",\"method\":\"").raw(name_of(methods));
    line.raw(methods.within(box_methods) && shape == RestShape::aabb ? "\",\"weight_space\":true" : "\",\"weight_space\":false").raw(",\"kdop\":").integer(static_cast<std::size_t>(kdop)).raw("}").end();
    for (std::size_t k = 0; k < surface.mesh.vertices.size(); ++k) {
        const Weights::Row row = surface.weights.of(k);
        line.raw("{\"vertex\":").integer(k).raw(",\"rest\":").numbers({surface.mesh.vertices[k].data(), 3});
        line.raw(",\"nodes\":").integers(row.node).raw(",\"weights\":").numbers(row.weight).raw("}").end();
    }
    for (std::size_t i = 0; i < bvh.bvs.size(); ++i) {
        const Bv& bv = bvh.bvs[i];
        const RestBv rest = bvh.rest(i);
        line.raw("{\"bv\":").integer(i);
        if (bv.is_leaf())
            line.raw(",\"triangles\":").array(std::span(bvh.triangle).subspan(bv.first_triangle, bv.triangle_count),
                                              [&](std::uint32_t t) { line.integers(surface.mesh.triangles[t]); });
        else
            line.raw(",\"children\":[").integer(bv.first_child).raw(",").integer(bv.first_child + 1).raw("]");
        line.raw(",\"centre\":").numbers({bv.box.centre.data(), 3}).raw(",\"half\":").numbers({bv.box.half.data(), 3});
        line.raw(",\"nodes\":").integers(rest.node).raw(",\"l\":").numbers(rest.space.l).raw(",\"h\":").numbers(rest.space.h).raw("}").end();
    }
}

void certify_frame(std::size_t frame, std::span<const AffineMap> maps, Methods methods, int kdop, std::span<const double> supports,
                   const FrameVerdict& verdict, const LineSink& sink, RestShape shape)
{
    Line line(sink);
    line.raw("{\"frame\":").integer(frame).raw(",\"maps\":").array(maps, [&](const AffineMap& map) { line.numbers({&map.m[0][0], 12}); }).raw("}").end();
    const auto k = static_cast<std::size_t>(kdop);
    for (std::size_t i = 0; i < supports.size() / k; ++i) {
        line.raw("{\"frame\":").integer(frame).raw(",\"bv\":").integer(i).raw(",\"bounds\":").numbers(supports.subspan(i * k, k));
        if (methods.within(box_methods) && shape == RestShape::aabb) {
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
}

} // namespace cinch::exact
