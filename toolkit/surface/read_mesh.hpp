// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "cinch/io.hpp"

namespace cinch {

/// The readers on bytes in memory; `file` is for messages only.
MeshFile parse_obj(std::string_view bytes, const std::string& file);
MeshFile parse_off(std::string_view bytes, const std::string& file);
MeshFile parse_ply(std::string_view bytes, const std::string& file);
MeshFile parse_stl(std::string_view bytes, const std::string& file);

struct MeshFormat {
    std::string_view extension; ///< in lower case
    MeshFile (*parse)(std::string_view, const std::string&);
};
inline constexpr MeshFormat mesh_formats[] = {
    {".obj", parse_obj}, {".off", parse_off}, {".ply", parse_ply}, {".stl", parse_stl}};

/// ".obj, .off, .ply, .stl", with what else there is.
std::string mesh_extensions(std::string_view others = "");

/// The whole file. Throws InputError for what is missing, unreadable, empty, or not a regular file.
std::string read_bytes(const std::filesystem::path& path);

} // namespace cinch
