// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/view/pack.hpp"

#include <stdexcept>
#include <string>
#include <vector>

#include <zlib.h>

namespace cinch {
namespace {

std::string base64(std::span<const std::uint8_t> bytes)
{
    constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    out.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t here = std::min<std::size_t>(3, bytes.size() - i);
        std::uint32_t group = 0;
        for (std::size_t b = 0; b < 3; ++b)
            group = group << 8 | (b < here ? bytes[i + b] : 0u);
        for (std::size_t d = 0; d < 4; ++d)
            out += d <= here ? digits[group >> (18 - 6 * d) & 63] : '=';
    }
    return out;
}

std::vector<std::uint8_t> deflated(std::span<const std::uint8_t> bytes)
{
    uLongf size = compressBound(bytes.size());
    std::vector<std::uint8_t> out(size);
    if (compress2(out.data(), &size, bytes.data(), bytes.size(), 6) != Z_OK)
        throw std::runtime_error("zlib cannot compress");
    out.resize(size);
    return out;
}

} // namespace

nlohmann::ordered_json pack(std::span<const std::int32_t> values, std::size_t frames, std::size_t items, std::size_t components)
{
    if (values.size() != frames * items * components)
        throw std::invalid_argument("pack: shape and values differ");
    const std::size_t frame = items * components;
    std::vector<std::uint32_t> error(values.size());
    std::uint32_t all = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const bool first_item = i % frame < components, first_frame = i < frame;
        auto at = [&](bool there, std::size_t back) { return there ? static_cast<std::uint32_t>(values[i - back]) : 0u; };
        const std::uint32_t d = static_cast<std::uint32_t>(values[i]) - at(!first_item, components) - at(!first_frame, frame) +
                                at(!first_item && !first_frame, components + frame);
        all |= error[i] = d << 1 ^ (d >> 31 ? ~0u : 0u);
    }
    std::size_t planes = 1;
    while (planes < 4 && all >> (8 * planes))
        ++planes;
    std::vector<std::uint8_t> bytes(planes * values.size());
    for (std::size_t p = 0; p < planes; ++p)
        for (std::size_t i = 0; i < error.size(); ++i)
            bytes[p * error.size() + i] = static_cast<std::uint8_t>(error[i] >> (8 * p));
    return {{"shape", {frames, items, components}}, {"planes", planes}, {"data", base64(deflated(bytes))}};
}

} // namespace cinch
