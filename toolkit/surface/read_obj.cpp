// SPDX-License-Identifier: Apache-2.0
// Wavefront OBJ: v and f lines. Statements that say how a surface looks are passed over, lines and points are counted,
// and surfaces that are not made of polygons are refused: what is left would pass for the whole.
#include <algorithm>
#include <span>

#include "cinch/environment.hpp"
#include "toolkit/surface/left_out.hpp"
#include "toolkit/surface/read_mesh.hpp"
#include "toolkit/surface/text_scan.hpp"

namespace cinch {
namespace {

struct Reference {
    std::size_t vertex;
    std::size_t line;
};

// "7", "7/1", "7//3", "7/1/3", "-1": the vertex, counted from 0. Texture and normal references are checked for form
// only.
std::size_t face_vertex(const TextScan& scan, std::string_view word, std::size_t vertices_so_far)
{
    const std::size_t slash = word.find('/');
    const std::int64_t index = scan.integer(word.substr(0, slash), "a vertex index");
    if (slash != std::string_view::npos) {
        std::string_view rest = word.substr(slash + 1);
        const std::size_t second = rest.find('/');
        for (std::string_view part :
             {rest.substr(0, second), second == std::string_view::npos ? "" : rest.substr(second + 1)})
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

// Grouping, looks, and what of free-form geometry is no surface by itself.
constexpr std::string_view passed_over[] = {
    "vt",        "vn",     "vp",     "g",     "s",        "o",        "mg",    "usemtl",
    "mtllib",    "usemap", "maplib", "bevel", "c_interp", "d_interp", "lod",   "shadow_obj",
    "trace_obj", "cstype", "ctype",  "deg",   "bmat",     "step",     "parm",  "trim",
    "hole",      "scrv",   "sp",     "end",   "con",      "ctech",    "stech", "curv2"};
constexpr std::string_view curves[] = {"l", "curv", "cdc"};

bool is_one_of(std::span<const std::string_view> known, std::string_view word)
{
    return std::find(known.begin(), known.end(), word) != known.end();
}

void refuse_other_surfaces(const TextScan& scan, std::string_view keyword)
{
    for (std::string_view surface : {"surf", "bsp", "bzp", "cdp"})
        if (keyword == surface)
            scan.fail("a free-form surface ('" + std::string(surface) +
                      "'); only polygons are read, so convert it to them");
    for (std::string_view other : {"call", "csh"})
        if (keyword == other)
            scan.fail("'" + std::string(other) + "' takes what follows from elsewhere; put all of it into this file");
}

} // namespace

MeshFile parse_obj(std::string_view bytes, const std::string& file)
{
    require_default_arithmetic();
    TextScan scan(bytes, file, {.comment = '#', .comments_end_words = true, .joined_lines = true});
    MeshFile out;
    TriangleMesh& mesh = out.mesh;
    Reference highest{0, 0}; // a face may come before its vertices, so the range is checked at the end
    bool any = false;
    std::size_t edges = 0, lines = 0, points = 0, unknown = 0;
    std::string first_unknown;
    std::vector<std::uint32_t> polygon;
    while (scan.next_line()) {
        const std::string_view keyword = scan.word();
        if (is_keyword(keyword, "v")) {
            mesh.vertices.push_back(scan.point("a coordinate"));
            any = true;
        } else if (is_keyword(keyword, "f") || is_keyword(keyword, "fo")) {
            any = true;
            polygon.clear();
            for (std::string_view word; !(word = scan.word()).empty();) {
                const std::size_t vertex = face_vertex(scan, word, mesh.vertices.size());
                if (highest.line == 0 || vertex > highest.vertex)
                    highest = {vertex, scan.line()};
                polygon.push_back(static_cast<std::uint32_t>(vertex));
            }
            if (polygon.size() < 2)
                scan.fail(polygon.empty() ? "a face without vertices; the line is cut off"
                                          : "a face with 1 vertex; the line is cut off");
            edges += polygon.size() == 2;
            for (std::size_t i = 2; i < polygon.size(); ++i)
                mesh.triangles.push_back({polygon[0], polygon[i - 1], polygon[i]});
        } else if (is_one_of(curves, keyword)) {
            ++lines;
        } else if (keyword == "p") {
            ++points;
        } else if (!is_one_of(passed_over, keyword)) {
            if (std::string_view("+-.0123456789").find(keyword[0]) != std::string_view::npos)
                scan.fail("the line begins with a number; a line that continues another needs a '\\' before it");
            refuse_other_surfaces(scan, keyword);
            if (unknown++ == 0)
                first_unknown = "'" + printable(keyword) + "' in line " + std::to_string(scan.line());
        }
    }
    if (highest.line != 0 && highest.vertex >= mesh.vertices.size())
        throw InputError::at_line(file, highest.line,
                                  "vertex index " + std::to_string(highest.vertex + 1) +
                                      " is out of range; the file has " + std::to_string(mesh.vertices.size()) +
                                      " vertices");
    if (!any)
        throw InputError::in_file(file, "has no v or f line; is it an OBJ file?");
    note_left_out({{edges, "face of two vertices", "faces of two vertices"},
                   {lines, "line", "lines"},
                   {points, "point statement", "point statements"}},
                  out.notes);
    if (unknown > 0)
        out.notes.push_back((unknown == 1 ? "1 line is no statement of OBJ and was"
                                          : std::to_string(unknown) + " lines are no statements of OBJ and were") +
                            " not read (" + (unknown == 1 ? "" : "first ") + first_unknown + ")");
    return out;
}

} // namespace cinch
