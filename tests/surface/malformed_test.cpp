// SPDX-License-Identifier: GPL-3.0-or-later
// Files that must be refused in one line that names the file, the place and the reason.
#include <catch2/catch.hpp>

#include "tests/support.hpp"
#include "toolkit/surface/read_mesh.hpp"

using namespace cinch;
using namespace std::string_literals;

namespace {

struct Malformed {
    const char* file;
    std::string bytes;
    const char* message; // what follows the file's name must begin so
};

const std::string off_points = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n";
const std::string ply_ascii =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
const std::string ply_little =
    "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
const std::string stl_header(80, ' ');
const std::string point_zero(12, '\0');

const std::vector<Malformed> files = {
    // OBJ
    {"empty.obj", "", ": the file is empty"},
    {"prose.obj", "this is no mesh\nat all\n", ": has no v or f line"},
    {"zero.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", ":4: vertex index 0"},
    {"beyond.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", ":4: vertex index 4 is out of range"},
    {"before.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf -1 -2 -4\n", ":5: vertex index -4 reaches before"},
    {"one.obj", "v 0 0 0\nv 1 0 0\nf 1\n", ":3: a face with 1 vertex; the line is cut off"},
    {"none.obj", "v 0 0 0\nf\n", ":2: a face without vertices; the line is cut off"},
    {"edge.obj", "v 0 0 0\nv 1 0 0\nf 1 3\n", ":3: vertex index 3 is out of range"},
    {"free.obj", "v 0 0 0\nsurf 0 1 0 1 1 1 1 1\n", ":2: a free-form surface ('surf')"},
    {"call.obj", "v 0 0 0\ncall other.obj\n", ":2: 'call' takes what follows from elsewhere"},
    {"wrapped.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n3\n", ":5: the line begins with a number"},
    {"nan.obj", "v 0 nan 0\n", ":1: a coordinate 'nan' is not finite"},
    {"inf.obj", "v 0 0 0\nv 0 -inf 0\n", ":2: a coordinate '-inf' is not finite"},
    {"over.obj", "v 0 1e999 0\n", ":1: a coordinate '1e999' is too large"},
    {"short.obj", "v 0 1\n", ":1: expected a coordinate, found the end of the line"},
    {"word.obj", "v 0 1 zwei\n", ":1: expected a coordinate, found 'zwei'"},
    {"junk.obj", "v 0 0 0.5x\n", ":1: expected a coordinate, found '0.5x'"},
    {"reference.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/a 2 3\n", ":4: expected a texture or normal index"},
    {"huge.obj", "v 0 0 0\nf 1 99999999999999999999 1\n", ":2: expected a vertex index"},
    {"continued.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 \\\n 7\n", ":5: vertex index 7 is out of range"},
    // OFF
    {"empty.off", "", ": the file is empty"},
    {"comment.off", "# nothing else\n", ":2: the file ends where the word OFF"},
    {"keyword.off", "PLY\n3 1 0\n", ":1: expected OFF"},
    {"nocounts.off", "OFF\n", ":2: the file ends where the number of vertices"},
    {"negative.off", "OFF\n-3 1 0\n", ":2: the number of vertices is negative"},
    {"claim.off", "OFF\n4000000000 1 0\n0 0 0\n", ":2: the number of vertices is 4000000000, but only"},
    {"claimfaces.off", "OFF\n1 4000000000 0\n0 0 0\n", ":2: the number of faces is 4000000000, but only"},
    {"cutpoints.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n", ":5: the file ends after 2 of 3 vertices"},
    {"cutfaces.off", off_points, ":6: the file ends after 0 of 1 faces"},
    {"index.off", off_points + "3 0 1 3\n", ":6: vertex index 3 is out of range"},
    {"minus.off", off_points + "3 0 1 -1\n", ":6: vertex index -1 is out of range"},
    {"edge.off", off_points + "2 0 3\n", ":6: vertex index 3 is out of range"},
    {"sizes.off", off_points + "-1 0 1 2\n", ":6: the number of vertices of a face is negative"},
    {"more.off", off_points + "3 0 1 2\n3 0 2 1\n", ":7: more follows after the 1 faces"},
    {"short.off", "OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 0 1 2\n", ":4: expected a coordinate, found the end of the line"},
    {"joined.off", "OFF\n3 1 0\n0 0 0 1 0 0 0 1 x\n3 0 1 2\n", ":3: expected a coordinate, found 'x'"},
    {"homogeneous.off", "4OFF\n1 0 0\n1 2 3 4\n", ":1: '4OFF' has homogeneous coordinates"},
    {"plane.off", "nOFF 2\n1 0 0\n1 2\n", ":1: has 2 dimensions"},
    {"twoways.off", "OFF\n2 1 0\n0 0 0 1 1 1\n3 0 1\n1 0\n", ": can be read in two ways that differ"},
    {"cutface.off", off_points + "3 0 1\n", ":6: expected a vertex index, found the end of the line"},
    {"bigface.off", off_points + "2000000000 0 1 2\n", ":6: expected a vertex index, found the end of the line"},
    {"real.off", off_points + "3 0 1 1.5\n", ":6: expected a vertex index, found '1.5'"},
    {"nan.off", "OFF\n1 0 0\nnan 0 0\n", ":3: a coordinate 'nan' is not finite"},
    {"binary.off", "OFF BINARY\n", ":1: binary OFF is not supported"},
    // PLY
    {"empty.ply", "", ": the file is empty"},
    {"magic.ply", "plyx\n", ":1: the first line of a PLY file must be 'ply'"},
    {"open.ply", "ply\nformat ascii 1.0\nelement vertex 1\n", ":4: the file ends inside the header"},
    {"format.ply", "ply\nformat utf8 1.0\nend_header\n", ":2: unknown format 'utf8'"},
    {"noformat.ply", "ply\nelement vertex 0\nproperty float x\nend_header\n", ":4: the header has no format line"},
    {"type.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty half x\nend_header\n",
     ":4: unknown property type 'half'"},
    {"orphan.ply", "ply\nformat ascii 1.0\nproperty float x\nend_header\n", ":3: a property before any element"},
    {"novertex.ply", "ply\nformat ascii 1.0\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n",
     ": the header declares no element 'vertex'"},
    {"noz.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n0 0\n",
     ": element 'vertex' lacks"},
    {"noproperties.ply",
     "ply\nformat ascii 1.0\nelement vertex 3\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n3 0 "
     "1 2\n",
     ": element 'vertex' lacks"},
    {"nolist.ply",
     "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nelement face "
     "1\nproperty int a\nend_header\n0 0 0\n1\n",
     ": element 'face' has no integer list"},
    {"floatsize.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty list float int x\nend_header\n",
     ":4: a list whose size is not an integer"},
    {"negative.ply", "ply\nformat ascii 1.0\nelement vertex -1\nproperty float x\nend_header\n",
     ":3: the number of elements is negative"},
    {"claim.ply",
     "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\nproperty "
     "float z\nend_header\n",
     ": element 'vertex' declares 4000000000 items, but only 0 bytes follow"},
    {"cutpoints.ply", ply_ascii + "0 0 0\n1 0 0\n0 1\n", ":13: the file ends where"},
    {"index.ply", ply_ascii + "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", ":13: vertex index 3"},
    {"edge.ply", ply_ascii + "0 0 0\n1 0 0\n0 1 0\n2 0 3\n", ":13: vertex index 3 is out of range"},
    {"twice.ply", "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nelement vertex 0\nend_header\n",
     ": the header declares the element 'vertex' twice"},
    {"strip.ply",
     "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nelement tristrips "
     "1\nproperty list int int vertex_indices\nend_header\n0 0 0\n2 0 -2\n",
     ":11: vertex index -2 is out of range"},
    {"noindices.ply",
     "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\nelement tristrips "
     "1\nproperty int a\nend_header\n1\n",
     ": element 'tristrips' has no integer list"},
    {"tetrahedra.ply",
     "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nelement cell "
     "1\nproperty list int int vertex_indices\nend_header\n0 0 0\n4 0 0 0 0\n",
     ":11: element 'cell' has a list of 4 vertices"},
    {"minus.ply", ply_ascii + "0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n", ":13: a list of negative size"},
    {"nan.ply", ply_ascii + "0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n", ":11: a vertex property 'nan' is not finite"},
    {"cutbinary.ply", ply_little + point_zero.substr(0, 7), ": byte 173: the file ends where a vertex property"},
    {"cutlist.ply", ply_little + point_zero + "\x03\0\0\0\0\0\0\0\0"s,
     ": byte 190: the file ends where a vertex index"},
    {"nanbinary.ply", ply_little + "\0\0\xc0\x7f\0\0\0\0\0\0\0\0\x03\0\0\0\0\0\0\0\0\0\0\0\0"s,
     ": byte 169: a coordinate of vertex 0 is not finite"},
    {"indexbinary.ply", ply_little + point_zero + "\x03\0\0\0\0\0\0\0\0\xff\xff\xff\xff"s,
     ": byte 190: vertex index -1 is"},
    // STL
    {"empty.stl", "", ": the file is empty"},
    {"tiny.stl", "binary", ": byte 6: the file ends inside the 84-byte header"},
    {"cut.stl", stl_header + "\x02\0\0\0"s + std::string(50, '\0'), ": byte 80: binary STL declares 2 triangles"},
    {"cutsolid.stl", "solid" + std::string(75, ' ') + "\x02\0\0\0"s + std::string(50, '\0'),
     ": byte 80: binary STL declares 2 triangles"},
    {"trailing.stl", stl_header + "\x01\0\0\0"s + std::string(50, '\0') + "\n",
     ": byte 134: 1 trailing byte after the 1 triangle that binary STL declares"},
    {"trailingsolid.stl", "solid" + std::string(75, ' ') + "\x01\0\0\0"s + std::string(60, '\0'),
     ": byte 134: 10 trailing bytes after the 1 triangle that binary STL declares"},
    {"claim.stl", stl_header + "\xff\xff\xff\xff"s, ": byte 80: binary STL declares 4294967295 triangles"},
    {"nan.stl", stl_header + "\x01\0\0\0"s + std::string(12, '\0') + "\0\0\xc0\x7f"s + std::string(34, '\0'),
     ": byte 96: a coordinate of triangle 0 is not finite"},
    {"open.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n",
     ":6: the file ends where 'vertex'"},
    {"four.stl",
     "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nvertex 0 1 1\nendloop\n",
     ":7: expected 'endloop' after 3 vertices"},
    {"two.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\n",
     ":6: expected 'vertex', found 'endloop'"},
    {"over.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 1e400\n",
     ":4: a coordinate '1e400' is too large"},
    {"noend.stl", "solid a\n", ":2: the file ends where 'facet' or 'endsolid'"},
    // not meshes
    {"packed.ply", "\x1f\x8b\x08\0"s, ": is compressed (gzip); unpack it first"},
    {"packed.stl", "PK\x03\x04"s + std::string(200, 'x'), ": is compressed (zip); unpack it first"},
    {"notes.txt", "hello", ": unknown mesh format '.txt'"},
};

} // namespace

TEST_CASE("malformed mesh files are refused with file, place and reason in one line")
{
    REQUIRE(files.size() >= 40);
    const test::TemporaryFolder folder;
    for (const Malformed& file : files) {
        INFO(file.file);
        const auto path = folder.write(file.file, file.bytes);
        std::string message;
        try {
            read_mesh(path);
            message = "loaded";
        } catch (const InputError& error) {
            message = error.what();
        }
        CHECK(message.find('\n') == std::string::npos);
        REQUIRE(message.starts_with(path.string()));
        CHECK_THAT(message.substr(path.string().size()), Catch::StartsWith(file.message));
    }
}

TEST_CASE("what is not a file is refused")
{
    const test::TemporaryFolder folder;
    std::filesystem::create_directory(folder.path() / "folder.obj");
    CHECK_THROWS_WITH(read_mesh(folder.path() / "folder.obj"), Catch::EndsWith("is a directory, not a file"));
    CHECK_THROWS_WITH(read_mesh(folder.path() / "missing.obj"), Catch::EndsWith("no such file"));
}

TEST_CASE("every truncation of a good file is refused or loads something shorter, and never crashes")
{
    const test::TemporaryFolder folder;
    const std::string binary = ply_little + point_zero + "\x03\0\0\0\0\0\0\0\0\0\0\0\0"s;
    REQUIRE(parse_ply(binary, "whole.ply").mesh.triangles.size() == 1);
    for (std::size_t n = 1; n < binary.size(); ++n)
        CHECK_THROWS_AS(parse_ply(binary.substr(0, n), "cut.ply"), InputError);
    const std::string text = off_points + "3 0 1 2";
    for (std::size_t n = 1; n < text.size(); ++n)
        CHECK_THROWS_AS(parse_off(text.substr(0, n), "cut.off"), InputError);
}
