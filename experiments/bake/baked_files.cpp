// SPDX-License-Identifier: GPL-3.0-or-later
#include <cctype>
#include <cmath>
#include <initializer_list>
#include <limits>

#include <fmt/format.h>
#include <zlib.h>

#include "experiments/bake/baked_clip.hpp"
#include "experiments/report/whole_file.hpp"

namespace cinch {
namespace {

template <class T> void put(std::string& out, T value)
{
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

// An array in NumPy's format, version 1.
std::string npy(const std::string& type, const std::vector<std::size_t>& shape, const std::string& data)
{
    std::string header =
        fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({},), }}", type, fmt::join(shape, ", "));
    while ((10 + header.size() + 1) % 64 != 0)
        header += ' ';
    header += '\n';
    std::string out("\x93NUMPY\x01\x00", 8);
    put(out, static_cast<std::uint16_t>(header.size()));
    return out + header + data;
}

// A zip archive of stored files, the 1980 date in each; with 64-bit sizes nowhere: NumPy's own archives of this size.
class Archive {
public:
    void add(const std::string& name, const std::string& data)
    {
        if (body_.size() + data.size() > 0xf0000000u)
            throw InputError("the archive would be larger than 4 GB; --level takes fewer BVs");
        const auto crc =
            static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(data.data()), data.size()));
        const auto offset = static_cast<std::uint32_t>(body_.size()), size = static_cast<std::uint32_t>(data.size());
        std::string common; // of both headers
        for (const std::uint16_t x : std::initializer_list<std::uint16_t>{20, 0x800, 0, 0, 0x21})
            put(common, x);
        for (const std::uint32_t x : {crc, size, size})
            put(common, x);
        put(common, static_cast<std::uint16_t>(name.size()));
        put(common, std::uint16_t{0});
        body_ += std::string("PK\x03\x04", 4) + common + name + data;
        directory_ += std::string("PK\x01\x02", 4) + std::string("\x14\x00", 2) + common + std::string(10, '\0');
        put(directory_, offset);
        directory_ += name;
        ++count_;
    }
    std::string bytes() const
    {
        std::string end("PK\x05\x06\0\0\0\0", 8);
        put(end, count_);
        put(end, count_);
        put(end, static_cast<std::uint32_t>(directory_.size()));
        put(end, static_cast<std::uint32_t>(body_.size()));
        put(end, std::uint16_t{0});
        return body_ + directory_ + end;
    }

private:
    std::string body_, directory_;
    std::uint16_t count_ = 0;
};

std::string bytes_of(const std::vector<double>& values)
{
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double)};
}

} // namespace

void write_npz(const std::string& file, std::span<const std::uint32_t> levels, std::size_t bvs, int kdop,
               const std::vector<std::pair<std::string, std::vector<BakedInterval>>>& clips)
{
    const auto k = static_cast<std::size_t>(kdop);
    Archive archive;
    std::string of_each;
    for (std::size_t bv = 0; bv < bvs; ++bv)
        put(of_each, static_cast<std::uint32_t>(level_of(levels, bv)));
    archive.add("level.npy", npy("<u4", {bvs}, of_each));
    for (const auto& [name, intervals] : clips) {
        std::vector<double> times, bounds;
        for (const BakedInterval& interval : intervals) {
            times.insert(times.end(), {interval.first_s, interval.last_s});
            for (std::size_t bv = 0; bv < bvs; ++bv) {
                const double* s = interval.supports.data() + bv * k;
                if (kdop == 6)
                    bounds.insert(bounds.end(), {-s[1], -s[3], -s[5], s[0], s[2], s[4]});
                else
                    bounds.insert(bounds.end(), s, s + k);
            }
        }
        archive.add(name + "/times.npy", npy("<f8", {intervals.size(), 2}, bytes_of(times)));
        const std::vector<std::size_t> shape = kdop == 6 ? std::vector<std::size_t>{intervals.size(), bvs, 2, 3}
                                                         : std::vector<std::size_t>{intervals.size(), bvs, k};
        archive.add(name + "/bounds.npy", npy("<f8", shape, bytes_of(bounds)));
    }
    write_whole(file, archive.bytes());
}

void write_usd(const std::string& file, const std::vector<std::pair<std::string, std::vector<BakedInterval>>>& clips)
{
    std::string text =
        "#usda 1.0\n(\n    doc = \"Bounds of clips, each for all times\"\n    timeCodesPerSecond = 1\n)\n";
    for (const auto& [name, intervals] : clips) {
        std::string prim = "clip_";
        for (const char c : name)
            prim += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
        text += fmt::format("\nover \"{}\"\n{{\n    float3[] extent.timeSamples = {{\n", prim);
        for (std::size_t i = 0; i <= intervals.size(); ++i) {
            double s[6];
            std::fill(std::begin(s), std::end(s), -std::numeric_limits<double>::infinity());
            for (std::size_t n = i ? i - 1 : 0; n <= i && n < intervals.size(); ++n)
                for (std::size_t d = 0; d < 6; ++d)
                    s[d] = std::max(s[d], intervals[n].supports[d]);
            // Floats, outward.
            float low[3], high[3];
            for (std::size_t a = 0; a < 3; ++a) {
                high[a] = std::nextafter(static_cast<float>(s[2 * a]), HUGE_VALF);
                low[a] = std::nextafter(static_cast<float>(-s[2 * a + 1]), -HUGE_VALF);
            }
            text += fmt::format("        {:.17g}: [({:.9g}, {:.9g}, {:.9g}), ({:.9g}, {:.9g}, {:.9g})],\n",
                                i < intervals.size() ? intervals[i].first_s : intervals.back().last_s, low[0], low[1],
                                low[2], high[0], high[1], high[2]);
        }
        text += "    }\n}\n";
    }
    write_whole(file, text);
}

} // namespace cinch
