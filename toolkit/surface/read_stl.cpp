// SPDX-License-Identifier: Apache-2.0
// STL, ascii and binary. Every triangle has three vertices of its own, as in the file.
#include <bit>
#include <cmath>
#include <cstring>

#include "cinch/environment.hpp"
#include "toolkit/surface/read_mesh.hpp"
#include "toolkit/surface/text_scan.hpp"

namespace cinch {
namespace {

constexpr std::size_t header_bytes = 84, triangle_bytes = 50;

std::uint32_t little_u32(std::string_view bytes, std::size_t at)
{
    std::uint32_t value = 0;
    for (int i = 3; i >= 0; --i)
        value = value << 8 | static_cast<unsigned char>(bytes[at + static_cast<std::size_t>(i)]);
    return value;
}

MeshFile parse_binary(std::string_view bytes, const std::string& file)
{
    const std::uint32_t triangles = little_u32(bytes, 80);
    MeshFile out;
    TriangleMesh& mesh = out.mesh;
    mesh.vertices.reserve(3 * static_cast<std::size_t>(triangles));
    mesh.triangles.reserve(triangles);
    for (std::uint32_t t = 0; t < triangles; ++t) {
        const std::size_t first = header_bytes + triangle_bytes * t + 12; // after the normal
        for (std::size_t corner = 0; corner < 3; ++corner) {
            Vec3 v;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const std::size_t at = first + 12 * corner + 4 * axis;
                const float x = std::bit_cast<float>(little_u32(bytes, at));
                if (!std::isfinite(x))
                    throw InputError::at_byte(file, at,
                                              "a coordinate of triangle " + std::to_string(t) + " is not finite");
                v[static_cast<int>(axis)] = x;
            }
            mesh.vertices.push_back(v);
        }
        mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    return out;
}

void expect(TextScan& scan, std::string_view wanted)
{
    const std::string_view word = scan.word_across_lines("'" + std::string(wanted) + "'");
    if (!is_keyword(word, wanted))
        scan.fail("expected '" + std::string(wanted) + "', found '" + printable(word) + "'");
}

MeshFile parse_ascii(std::string_view bytes, const std::string& file)
{
    TextScan scan(bytes, file);
    MeshFile out;
    TriangleMesh& mesh = out.mesh;
    bool any_solid = false;
    while (scan.next_line()) { // several solids may follow each other
        std::string_view word = scan.word();
        if (!is_keyword(word, "solid"))
            scan.fail("expected 'solid', found '" + printable(word) + "'");
        any_solid = true;
        if (!scan.next_line()) // the name, if any, ends with its line
            scan.fail("the file ends where 'facet' or 'endsolid' was expected");
        while (!is_keyword(word = scan.word_across_lines("'facet' or 'endsolid'"), "endsolid")) {
            if (!is_keyword(word, "facet"))
                scan.fail("expected 'facet' or 'endsolid', found '" + printable(word) + "'");
            expect(scan, "normal");
            for (int i = 0; i < 3; ++i)
                scan.word_across_lines("a normal"); // not used, and often nonsense in real files
            expect(scan, "outer");
            expect(scan, "loop");
            const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
            for (int corner = 0; corner < 3; ++corner) {
                expect(scan, "vertex");
                Vec3 v;
                for (int axis = 0; axis < 3; ++axis)
                    v[axis] = scan.number(scan.word_across_lines("a coordinate"), "a coordinate");
                mesh.vertices.push_back(v);
            }
            word = scan.word_across_lines("'endloop'");
            if (!is_keyword(word, "endloop"))
                scan.fail("expected 'endloop' after 3 vertices, found '" + printable(word) + "'");
            expect(scan, "endfacet");
            mesh.triangles.push_back({first, first + 1, first + 2});
        }
    }
    if (!any_solid)
        throw InputError::in_file(file, "has no 'solid' and is too short for binary STL");
    return out;
}

} // namespace

MeshFile parse_stl(std::string_view bytes, const std::string& file)
{
    require_default_arithmetic();
    // Binary files may begin with "solid" too, so the count decides. Below 4 GiB it is below 2^27, so the byte of its
    // highest bits is below 8, and no such byte is in a text.
    const bool has_header = bytes.size() >= header_bytes;
    const bool is_binary = has_header && static_cast<unsigned char>(bytes[83]) < 8;
    std::size_t first_word = bytes.starts_with("\xef\xbb\xbf") ? 3 : 0; // a UTF-8 byte order mark
    first_word = bytes.find_first_not_of(" \t\r\n\f\v", first_word);
    if (!is_binary && first_word != std::string_view::npos && is_keyword(bytes.substr(first_word, 5), "solid"))
        return parse_ascii(bytes, file);
    if (!has_header)
        throw InputError::at_byte(file, bytes.size(), "the file ends inside the 84-byte header of binary STL");
    const std::uint64_t declared = little_u32(bytes, 80), wanted = header_bytes + triangle_bytes * declared;
    if (bytes.size() < wanted)
        throw InputError::at_byte(file, 80,
                                  "binary STL declares " + std::to_string(declared) + " triangles, which take " +
                                      std::to_string(wanted) + " bytes; the file has " + std::to_string(bytes.size()));
    if (const std::uint64_t trailing = bytes.size() - wanted)
        throw InputError::at_byte(file, wanted,
                                  std::to_string(trailing) + " trailing " + (trailing == 1 ? "byte" : "bytes") +
                                      " after the " + std::to_string(declared) +
                                      (declared == 1 ? " triangle" : " triangles") +
                                      " that binary STL declares; correct the count at byte 80, or cut them off");
    return parse_binary(bytes, file);
}

} // namespace cinch
