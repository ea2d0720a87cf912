// SPDX-License-Identifier: Apache-2.0
#include "toolkit/surface/read_mesh.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <limits>

namespace cinch {

std::string read_bytes(const std::filesystem::path& path)
{
    const std::string name = path.string();
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (!std::filesystem::exists(status))
        throw InputError::in_file(name, "no such file");
    if (std::filesystem::is_directory(status))
        throw InputError::in_file(name, "is a directory, not a file");
    std::ifstream in(path, std::ios::binary);
    if (!in)
        throw InputError::in_file(name, "cannot be opened for reading");
    std::string bytes(std::istreambuf_iterator<char>(in), {});
    if (in.bad())
        throw InputError::in_file(name, "reading failed after " + std::to_string(bytes.size()) + " bytes");
    if (bytes.empty())
        throw InputError::in_file(name, "the file is empty");
    return bytes;
}

static std::string lower_extension(const std::filesystem::path& path)
{
    std::string extension = path.extension().string();
    for (char& c : extension)
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return extension;
}

// By the bytes that such files begin with; none of them can begin a mesh.
static const char* compression_of(std::string_view bytes)
{
    using namespace std::string_view_literals;
    for (const auto& [first, name] :
         {std::pair("\x1f\x8b"sv, "gzip"), std::pair("PK\x03\x04"sv, "zip"), std::pair("BZh"sv, "bzip2"),
          std::pair("\xfd\x37zXZ"sv, "xz"), std::pair("\x28\xb5\x2f\xfd"sv, "zstd")})
        if (bytes.starts_with(first))
            return name;
    return nullptr;
}

static const MeshFormat* format_of(const std::filesystem::path& path)
{
    const std::string extension = lower_extension(path);
    const auto* const found = std::find_if(std::begin(mesh_formats), std::end(mesh_formats),
                                           [&](const MeshFormat& format) { return format.extension == extension; });
    return found == std::end(mesh_formats) ? nullptr : found;
}

std::string mesh_extensions(std::string_view others)
{
    std::string all;
    for (const MeshFormat& format : mesh_formats)
        all += (all.empty() ? "" : ", ") + std::string(format.extension);
    return all + std::string(others);
}

bool is_mesh_file(const std::filesystem::path& path) { return format_of(path) != nullptr; }

bool is_character_file(const std::filesystem::path& path)
{
    const std::string extension = lower_extension(path);
    return extension == ".glb" || extension == ".gltf" || extension == ".vrm";
}

MeshFile read_mesh(const std::filesystem::path& path)
{
    const MeshFormat* const format = format_of(path);
    if (!format)
        throw InputError::in_file(path.string(), "unknown mesh format '" + path.extension().string() + "'; known are " +
                                                     mesh_extensions());
    const std::string bytes = read_bytes(path);
    if (bytes.size() > std::numeric_limits<std::uint32_t>::max())
        throw InputError::in_file(path.string(), "is larger than 4 GiB; vertex indices have 32 bits");
    if (const char* compression = compression_of(bytes))
        throw InputError::in_file(path.string(), std::string("is compressed (") + compression + "); unpack it first");
    return format->parse(bytes, path.string());
}

} // namespace cinch
