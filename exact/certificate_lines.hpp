// SPDX-License-Identifier: GPL-3.0-or-later
// Internal to exact/: how certificates are written.
#pragma once

#include <charconv>
#include <cmath>

#include "exact/certificate.hpp"

namespace cinch::exact {

/// As a text of JSON, in ASCII; what is no UTF-8 is replaced.
std::string escaped(const std::string& text);
/// The text that a reader of escaped(text) has.
std::string as_shown(const std::string& text);

/// "0x1.8p+0".
inline std::string number_text(double value)
{
    std::string out;
    if (std::signbit(value)) {
        out = "-";
        value = -value;
    }
    if (std::isfinite(value)) // std::to_chars leaves it out
        out += "0x";
    char digits[32];
    return out.append(digits, std::to_chars(digits, digits + sizeof digits, value, std::chars_format::hex).ptr);
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
    Line& number(double value) { return raw("\"").raw(number_text(value)).raw("\""); }
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

/// A certificate's "sha256" of positions, triangles and weights, with their names, and what follows of the method and,
/// where there are any, of morph targets.
void hash_surface(const DeformableSurface& surface, const std::string& method, Line& line,
                  const std::string& targets = {});
/// Its records of vertices, triangles and BVs.
void write_body(const DeformableSurface& surface, const Bvh& bvh, Line& line);
/// The rest of a morph target's record, after "vertices":.
void write_displacements(const MorphTarget& target, Line& line);

} // namespace cinch::exact
