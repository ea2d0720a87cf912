// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "toolkit/surface/input_error.hpp"
#include "toolkit/surface/triangle_mesh.hpp"

namespace cinch {

/// The surface of a mesh file, and what else the file has.
struct MeshFile {
    TriangleMesh mesh;
    std::vector<std::string> notes; ///< one line each, for the load report: what bounds nothing and was left out, what was not read
};

/// Reads OBJ, OFF, PLY (ascii and both binaries) or STL (ascii and binary), chosen by the extension in any case.
/// Polygons become triangle fans, PLY's strips the triangles that they stand for; vertex counts are those of the file (an STL file has
/// three per triangle). What is no surface is left out, and a note counts it: lines, points, faces of two vertices, and where
/// the file gives the count itself (PLY, OFF) of one or none.
/// Throws InputError, one line with file, line or byte, and reason: truncation, bad indices, coordinates that are
/// not finite, counts that the file cannot hold, surfaces of other kinds. Memory is bounded by the file's size.
MeshFile read_mesh(const std::filesystem::path& path);

/// True if the extension is one that read_mesh knows.
bool is_mesh_file(const std::filesystem::path& path);

/// The readers on bytes in memory; `file` is for messages only.
MeshFile parse_obj(std::string_view bytes, const std::string& file);
MeshFile parse_off(std::string_view bytes, const std::string& file);
MeshFile parse_ply(std::string_view bytes, const std::string& file);
MeshFile parse_stl(std::string_view bytes, const std::string& file);

/// The whole file. Throws InputError for what is missing, unreadable, empty, or not a regular file.
std::string read_bytes(const std::filesystem::path& path);

} // namespace cinch
