// SPDX-License-Identifier: GPL-3.0-or-later
// Internal to exact/.
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include <nettle/sha2.h>

namespace cinch::exact {

/// SHA-256 of bytes, and of numbers as their bytes from the least significant on, whatever the machine.
class Sha256 {
public:
    Sha256() { sha256_init(&state_); }

    void add(std::string_view bytes)
    {
        sha256_update(&state_, bytes.size(), reinterpret_cast<const std::uint8_t*>(bytes.data()));
    }
    void add(std::uint32_t x) { add_bytes(x, 4); }
    void add(double x) { add_bytes(std::bit_cast<std::uint64_t>(x), 8); }
    template <class T> void add(std::span<const T> values)
    {
        for (T x : values)
            add(x);
    }
    /// Length and text, so that no two lists of texts give the same bytes.
    void add_text(std::string_view text)
    {
        add(std::to_string(text.size()) + ":");
        add(text);
    }
    /// 64 hexadecimal digits; starts anew.
    std::string hex()
    {
        std::uint8_t digest[SHA256_DIGEST_SIZE];
        sha256_digest(&state_, sizeof digest, digest);
        std::string text;
        for (std::uint8_t byte : digest) {
            text += "0123456789abcdef"[byte >> 4];
            text += "0123456789abcdef"[byte & 15];
        }
        return text;
    }

private:
    void add_bytes(std::uint64_t x, std::size_t count)
    {
        std::uint8_t bytes[8];
        for (std::size_t i = 0; i < count; ++i)
            bytes[i] = static_cast<std::uint8_t>(x >> (8 * i));
        sha256_update(&state_, count, bytes);
    }

    sha256_ctx state_;
};

} // namespace cinch::exact
