// SPDX-License-Identifier: Apache-2.0
// The header of a PLY file: which elements with which properties its body has.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace cinch::ply {

enum class Scalar { i8, u8, i16, u16, i32, u32, f32, f64 };
inline constexpr std::size_t scalar_bytes[] = {1, 1, 2, 2, 4, 4, 4, 8};

struct Property {
    std::string name;
    Scalar type;
    std::optional<Scalar> list_size_type; ///< set for a list
};

struct Element {
    std::string name;
    std::uint64_t count = 0;
    std::vector<Property> properties;
};

enum class Format { ascii, little, big };

struct Header {
    Format format = Format::ascii;
    std::vector<Element> elements;
    std::size_t body = 0; ///< the first byte after end_header and its line end
    std::size_t body_line = 0;
};

/// Of the whole file `bytes`. InputError with the line where it is no header.
Header read_header(std::string_view bytes, const std::string& file);

} // namespace cinch::ply
