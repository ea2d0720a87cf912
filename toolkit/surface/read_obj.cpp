// SPDX-License-Identifier: Apache-2.0
// Wavefront OBJ: v and f lines; every other statement is passed over.
#include "toolkit/surface/read_mesh.hpp"
#include "toolkit/surface/text_scan.hpp"

namespace cinch {
namespace {

struct Reference {
    std::size_t vertex;
    std::size_t line;
};

// "7", "7/1", "7//3", "7/1/3", "-1": the vertex, counted from 0. Texture and normal references are checked for form only.
std::size_t face_vertex(const TextScan& scan, std::string_view word, std::size_t vertices_so_far)
{
    const std::size_t slash = word.find('/');
    const std::int64_t index = scan.integer(word.substr(0, slash), "a vertex index");
    if (slash != std::string_view::npos) {
        std::string_view rest = word.substr(slash + 1);
        const std::size_t second = rest.find('/');
        for (std::string_view part : {rest.substr(0, second), second == std::string_view::npos ? "" : rest.substr(second + 1)})
            if (!part.empty())
                scan.integer(part, "a texture or normal index");
    }
    if (index > 0)
        return static_cast<std::size_t>(index - 1);
    if (index == 0)
        scan.fail("vertex index 0; OBJ counts from 1");
    if (static_cast<std::uint64_t>(-(index + 1)) >= vertices_so_far)
        scan.fail("vertex index " + std::to_string(index) + " reaches before the first of " +
                  std::to_string(vertices_so_far) + " vertices");
    return vertices_so_far - static_cast<std::size_t>(-index);
}

} // namespace

TriangleMesh parse_obj(std::string_view bytes, const std::string& file)
{
    TextScan scan(bytes, file, '#', true);
    TriangleMesh mesh;
    Reference highest{0, 0}; // a face may come before its vertices, so the range is checked at the end
    bool any = false;
    std::vector<std::uint32_t> polygon;
    while (scan.next_line()) {
        const std::string_view keyword = scan.word();
        if (keyword == "v") {
            mesh.vertices.push_back(scan.point("a coordinate"));
            any = true;
        } else if (keyword == "f" || keyword == "fo") {
            any = true;
            polygon.clear();
            for (std::string_view word; !(word = scan.word()).empty();) {
                const std::size_t vertex = face_vertex(scan, word, mesh.vertices.size());
                if (highest.line == 0 || vertex > highest.vertex)
                    highest = {vertex, scan.line()};
                polygon.push_back(static_cast<std::uint32_t>(vertex));
            }
            if (polygon.size() < 3)
                scan.fail("a face with " + std::to_string(polygon.size()) + " vertices; at least 3 are needed");
            for (std::size_t i = 2; i < polygon.size(); ++i)
                mesh.triangles.push_back({polygon[0], polygon[i - 1], polygon[i]});
        }
    }
    if (highest.line != 0 && highest.vertex >= mesh.vertices.size())
        throw InputError::at_line(file, highest.line,
                                  "vertex index " + std::to_string(highest.vertex + 1) + " is out of range; the file has " +
                                      std::to_string(mesh.vertices.size()) + " vertices");
    if (!any)
        throw InputError::in_file(file, "has no v or f line; is it an OBJ file?");
    return mesh;
}

} // namespace cinch
