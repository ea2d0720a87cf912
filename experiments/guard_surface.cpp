// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/guard_surface.hpp"

#include <charconv>
#include <fstream>
#include <string>

#include <nlohmann/json.hpp>

#include "experiments/report/whole_file.hpp"

namespace cinch {
namespace {

// "%20" is a blank, as in every URI.
std::string decoded(const std::string& uri)
{
    std::string out;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        unsigned char byte = 0;
        if (uri[i] == '%' && i + 2 < uri.size() &&
            std::from_chars(&uri[i + 1], &uri[i + 3], byte, 16).ptr == &uri[i + 3]) {
            out += static_cast<char>(byte);
            i += 2;
        } else {
            out += uri[i];
        }
    }
    return out;
}

} // namespace

void guard_surface(const std::filesystem::path& file)
{
    guard_input(file);
    std::string extension = file.extension().string();
    for (char& c : extension)
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (extension != ".gltf")
        return;
    std::ifstream in(file, std::ios::binary);
    const nlohmann::json root =
        nlohmann::json::parse(in, nullptr, false); // what is no JSON is for the reader to refuse
    for (const char* list : {"buffers", "images"})
        if (root.is_object() && root.contains(list) && root[list].is_array())
            for (const auto& entry : root[list])
                if (entry.is_object() && entry.contains("uri") && entry["uri"].is_string())
                    if (const auto uri = entry["uri"].get<std::string>(); !uri.starts_with("data:"))
                        guard_input(file.parent_path() / decoded(uri));
}

} // namespace cinch
