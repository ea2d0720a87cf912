// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/view/pack.hpp"

#include <stdexcept>
#include <string>
#include <unordered_map>

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

std::vector<References> parallelograms(std::span<const std::uint32_t> corners, std::size_t vertices)
{
    std::vector<References> out(vertices);
    std::unordered_map<std::uint64_t, std::uint32_t> beyond; // an edge: the tip of the last triangle on it
    auto edge = [](std::uint32_t a, std::uint32_t b) { return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b); };
    std::uint32_t next = 0;
    for (std::size_t t = 0; t + 3 <= corners.size(); t += 3) {
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t v = corners[t + i], a = corners[t + (i + 1) % 3], b = corners[t + (i + 2) % 3];
            if (v != next)
                continue;
            const std::uint32_t known = a < v ? a : b < v ? b : v ? v - 1 : 0;
            const auto tip = beyond.find(edge(a, b));
            out[v] = tip != beyond.end() && a < v && b < v && tip->second < v ? References{a, b, tip->second}
                                                                              : References{known, known, known};
            ++next;
        }
        for (std::size_t i = 0; i < 3; ++i)
            beyond[edge(corners[t + i], corners[t + (i + 1) % 3])] = corners[t + (i + 2) % 3];
    }
    return out;
}

nlohmann::ordered_json pack(std::span<const std::int32_t> values, std::size_t frames, std::size_t items,
                            std::size_t components, std::span<const References> references)
{
    if (values.size() != frames * items * components || (!references.empty() && references.size() != items))
        throw std::invalid_argument("pack: shape and values differ");
    const std::size_t frame = items * components;
    std::vector<std::uint32_t> error(values.size());
    std::uint32_t all = 0;
    for (std::size_t f = 0; f < frames; ++f)
        for (std::size_t i = 0; i < items; ++i)
            for (std::size_t c = 0; c < components; ++c) {
                auto change = [&](std::size_t item) {
                    const std::size_t at = f * frame + item * components + c;
                    return static_cast<std::uint32_t>(values[at]) -
                           (f ? static_cast<std::uint32_t>(values[at - frame]) : 0u);
                };
                std::uint32_t d = change(i);
                if (i > 0)
                    d -= references.empty()
                             ? change(i - 1)
                             : change(references[i].a) + change(references[i].b) - change(references[i].c);
                d = d << 1 ^ (d >> 31 ? ~0u : 0u);
                error[f * frame + i * components + c] = d;
                all |= d;
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
