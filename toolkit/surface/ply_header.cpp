// SPDX-License-Identifier: Apache-2.0
#include "toolkit/surface/ply_header.hpp"

#include "cinch/surface.hpp"
#include "toolkit/surface/text_scan.hpp"

namespace cinch::ply {
namespace {

std::optional<Scalar> scalar_named(std::string_view name)
{
    static constexpr std::pair<std::string_view, Scalar> names[] = {
        {"char", Scalar::i8},   {"int8", Scalar::i8},     {"uchar", Scalar::u8},   {"uint8", Scalar::u8},
        {"short", Scalar::i16}, {"int16", Scalar::i16},   {"ushort", Scalar::u16}, {"uint16", Scalar::u16},
        {"int", Scalar::i32},   {"int32", Scalar::i32},   {"uint", Scalar::u32},   {"uint32", Scalar::u32},
        {"float", Scalar::f32}, {"float32", Scalar::f32}, {"double", Scalar::f64}, {"float64", Scalar::f64}};
    for (const auto& [known, type] : names)
        if (name == known)
            return type;
    return std::nullopt;
}

Scalar scalar_type(TextScan& scan)
{
    const std::string_view word = scan.word();
    const auto type = scalar_named(word);
    if (!type)
        scan.fail("unknown property type '" + printable(word) + "'");
    return *type;
}

} // namespace

Header read_header(std::string_view bytes, const std::string& file)
{
    TextScan scan(bytes, file);
    if (!scan.next_line() || scan.word() != "ply")
        throw InputError::at_line(file, 1, "the first line of a PLY file must be 'ply'");
    Header header;
    bool has_format = false;
    for (;;) {
        if (!scan.next_line())
            scan.fail("the file ends inside the header; 'end_header' is missing");
        const std::string_view keyword = scan.word();
        if (keyword == "format") {
            const std::string_view name = scan.word();
            if (name == "ascii")
                header.format = Format::ascii;
            else if (name == "binary_little_endian")
                header.format = Format::little;
            else if (name == "binary_big_endian")
                header.format = Format::big;
            else
                scan.fail("unknown format '" + printable(name) + "'");
            has_format = true;
        } else if (keyword == "element") {
            Element element;
            element.name = scan.word();
            const std::int64_t count = scan.integer(scan.word(), "the number of elements");
            if (count < 0)
                scan.fail("the number of elements is negative: " + std::to_string(count));
            element.count = static_cast<std::uint64_t>(count);
            header.elements.push_back(std::move(element));
        } else if (keyword == "property") {
            if (header.elements.empty())
                scan.fail("a property before any element");
            Property property;
            std::string_view type = scan.word();
            if (type == "list") {
                property.list_size_type = scalar_type(scan);
                if (*property.list_size_type >= Scalar::f32)
                    scan.fail("a list whose size is not an integer");
                property.type = scalar_type(scan);
            } else if (const auto scalar = scalar_named(type)) {
                property.type = *scalar;
            } else {
                scan.fail("unknown property type '" + printable(type) + "'");
            }
            const std::string_view name = scan.word();
            if (name.empty())
                scan.fail("a property without a name");
            property.name = name;
            header.elements.back().properties.push_back(std::move(property));
        } else if (keyword == "end_header") {
            break;
        } else if (keyword != "comment" && keyword != "obj_info") {
            scan.fail("unknown header line '" + printable(keyword) + "'");
        }
    }
    if (!has_format)
        scan.fail("the header has no format line");
    header.body = scan.byte();
    header.body_line = scan.line();
    const std::size_t line_end = bytes.find_first_not_of(" \t", header.body);
    if (line_end != std::string_view::npos && (bytes[line_end] == '\r' || bytes[line_end] == '\n'))
        header.body = line_end;
    // The body starts right after the line end, which is like that of the first line: after a lone CR, a byte 10 is
    // data.
    const std::size_t first_end = bytes.find_first_of("\r\n");
    const bool lone_cr = bytes[first_end] == '\r' && bytes[first_end + 1] != '\n'; // there are more lines
    if (header.body < bytes.size() && bytes[header.body] == '\r')
        ++header.body;
    if (!lone_cr && header.body < bytes.size() && bytes[header.body] == '\n')
        ++header.body;
    return header;
}

} // namespace cinch::ply
