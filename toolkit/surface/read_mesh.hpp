// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "toolkit/surface/input_error.hpp"
#include "toolkit/surface/triangle_mesh.hpp"

namespace cinch {

/// Reads OBJ, OFF, PLY (ascii and both binaries) or STL (ascii and binary), chosen by the extension in any case.
/// Polygons become triangle fans; vertex counts are those of the file (an STL file has three per triangle).
/// Throws InputError, one line with file, line or byte, and reason: truncation, bad indices, coordinates that are
/// not finite, polygons under three vertices, counts that the file cannot hold. Memory is bounded by the file's size.
TriangleMesh read_mesh(const std::filesystem::path& path);

/// True if the extension is one that read_mesh knows.
bool is_mesh_file(const std::filesystem::path& path);

/// The readers on bytes in memory; `file` is for messages only.
TriangleMesh parse_obj(std::string_view bytes, const std::string& file);
TriangleMesh parse_off(std::string_view bytes, const std::string& file);
TriangleMesh parse_ply(std::string_view bytes, const std::string& file);
TriangleMesh parse_stl(std::string_view bytes, const std::string& file);

/// The whole file. Throws InputError for what is missing, unreadable, empty, or not a regular file.
std::string read_bytes(const std::filesystem::path& path);

} // namespace cinch
