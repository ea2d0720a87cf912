// SPDX-License-Identifier: GPL-3.0-or-later
// What the formats allow and few programs write: the same surface, drawn at random and written in every way, must come
// back.
#include <fstream>
#include <random>

#include <catch2/catch.hpp>

#include "tests/support.hpp"
#include "toolkit/surface/read_mesh.hpp"

using namespace cinch;
using namespace std::string_literals;

namespace {

using Draw = std::mt19937_64;

std::size_t below(Draw& draw, std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(draw); }
bool coin(Draw& draw) { return below(draw, 2) == 0; }

/// Vertices, polygons of any size, and the triangles that they are.
struct Drawn {
    std::vector<Vec3> vertices;
    std::vector<std::vector<std::size_t>> polygons;
    std::vector<Triangle> triangles;
    std::size_t small = 0; ///< polygons of fewer than three vertices
};

Drawn draw_polygons(Draw& draw, std::size_t least_size)
{
    Drawn out;
    for (std::size_t i = 0, n = 1 + below(draw, 7); i < n; ++i)
        out.vertices.emplace_back(0.25 * static_cast<double>(below(draw, 9)), static_cast<double>(below(draw, 4)),
                                  -static_cast<double>(below(draw, 3)));
    for (std::size_t f = 0, n = below(draw, 6); f < n; ++f) {
        out.polygons.emplace_back();
        std::vector<std::size_t>& p = out.polygons.back();
        for (std::size_t k = 0, size = least_size + below(draw, 5); k < size; ++k)
            p.push_back(below(draw, out.vertices.size()));
        out.small += p.size() < 3;
        for (std::size_t k = 2; k < p.size(); ++k)
            out.triangles.push_back({static_cast<std::uint32_t>(p[0]), static_cast<std::uint32_t>(p[k - 1]),
                                     static_cast<std::uint32_t>(p[k])});
    }
    return out;
}

std::string shown(double x) { return x == std::floor(x) ? std::to_string(static_cast<int>(x)) : std::to_string(x); }

void check_surface(const MeshFile& file, const Drawn& drawn, const std::string& text)
{
    INFO(text);
    REQUIRE(file.mesh.vertices == drawn.vertices);
    REQUIRE(file.mesh.triangles == drawn.triangles);
    std::string note;
    if (drawn.small)
        note = std::to_string(drawn.small) +
               (drawn.small == 1 ? " face of fewer than three vertices bounds"
                                 : " faces of fewer than three vertices bound") +
               " nothing; left out";
    REQUIRE((file.notes.empty() ? "" : file.notes[0]) == note);
}

/// Where the format has any blank, a random one.
std::string blank(Draw& draw, bool line_ends)
{
    const std::size_t kind = below(draw, line_ends ? 6 : 3);
    return kind == 0   ? " "
           : kind == 1 ? "\t"
           : kind == 2 ? "  "
           : kind == 3 ? "\n"
           : kind == 4 ? "\r\n"
                       : " # 1 2 3\n\n";
}

} // namespace

TEST_CASE("an OFF file gives the same surface however its numbers are spread over lines")
{
    Draw draw(5);
    const std::size_t files = test::share_of(20000);
    std::size_t refused = 0;
    for (std::size_t i = 0; i < files; ++i) {
        const Drawn drawn = draw_polygons(draw, 0);
        // Faces: one per line, each over several lines, several on a line.
        const bool vertices_joined = coin(draw), faces_spread = coin(draw), faces_joined = !faces_spread && coin(draw),
                   coloured = !faces_joined && coin(draw);
        const std::size_t kind = below(draw, 4); // OFF, COFF, NOFF, STOFF
        std::string text = std::array{"OFF", "COFF", "NOFF", "STOFF"}[kind] + blank(draw, true);
        text += std::to_string(drawn.vertices.size()) + blank(draw, true) + std::to_string(drawn.polygons.size());
        const std::size_t edges = below(draw, 3); // on the line, on the next, missing
        const bool vertices_spread =
            vertices_joined && edges != 2; // without it, a first coordinate alone on a line would be it
        text += edges == 0 ? blank(draw, false) + "7" : edges == 1 ? " # edges\n7" : "";
        text += vertices_joined && edges == 0 ? blank(draw, true) : "\n";
        for (std::size_t v = 0; v < drawn.vertices.size(); ++v) {
            for (int axis = 0; axis < 3; ++axis)
                text += (axis ? blank(draw, vertices_spread) : "") + shown(drawn.vertices[v][axis]);
            for (std::size_t extra = 0; extra < std::array<std::size_t, 4>{0, 4, 3, 2}[kind]; ++extra)
                text += blank(draw, vertices_spread) + "0.5";
            text += vertices_joined && v + 1 < drawn.vertices.size() ? blank(draw, vertices_spread) : "\n";
        }
        for (const auto& polygon : drawn.polygons) {
            text += std::to_string(polygon.size());
            for (const std::size_t v : polygon)
                text += blank(draw, faces_spread) + std::to_string(v);
            text += coloured ? " 255 0 128 # c\n" : faces_joined && coin(draw) ? " " : "\n";
        }
        MeshFile file;
        try {
            file = parse_off(text, "a");
        } catch (const InputError& error) {
            // With so few vertices, small faces and no number of edges, another way may fit as well.
            INFO(text);
            INFO(error.what());
            REQUIRE_THAT(error.what(), Catch::Contains("can be read in two ways"));
            REQUIRE((vertices_joined || faces_joined || edges == 2 || kind > 0));
            ++refused;
            continue;
        }
        check_surface(file, drawn, text);
    }
    CHECK(refused < 5 + files / 40); // a small share of the files strays
}

TEST_CASE("PLY and OFF faces of any size, those of fewer than three vertices are counted")
{
    Draw draw(6);
    for (std::size_t i = 0; i < test::share_of(5000); ++i) {
        const Drawn drawn = draw_polygons(draw, 0);
        std::string vertices, faces;
        for (const Vec3& v : drawn.vertices)
            vertices += shown(v[0]) + " " + shown(v[1]) + " " + shown(v[2]) + "\n";
        for (const auto& polygon : drawn.polygons) {
            faces += std::to_string(polygon.size());
            for (const std::size_t v : polygon)
                faces += " " + std::to_string(v);
            faces += "\n";
        }
        const std::string nv = std::to_string(drawn.vertices.size()), nf = std::to_string(drawn.polygons.size());
        const std::string off = "OFF\n" + nv + " " + nf + " 0\n" + vertices + faces;
        check_surface(parse_off(off, "a"), drawn, off);
        const std::string ply = "ply\nformat ascii 1.0\nelement vertex " + nv +
                                "\nproperty float x\nproperty float y\nproperty float z\nelement face " + nf +
                                "\nproperty list uchar int vertex_index\nend_header\n" + vertices + faces;
        check_surface(parse_ply(ply, "a"), drawn, ply);
    }
}

TEST_CASE("OBJ faces of two vertices, lines and points are counted, wherever they stand")
{
    Draw draw(7);
    for (std::size_t i = 0; i < test::share_of(5000); ++i) {
        const Drawn drawn = draw_polygons(draw, 2);
        std::string text;
        for (const Vec3& v : drawn.vertices)
            text += "v " + shown(v[0]) + " " + shown(v[1]) + " " + shown(v[2]) + "\n";
        std::size_t lines = 0, points = 0;
        for (const auto& polygon : drawn.polygons) {
            if (coin(draw)) {
                text += "l 1 1 1\n";
                ++lines;
            }
            if (coin(draw)) {
                text += "p 1\n";
                ++points;
            }
            text += coin(draw) ? "f" : "F";
            for (const std::size_t v : polygon)
                text += " " +
                        (coin(draw) ? std::to_string(v + 1)
                                    : std::to_string(static_cast<std::int64_t>(v) -
                                                     static_cast<std::int64_t>(drawn.vertices.size()))) +
                        (coin(draw) ? "//1" : "");
            text += "\n";
        }
        const MeshFile file = parse_obj(text, "a");
        INFO(text);
        REQUIRE(file.mesh.vertices == drawn.vertices);
        REQUIRE(file.mesh.triangles == drawn.triangles);
        REQUIRE(file.notes.size() == (drawn.small + lines + points > 0));
        for (const auto& [count, one, many] :
             {std::tuple(drawn.small, " face of two vertices", " faces of two vertices"),
              std::tuple(lines, " line", " lines"), std::tuple(points, " point statement", " point statements")})
            if (count)
                REQUIRE_THAT(file.notes[0], Catch::Contains(std::to_string(count) + (count == 1 ? one : many)));
    }
    CHECK(parse_obj("v 0 0 0\nhello\nV 1 1 1\n\nworld\n", "a").notes ==
          std::vector<std::string>{"2 lines are no statements of OBJ and were not read (first 'hello' in line 2)"});
}

namespace {

/// One integer of `bytes` bytes, or as text.
std::string encoded(std::int64_t value, std::size_t bytes, char format)
{
    if (format == 'a')
        return std::to_string(value) + " ";
    std::string out;
    for (std::size_t i = 0; i < bytes; ++i)
        out += static_cast<char>(value >> (8 * (format == 'l' ? i : bytes - 1 - i)));
    return out;
}

} // namespace

TEST_CASE("PLY triangle strips are the triangles that they stand for, in every encoding")
{
    struct Type {
        const char* name;
        std::size_t bytes;
        bool has_sign;
    };
    const std::vector<Type> types{{"char", 1, true},    {"uchar", 1, false}, {"short", 2, true},
                                  {"ushort", 2, false}, {"int", 4, true},    {"uint", 4, false}};
    Draw draw(8);
    for (std::size_t i = 0; i < test::share_of(5000); ++i) {
        const char format = "alb"[below(draw, 3)];
        const Type type = types[below(draw, types.size())], size_type = types[below(draw, types.size())];
        const std::size_t vertices = 1 + below(draw, 9), items = below(draw, 4);
        std::string body;
        for (std::size_t v = 0; v < vertices; ++v)
            for (const std::size_t x : {v, 2 * v, 3 * v})
                body += encoded(static_cast<std::int64_t>(x), 2, format);
        std::vector<Triangle> wanted;
        std::size_t small = 0;
        for (std::size_t item = 0; item < items; ++item) {
            std::vector<std::int64_t> list;
            const std::size_t strips = below(draw, 4);
            for (std::size_t s = 0; s < strips; ++s) {
                std::vector<std::uint32_t> strip;
                for (std::size_t k = 0, size = below(draw, 7); k < size; ++k) // repeated vertices are stitches
                    strip.push_back(static_cast<std::uint32_t>(below(draw, vertices)));
                small += strip.size() == 1 || strip.size() == 2;
                // Each triangle shares the edge of the strip's last two vertices with the one before, and runs through
                // it the other way.
                for (std::size_t k = 0; k + 3 <= strip.size(); ++k)
                    wanted.push_back(k % 2 ? Triangle{strip[k + 1], strip[k], strip[k + 2]}
                                           : Triangle{strip[k], strip[k + 1], strip[k + 2]});
                list.insert(list.end(), strip.begin(), strip.end());
                if (s + 1 < strips || coin(draw))
                    list.push_back(
                        format == 'a' && !type.has_sign && coin(draw) ? (std::int64_t(1) << (8 * type.bytes)) - 1 : -1);
            }
            body += encoded(7, 1, format) + encoded(static_cast<std::int64_t>(list.size()), size_type.bytes, format);
            for (const std::int64_t index : list)
                body += encoded(index, type.bytes, format);
        }
        const std::string text = "ply\nformat "s +
                                 (format == 'a'   ? "ascii"
                                  : format == 'l' ? "binary_little_endian"
                                                  : "binary_big_endian") +
                                 " 1.0\nelement vertex " + std::to_string(vertices) +
                                 "\nproperty ushort x\nproperty ushort y\nproperty ushort z\nelement tristrips " +
                                 std::to_string(items) + "\nproperty uchar flags\nproperty list " + size_type.name +
                                 " " + type.name + " vertex_indices\nend_header\n" + body;
        INFO(text);
        const MeshFile file = parse_ply(text, "a");
        REQUIRE(file.mesh.vertices.size() == vertices);
        REQUIRE(file.mesh.triangles == wanted);
        REQUIRE(file.notes.size() == (small > 0));
        if (small)
            REQUIRE_THAT(file.notes[0], Catch::StartsWith(std::to_string(small) + (small == 1 ? " strip" : " strips")));
    }
}

TEST_CASE("PLY strips and faces add up, and what is neither is named")
{
    const std::string
        points = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n",
        body = "end_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
    const MeshFile both = parse_ply(points +
                                        "element face 1\nproperty list uchar int vertex_indices\nelement tristrips "
                                        "1\nproperty list int int vertex_indices\n" +
                                        body + "3 0 1 2\n4 3 2 1 0\n",
                                    "a");
    CHECK(both.mesh.triangles == std::vector<Triangle>{{0, 1, 2}, {3, 2, 1}, {1, 2, 0}});
    CHECK(both.notes.empty());
    const MeshFile grid = parse_ply(points +
                                        "element range_grid 3\nproperty list uchar int vertex_indices\nelement edge "
                                        "1\nproperty int vertex1\nproperty int vertex2\n" +
                                        body + "0\n1 2\n0\n0 1\n",
                                    "a");
    CHECK(grid.mesh.triangles.empty());
    CHECK(grid.notes == std::vector<std::string>{"3 elements of fewer than three vertices bound nothing; left out",
                                                 "not read, as no surface: 'edge'"});
    const MeshFile longer =
        parse_ply(points + "element face 1\nproperty list uchar int vertex_indices\n" + body + "3 0 1 2\n3 2\n", "a");
    CHECK(longer.mesh.triangles.size() == 1);
    CHECK(longer.notes ==
          std::vector<std::string>{"5 bytes follow the last element that the header declares; not read"});
}

TEST_CASE("PLY headers end as their lines do")
{
    const std::string header = "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty uchar x\nproperty "
                               "uchar y\nproperty uchar z\nend_header";
    CHECK(parse_ply(header + " \t\n\n\r ", "a").mesh.vertices[0] == Vec3(10, 13, 32));
    std::string mac = header + "\n";
    std::replace(mac.begin(), mac.end(), '\n', '\r');
    CHECK(parse_ply(mac + "\n\r ", "a").mesh.vertices[0] == Vec3(10, 13, 32));
}

TEST_CASE("STL keywords in any case")
{
    Draw draw(9);
    const std::string facet =
        "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1e0 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
    for (std::size_t i = 0; i < 300; ++i) {
        std::string text = "solid x\n" + facet + facet + "endsolid x\nsolid\n" + facet + "endsolid";
        for (char& c : text)
            if (coin(draw))
                c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
        INFO(text);
        REQUIRE(parse_stl(text, "a").mesh.triangles.size() == 3);
        REQUIRE(parse_stl("\xef\xbb\xbf \r\n" + text, "a").mesh.vertices[1] == Vec3(1, 0, 0));
    }
}

TEST_CASE("bytes after the triangles of a binary STL are called that, whatever its header says")
{
    Draw draw(10);
    for (const std::string begin : {"solid", "SOLID x", "made by y", ""})
        for (std::size_t triangles = 0; triangles < 5; ++triangles) {
            std::string bytes = begin + std::string(80 - begin.size(), coin(draw) ? ' ' : '\0') +
                                static_cast<char>(triangles) + "\0\0\0"s;
            bytes += std::string(50 * triangles, '\0');
            REQUIRE(parse_stl(bytes, "a").mesh.triangles.size() == triangles);
            for (std::size_t trailing : {1, 2, 49, 50, 51, 1000}) {
                std::string tail;
                for (std::size_t k = 0; k < trailing; ++k)
                    tail += static_cast<char>(below(draw, 256));
                CHECK_THROWS_WITH(parse_stl(bytes + tail, "a"),
                                  Catch::StartsWith("a: byte " + std::to_string(84 + 50 * triangles) + ": " +
                                                    std::to_string(trailing) + " trailing byte"));
            }
            if (triangles)
                CHECK_THROWS_WITH(parse_stl(bytes.substr(0, bytes.size() - 1), "a"),
                                  Catch::Contains("binary STL declares " + std::to_string(triangles)));
        }
}

TEST_CASE("mesh files that were reported load, or are refused by name")
{
    const std::filesystem::path folder = CINCH_REPORTS;
    const std::vector<Vec3> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const std::vector<Triangle> faces{{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
    const MeshFile empty = read_mesh(folder / "F12_empty_face.ply");
    CHECK(empty.mesh.vertices == corners);
    CHECK(empty.mesh.triangles == faces);
    CHECK(empty.notes == std::vector<std::string>{"1 face of fewer than three vertices bounds nothing; left out"});
    const MeshFile edge = read_mesh(folder / "F12_two_vertex_face.obj");
    CHECK(edge.mesh.vertices == corners);
    CHECK(edge.mesh.triangles == faces);
    CHECK(edge.notes == std::vector<std::string>{"1 face of two vertices bounds nothing; left out"});
    const MeshFile strips = read_mesh(folder / "F13_tristrips.ply");
    CHECK(strips.mesh.vertices == corners);
    CHECK(strips.mesh.triangles == std::vector<Triangle>{{0, 1, 2}, {2, 1, 3}});
    const MeshFile joined = read_mesh(folder / "F17_vertices_on_one_line.off");
    CHECK(joined.mesh.vertices == corners);
    CHECK(joined.mesh.triangles == faces);
    CHECK(joined.notes.empty());
    const MeshFile upper = read_mesh(folder / "F14_uppercase.stl");
    REQUIRE(upper.mesh.triangles.size() == 4);
    for (std::size_t i = 0; i < 12; ++i)
        CHECK(upper.mesh.vertices[i] == corners[faces[i / 3][i % 3]]);
    CHECK_THROWS_WITH(read_mesh(folder / "F14_binary_trailing_bytes.stl"),
                      Catch::EndsWith("byte 284: 10 trailing bytes after the 4 triangles that binary STL declares; "
                                      "correct the count at byte 80, or cut them off"));
}
