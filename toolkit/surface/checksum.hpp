// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

namespace cinch {

/// FNV-1a, 64 bits; of all bytes before and these, given that of those before. A single changed byte always changes it:
/// each step maps states one to one.
inline constexpr std::uint64_t checksum_of_nothing = 0xcbf29ce484222325u;
constexpr std::uint64_t checksum(std::string_view bytes, std::uint64_t before = checksum_of_nothing)
{
    std::uint64_t hash = before;
    for (const char c : bytes) {
        hash ^= static_cast<unsigned char>(c);
        hash *= 0x100000001b3u;
    }
    return hash;
}

} // namespace cinch
