// SPDX-License-Identifier: Apache-2.0
// Geomview OFF in its three-dimensional ascii forms: [ST][C][N]OFF and nOFF of dimension 3.
//
// In the format's own terms the numbers follow each other and line ends matter for one thing only: what follows a
// face's indices on their line is the face's colour. Files, however, come with one vertex per line and more on it than
// the keyword says, without the number of edges, or with several faces on a line. So the file is read in each way that
// it may be meant; a way fits only if every vertex and every face that is declared is there and nothing is left over.
// One mesh must come out, else the file is refused.
#include <algorithm>
#include <optional>

#include "cinch/environment.hpp"
#include "toolkit/surface/left_out.hpp"
#include "toolkit/surface/read_mesh.hpp"
#include "toolkit/surface/text_scan.hpp"

namespace cinch {
namespace {

constexpr std::size_t one_per_line = 0;

struct Layout {
    bool edge_count; ///< a third number follows the numbers of vertices and faces
    std::size_t
        vertex_numbers; ///< of each vertex, whatever the lines; or `one_per_line`, with anything after its coordinates
    enum class Faces {
        line_each,      ///< indices and anything else on one line
        ends_with_line, ///< indices on any number of lines; a colour, at most four numbers, ends with the line of the
                        ///< last
        joined          ///< no colours, so that lines do not matter
    } faces;
};

struct OffHeader {
    std::vector<std::size_t> vertex_numbers; ///< that a vertex may have
    std::size_t vertices = 0, faces = 0;
};

struct Reading {
    MeshFile file;
    std::size_t least_numbers = 0, most_numbers = 0; ///< on the lines of vertices, if each has its own
};

std::size_t declared(const TextScan& scan, std::string_view word, std::string_view what)
{
    const std::int64_t count = scan.integer(word, what);
    if (count < 0)
        scan.fail(std::string(what) + " is negative: " + std::to_string(count));
    // A vertex takes at least six bytes ("0 0 0 ") and a face two ("0 "), but for the last one.
    if (static_cast<std::uint64_t>(count) > scan.bytes_left())
        scan.fail(std::string(what) + " is " + std::to_string(count) + ", but only " +
                  std::to_string(scan.bytes_left()) + " bytes follow");
    return static_cast<std::size_t>(count);
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

// The keyword, which may be left out, in any case but for N (normals) and n (a dimension follows), and up to the number
// of faces.
OffHeader read_header(TextScan& scan)
{
    std::string_view word = scan.word_across_lines("the word OFF");
    std::size_t numbers = 3;
    bool colours = false;
    if (!is_digit(word[0]) || word.starts_with("4OFF") || word.starts_with("4nOFF")) {
        std::string_view rest = word;
        auto take = [&](std::string_view prefix) {
            const bool has = is_keyword(rest.substr(0, prefix.size()), prefix);
            rest.remove_prefix(has ? prefix.size() : 0);
            return has;
        };
        numbers += take("st") ? 2 : 0;
        colours = take("c");
        const bool normals = rest.starts_with('N');
        rest.remove_prefix(normals);
        numbers += normals ? 3 : 0;
        const bool homogeneous = take("4"), has_dimension = take("n");
        // "OFF8 6 12": a line end that got lost is not missed.
        if (!take("off") || !(rest.empty() || is_digit(rest[0])))
            scan.fail("expected OFF, found '" + printable(word) + "'");
        if (homogeneous)
            scan.fail("'" + printable(word) + "' has homogeneous coordinates; divide them by the fourth and write OFF");
        word = rest.empty() ? scan.word_across_lines("the number of vertices") : rest;
        if (is_keyword(word, "binary"))
            scan.fail("binary OFF is not supported; convert it to ascii OFF or to PLY");
        if (has_dimension) {
            if (const std::int64_t dimension = scan.integer(word, "the dimension"); dimension != 3)
                scan.fail("has " + std::to_string(dimension) + " dimensions; a surface here has 3");
            word = scan.word_across_lines("the number of vertices");
        }
    }
    OffHeader header;
    header.vertex_numbers = {numbers};
    if (colours) // r g b a; programs also write r g b
        header.vertex_numbers = {numbers + 4, numbers + 3};
    header.vertices = declared(scan, word, "the number of vertices");
    header.faces = declared(scan, scan.word_across_lines("the number of faces"), "the number of faces");
    return header;
}

void skip_edge_count(TextScan& scan)
{
    scan.integer(scan.word_across_lines("the number of edges"), "the number of edges");
}

std::size_t words_left(TextScan& scan)
{
    std::size_t count = 0;
    while (!scan.word().empty())
        ++count;
    return count;
}

void read_vertices(TextScan& scan, const OffHeader& header, std::size_t vertex_numbers, Reading& out)
{
    std::vector<Vec3>& vertices = out.file.mesh.vertices;
    vertices.reserve(std::min(header.vertices, scan.bytes_left() / 6 + 1));
    if (vertex_numbers == one_per_line) {
        if (const std::string_view word = scan.word(); !word.empty())
            scan.fail("expected the end of the line after the counts, found '" + printable(word) + "'");
        for (std::size_t i = 0; i < header.vertices; ++i) {
            if (!scan.next_line())
                scan.fail("the file ends after " + std::to_string(i) + " of " + std::to_string(header.vertices) +
                          " vertices");
            vertices.push_back(scan.point("a coordinate"));
            const std::size_t numbers = 3 + words_left(scan);
            out.least_numbers = i ? std::min(out.least_numbers, numbers) : numbers;
            out.most_numbers = std::max(out.most_numbers, numbers);
        }
        return;
    }
    for (std::size_t i = 0; i < header.vertices; ++i) {
        Vec3 v;
        for (int k = 0; k < static_cast<int>(vertex_numbers); ++k) {
            const double x = scan.number(scan.word_across_lines("a coordinate"), "a coordinate");
            if (k < 3)
                v[k] = x;
        }
        vertices.push_back(v);
    }
}

void read_faces(TextScan& scan, const OffHeader& header, Layout::Faces layout, MeshFile& out)
{
    const bool on_one_line = layout == Layout::Faces::line_each, joined = layout == Layout::Faces::joined;
    auto next = [&](const char* what) { return on_one_line ? scan.word() : scan.word_across_lines(what); };
    out.mesh.triangles.reserve(std::min(header.faces, scan.bytes_left() / 8 + 1));
    std::vector<std::uint32_t> polygon;
    std::size_t small = 0;
    for (std::size_t i = 0; i < header.faces; ++i) {
        if (!joined && !scan.next_line())
            scan.fail("the file ends after " + std::to_string(i) + " of " + std::to_string(header.faces) + " faces");
        const std::int64_t size =
            scan.integer(next("the number of vertices of a face"), "the number of vertices of a face");
        if (size < 0)
            scan.fail("the number of vertices of a face is negative: " + std::to_string(size));
        polygon.clear();
        for (std::int64_t k = 0; k < size; ++k) { // ends with the line or the file at the latest
            const std::int64_t index = scan.integer(next("a vertex index"), "a vertex index");
            if (index < 0 || static_cast<std::uint64_t>(index) >= header.vertices)
                scan.fail("vertex index " + std::to_string(index) + " is out of range; the file declares " +
                          std::to_string(header.vertices) + " vertices");
            polygon.push_back(static_cast<std::uint32_t>(index));
        }
        if (layout == Layout::Faces::ends_with_line && words_left(scan) > 4)
            scan.fail("a face is followed by more numbers than a colour has");
        small += polygon.size() < 3;
        for (std::size_t k = 2; k < polygon.size(); ++k)
            out.mesh.triangles.push_back({polygon[0], polygon[k - 1], polygon[k]});
    }
    if ((joined && !scan.word().empty()) || scan.next_line())
        scan.fail("more follows after the " + std::to_string(header.faces) + " faces that the file declares");
    note_left_out({{small, "face of fewer than three vertices", "faces of fewer than three vertices"}}, out.notes);
}

Reading read_body(TextScan scan, const OffHeader& header, const Layout& layout)
{
    Reading out;
    if (layout.edge_count)
        skip_edge_count(scan);
    read_vertices(scan, header, layout.vertex_numbers, out);
    if (layout.vertex_numbers != one_per_line && layout.faces != Layout::Faces::joined)
        if (const std::string_view word = scan.word(); !word.empty())
            scan.fail("expected the end of the line after " + std::to_string(header.vertices) + " vertices, found '" +
                      printable(word) + "'");
    read_faces(scan, header, layout.faces, out.file);
    return out;
}

// The ways in which the rest may be meant, the most usual first.
std::vector<Layout> layouts(TextScan scan, const OffHeader& header)
{
    const bool more_on_line = !TextScan(scan).word().empty();
    // Without it on the line of the other counts, the number of edges is alone on the next, or left out.
    const bool usual = more_on_line || (scan.next_line() && words_left(scan) == 1);
    std::vector<Layout> all;
    for (const bool edge_count : {usual, !usual}) {
        if (more_on_line && !edge_count)
            continue;
        for (std::size_t kind = 0; kind <= header.vertex_numbers.size(); ++kind)
            for (const auto faces : {Layout::Faces::line_each, Layout::Faces::ends_with_line, Layout::Faces::joined})
                all.push_back({edge_count, kind == 0 ? one_per_line : header.vertex_numbers[kind - 1], faces});
    }
    return all;
}

// Whether the first line of vertices has several; it decides what an error is about.
bool seems_joined(TextScan scan, const OffHeader& header, bool edge_count)
{
    if (edge_count)
        skip_edge_count(scan);
    std::size_t numbers = words_left(scan);
    if (numbers == 0 && scan.next_line())
        numbers = words_left(scan);
    return numbers > header.vertex_numbers[0] && numbers % header.vertex_numbers[0] == 0;
}

} // namespace

MeshFile parse_off(std::string_view bytes, const std::string& file)
{
    require_default_arithmetic();
    TextScan scan(bytes, file, {.comment = '#', .comments_end_words = true});
    const OffHeader header = read_header(scan);
    const std::vector<Layout> ways = layouts(scan, header);
    std::vector<InputError> refusals;
    std::optional<Reading> found;
    for (const Layout& way : ways) {
        std::optional<Reading> reading;
        try {
            reading = read_body(scan, header, way);
        } catch (const InputError& error) {
            refusals.push_back(error);
            continue;
        }
        // Each line with one vertex and all its numbers, or one face: no other way gives anything else.
        const bool is_strict = reading->least_numbers == reading->most_numbers &&
                               std::find(header.vertex_numbers.begin(), header.vertex_numbers.end(),
                                         reading->most_numbers) != header.vertex_numbers.end();
        if (!found && way.faces == Layout::Faces::line_each && is_strict)
            return std::move(reading->file);
        if (!found)
            found = std::move(reading);
        else if (found->file.mesh.vertices != reading->file.mesh.vertices ||
                 found->file.mesh.triangles != reading->file.mesh.triangles)
            throw InputError::in_file(file,
                                      "can be read in two ways that differ; write one vertex or face on each line");
    }
    if (found)
        return std::move(found->file);
    // Of the most usual way, or where vertices share lines, of the one that allows it. Refused ones come in the order
    // of the ways.
    const bool joined = seems_joined(scan, header, ways.front().edge_count);
    throw refusals[joined ? 4 : 0];
}

} // namespace cinch
