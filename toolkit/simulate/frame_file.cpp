// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/frame_file.hpp"

#include <bit>
#include <cmath>
#include <cstring>
#include <numeric>

#include "cinch/surface.hpp"
#include "toolkit/surface/checksum.hpp"
#include "toolkit/surface/read_mesh.hpp"

namespace cinch {
namespace {

static_assert(std::endian::native == std::endian::little, "the file is little-endian");

constexpr std::string_view magic = "cinchfrm";
constexpr std::uint32_t version = 1;

template <class T> void put(std::string& out, const T& value)
{
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
}
template <class T> T get(const std::string& bytes, std::size_t& place)
{
    T value;
    std::memcpy(&value, bytes.data() + place, sizeof value);
    place += sizeof value;
    return value;
}

} // namespace

std::size_t FrameLayout::header_bytes() const { return 24 + 4 * nodes.size(); }
std::size_t FrameLayout::frame_bytes() const
{
    return 24 + 96 * std::accumulate(nodes.begin(), nodes.end(), std::size_t(0));
}

std::string frame_header(const FrameLayout& layout)
{
    std::string out(magic);
    put(out, version);
    put(out, static_cast<std::uint32_t>(layout.nodes.size()));
    put(out, layout.frame_s);
    for (const std::uint32_t n : layout.nodes)
        put(out, n);
    return out;
}

std::string frame_record(const FrameLayout& layout, std::uint64_t frame, double time_s,
                         std::span<const std::vector<AffineMap>> maps)
{
    std::string out;
    out.reserve(layout.frame_bytes());
    put(out, frame);
    put(out, time_s);
    for (const auto& body : maps)
        for (const AffineMap& map : body)
            put(out, map);
    put(out, checksum(out));
    return out;
}

FrameFile read_frames(const std::filesystem::path& path)
{
    const std::string bytes = read_bytes(path), file = path.string();
    if (bytes.size() < 24 || !bytes.starts_with(magic))
        throw InputError::in_file(file, "is no file of frames");
    std::size_t place = magic.size();
    if (const auto found = get<std::uint32_t>(bytes, place); found != version)
        throw InputError::in_file(file, "has version " + std::to_string(found) + "; this program reads " +
                                            std::to_string(version));
    FrameFile frames;
    const auto bodies = get<std::uint32_t>(bytes, place);
    frames.layout.frame_s = get<double>(bytes, place);
    if (!(frames.layout.frame_s > 0) || !std::isfinite(frames.layout.frame_s))
        throw InputError::in_file(file,
                                  "declares " + std::to_string(frames.layout.frame_s) + " seconds from frame to frame");
    if (bytes.size() - place < std::size_t(4) * bodies)
        throw InputError::in_file(file, "ends within its header");
    for (std::uint32_t b = 0; b < bodies; ++b)
        frames.layout.nodes.push_back(get<std::uint32_t>(bytes, place));
    std::vector<double> times;
    std::vector<std::vector<Clip::Frame>> maps_of(bodies);
    const std::size_t size = frames.layout.frame_bytes();
    for (std::uint64_t frame = 0; bytes.size() - place >= size; ++frame) {
        const std::size_t start = place;
        const auto number = get<std::uint64_t>(bytes, place);
        const auto time_s = get<double>(bytes, place);
        for (std::uint32_t b = 0; b < bodies; ++b) {
            Clip::Frame maps(frames.layout.nodes[b]);
            std::memcpy(maps.data(), bytes.data() + place, 96 * maps.size());
            place += 96 * maps.size();
            maps_of[b].push_back(std::move(maps));
        }
        times.push_back(time_s);
        const std::string_view record(bytes.data() + start, place - start);
        if (get<std::uint64_t>(bytes, place) != checksum(record) || number != frame)
            throw InputError::at_byte(file, start, "frame " + std::to_string(frame) + " was changed");
    }
    for (auto& maps : maps_of)
        frames.bodies.emplace_back("simulated", times, std::move(maps));
    frames.cut_off = place != bytes.size();
    return frames;
}

} // namespace cinch
