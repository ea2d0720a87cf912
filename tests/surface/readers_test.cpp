// SPDX-License-Identifier: GPL-3.0-or-later
// Legal files, plain and odd.
#include <catch2/catch.hpp>

#include "tests/support.hpp"
#include "toolkit/surface/read_mesh.hpp"

using namespace cinch;
using namespace std::string_literals;

namespace {

void check_square(const MeshFile& file)
{
    CHECK(file.notes.empty());
    const TriangleMesh& mesh = file.mesh;
    REQUIRE(mesh.vertices.size() == 4);
    REQUIRE(mesh.triangles == std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}});
    CHECK(mesh.vertices[2] == Vec3(1, 1, 0.5));
}

} // namespace

TEST_CASE("OBJ oddities load")
{
    SECTION("quads, comments, references of all forms, other statements")
    {
        check_square(parse_obj("# a\nmtllib x.mtl\nv 0 0 0 # origin\nv 1 0 0\nv 1 1 .5\nv 0 1 0\nvt 0 0\nvn 0 0 1\no "
                               "thing\nf 1/1 2//1 3/1/1 4\n",
                               "a"));
    }
    SECTION("CRLF and lone CR")
    {
        check_square(parse_obj("v 0 0 0\r\nv 1 0 0\rv 1 1 0.5\r\nv 0 1 0\r\nf 1 2 3 4\r\n", "a"));
    }
    SECTION("no final newline") { check_square(parse_obj("v 0 0 0\nv 1 0 0\nv 1 1 0.5\nv 0 1 0\nf 1 2 3 4", "a")); }
    SECTION("line continuations")
    {
        check_square(parse_obj("v 0 0 \\\n0\nv 1 0 0\nv 1 1 0.5\nv 0 1 0\nf 1 2 \\\r\n 3\\\n 4\n", "a"));
    }
    SECTION("negative indices")
    {
        check_square(parse_obj("v 0 0 0\nv 1 0 0\nv 1 1 0.5\nv 0 1 0\nf -4 -3 -2 -1\n", "a"));
    }
    SECTION("a face before its vertices")
    {
        check_square(parse_obj("f 1 2 3 4\nv 0 0 0\nv 1 0 0\nv 1 1 0.5\nv 0 1 0\n", "a"));
    }
    SECTION("colours and weights after the coordinates")
    {
        check_square(parse_obj("v 0 0 0 1 0 0\nv 1 0 0 1\nv 1 1 5e-1\nv 0 +1 0\nf 1 2 3 4\n", "a"));
    }
    SECTION("tabs and a byte order mark")
    {
        check_square(parse_obj("\xef\xbb\xbfv\t0 0 0\nv 1 0 0\nv 1 1 0.5\nv 0 1 0\n\tf 1 2 3 4\n", "a"));
    }
    SECTION("degenerate and duplicate triangles")
    {
        const TriangleMesh mesh = parse_obj("v 0 0 0\nv 0 0 0\nf 1 1 1\nf 1 2 1\nf 1 2 1\n", "a").mesh;
        CHECK(mesh.vertices.size() == 2);
        CHECK(mesh.triangles.size() == 3);
    }
    SECTION("numbers too small for a double become zero")
    {
        CHECK(parse_obj("v 1e-400 -1e-999 0\n", "a").mesh.vertices[0] == Vec3(0, 0, 0));
    }
}

TEST_CASE("OFF oddities load")
{
    const std::string points = "0 0 0\n1 0 0\n1 1 0.5\n0 1 0\n";
    check_square(parse_off("OFF\n4 1 0\n" + points + "4 0 1 2 3\n", "a"));
    check_square(parse_off("OFF 4 1 0\r\n# c\n" + points + "\n4 0 1 2 3 255 0 0", "a"));
    check_square(parse_off("4 1 4\n" + points + "4 0 1 2 3", "a"));
    check_square(
        parse_off("COFF\n4\n1 0\n0 0 0 1 1 1 1\n1 0 0 1 1 1 1\n1 1 0.5 1 1 1 1\n0 1 0 1 1 1 1\n4 0 1 2 3\n", "a"));
    CHECK(parse_off("OFF\n0 0 0\n", "a").mesh.vertices.empty());
}

TEST_CASE("PLY oddities load")
{
    const std::string body = "end_header\n0 0 0 9\n1 0 0 9\n1 1 0.5 9\n0 1 0 9\n7 4 0 1 2 3\n";
    check_square(parse_ply(
        "ply\r\nformat ascii 1.0\r\ncomment hi\nobj_info x\nelement vertex 4\nproperty float32 x\nproperty double "
        "y\nproperty float z\n"
        "property uchar red\nelement face 1\nproperty int material\nproperty list uint8 uint32 vertex_index\n" +
            body,
        "a"));
    SECTION("faces before vertices, unknown elements and lists")
    {
        MeshFile file = parse_ply("ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int "
                                  "vertex_indices\nelement extra 2\nproperty list uchar float q\n"
                                  "element vertex 4\nproperty float z\nproperty float y\nproperty float "
                                  "x\nend_header\n4 0 1 2 3\n2 1 1\n0\n0 0 0\n0 0 1\n0.5 1 1\n0 1 0",
                                  "a");
        CHECK(file.notes == std::vector<std::string>{"not read, as no surface: 'extra'"});
        file.notes.clear();
        check_square(file);
    }
    SECTION("both binaries")
    {
        const std::string header = " 1.0\nelement vertex 4\nproperty short x\nproperty uchar y\nproperty float "
                                   "z\nelement face 1\nproperty list ushort char vertex_indices\nend_header\n";
        check_square(parse_ply("ply\nformat binary_big_endian" + header +
                                   "\0\0\0\0\0\0\0"s
                                   "\0\1\0\0\0\0\0"s
                                   "\0\1\1\x3f\0\0\0"s
                                   "\0\0\1\0\0\0\0"s
                                   "\0\4\0\1\2\3"s,
                               "a"));
        check_square(parse_ply("ply\nformat binary_little_endian" + header +
                                   "\0\0\0\0\0\0\0"s
                                   "\1\0\0\0\0\0\0"s
                                   "\1\0\1\0\0\0\x3f"s
                                   "\0\0\1\0\0\0\0"s
                                   "\4\0\0\1\2\3"s,
                               "a"));
    }
    SECTION("CR LF before a binary body, and a body that begins with a line feed byte")
    {
        const std::string header = "ply\r\nformat binary_little_endian 1.0\r\nelement vertex 1\r\nproperty uchar "
                                   "x\r\nproperty uchar y\r\nproperty uchar z\r\nend_header\r\n";
        CHECK(parse_ply(header + "\n\r\1", "a").mesh.vertices[0] == Vec3(10, 13, 1));
    }
}

TEST_CASE("STL loads, three vertices per triangle")
{
    const std::string one =
        "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
    CHECK(parse_stl("solid\n" + one + "endsolid\n", "a").mesh.triangles.size() == 1);
    CHECK(parse_stl("solid my part v2\n" + one + one + "endsolid my part v2\nsolid b\n" + one + "endsolid b", "a")
              .mesh.vertices.size() == 9);
    // Binary with a header that begins with "solid", as some programs write.
    std::string binary = "solid" + std::string(75, ' ') + "\1\0\0\0"s + std::string(12, '\0');
    for (const char* corner : {"\0\0\0\0", "\0\0\x80\x3f", "\0\0\0\x40"})
        binary += std::string(corner, 4) + std::string(8, '\0');
    const TriangleMesh mesh = parse_stl(binary + "\0\0"s, "a").mesh;
    REQUIRE(mesh.vertices.size() == 3);
    CHECK(mesh.vertices[2] == Vec3(2, 0, 0));
}

TEST_CASE("the format follows the extension in any case")
{
    const test::TemporaryFolder folder;
    CHECK(read_mesh(folder.write("A.ObJ", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")).mesh.triangles.size() == 1);
    CHECK(read_mesh(folder.write("B.OFF", "OFF\n1 0 0\n1 2 3\n")).mesh.vertices[0] == Vec3(1, 2, 3));
}
