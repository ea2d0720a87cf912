// SPDX-License-Identifier: Apache-2.0
// Geomview OFF in its three-dimensional ascii forms: [ST][C][N]OFF. One vertex and one face per line; what follows
// the coordinates or the indices on a line (normals, colours) is passed over.
#include <algorithm>

#include "toolkit/surface/read_mesh.hpp"
#include "toolkit/surface/text_scan.hpp"

namespace cinch {
namespace {

bool is_three_dimensional(std::string_view keyword)
{
    for (std::string_view known : {"OFF", "COFF", "NOFF", "CNOFF", "STOFF", "STCOFF", "STNOFF", "STCNOFF"})
        if (keyword == known)
            return true;
    return false;
}

std::size_t declared(const TextScan& scan, std::string_view word, std::string_view what)
{
    const std::int64_t count = scan.integer(word, what);
    if (count < 0)
        scan.fail(std::string(what) + " is negative: " + std::to_string(count));
    // A vertex takes at least six bytes ("0 0 0\n") and a face eight ("3 0 0 0\n"), but for a last line without an end.
    if (static_cast<std::uint64_t>(count) > scan.bytes_left())
        scan.fail(std::string(what) + " is " + std::to_string(count) + ", but only " + std::to_string(scan.bytes_left()) +
                  " bytes follow");
    return static_cast<std::size_t>(count);
}

} // namespace

TriangleMesh parse_off(std::string_view bytes, const std::string& file)
{
    TextScan scan(bytes, file, '#');
    std::string_view word = scan.word_across_lines("the word OFF");
    if (is_three_dimensional(word)) {
        word = scan.word_across_lines("the number of vertices");
        if (word == "BINARY")
            scan.fail("binary OFF is not supported; convert it to ascii OFF or to PLY");
    } else if (!(word[0] >= '0' && word[0] <= '9')) { // the keyword may be left out
        scan.fail("expected OFF, found '" + printable(word) + "'");
    }
    const std::size_t vertices = declared(scan, word, "the number of vertices");
    const std::size_t faces = declared(scan, scan.word_across_lines("the number of faces"), "the number of faces");

    TriangleMesh mesh;
    mesh.vertices.reserve(std::min(vertices, scan.bytes_left() / 6 + 1));
    for (std::size_t i = 0; i < vertices; ++i) {
        if (!scan.next_line())
            scan.fail("the file ends after " + std::to_string(i) + " of " + std::to_string(vertices) + " vertices");
        mesh.vertices.push_back(scan.point("a coordinate"));
    }
    mesh.triangles.reserve(std::min(faces, scan.bytes_left() / 8 + 1));
    std::vector<std::uint32_t> polygon;
    for (std::size_t i = 0; i < faces; ++i) {
        if (!scan.next_line())
            scan.fail("the file ends after " + std::to_string(i) + " of " + std::to_string(faces) + " faces");
        const std::int64_t size = scan.integer(scan.word(), "the number of vertices of a face");
        if (size < 3)
            scan.fail("a face with " + std::to_string(size) + " vertices; at least 3 are needed");
        polygon.clear();
        for (std::int64_t k = 0; k < size; ++k) { // ends with the line at the latest
            const std::int64_t index = scan.integer(scan.word(), "a vertex index");
            if (index < 0 || static_cast<std::uint64_t>(index) >= vertices)
                scan.fail("vertex index " + std::to_string(index) + " is out of range; the file declares " +
                          std::to_string(vertices) + " vertices");
            polygon.push_back(static_cast<std::uint32_t>(index));
        }
        for (std::size_t k = 2; k < polygon.size(); ++k)
            mesh.triangles.push_back({polygon[0], polygon[k - 1], polygon[k]});
    }
    return mesh;
}

} // namespace cinch
