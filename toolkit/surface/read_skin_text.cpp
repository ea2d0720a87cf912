// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>

#include "cinch/environment.hpp"
#include "toolkit/surface/read_mesh.hpp"
#include "toolkit/surface/skin.hpp"
#include "toolkit/surface/text_scan.hpp"

namespace cinch {
namespace {

std::size_t count_between(TextScan& scan, const char* what, std::int64_t least)
{
    const std::int64_t n = scan.integer(scan.word_across_lines(what), what);
    if (n < least || n > std::numeric_limits<std::int32_t>::max())
        scan.fail(std::string(what) + " is " + std::to_string(n));
    return static_cast<std::size_t>(n);
}

void expect_count(TextScan& scan, std::size_t found, std::size_t wanted, const std::string& what,
                  const std::string& other)
{
    if (found != wanted)
        scan.fail("declares " + std::to_string(found) + " " + what + ", but the " + other + " " +
                  std::to_string(wanted));
}

} // namespace

Influences parse_weights_text(std::string_view bytes, const std::string& file, std::size_t vertices)
{
    require_default_arithmetic();
    TextScan scan(bytes, file, {.comment = '#'});
    expect_count(scan, count_between(scan, "the number of vertices", 0), vertices, "vertices", "mesh has");
    Influences out;
    out.node_count = static_cast<std::uint32_t>(count_between(scan, "the number of nodes", 1));
    std::vector<std::pair<std::uint32_t, double>> entries;
    for (std::size_t k = 0; k < vertices; ++k) {
        const std::size_t n = count_between(scan, "the number of influences", 1);
        entries.clear();
        for (std::size_t i = 0; i < n; ++i) {
            const std::int64_t node = scan.integer(scan.word_across_lines("a node index"), "a node index");
            if (node < 0 || node >= static_cast<std::int64_t>(out.node_count))
                scan.fail("node index " + std::to_string(node) + " of vertex " + std::to_string(k) +
                          " is out of range; the file declares " + std::to_string(out.node_count) + " nodes");
            const double weight = scan.number(scan.word_across_lines("a weight"), "a weight");
            if (weight < 0)
                scan.fail("vertex " + std::to_string(k) + " has a negative weight");
            entries.emplace_back(static_cast<std::uint32_t>(node), weight);
        }
        std::sort(entries.begin(), entries.end());
        for (std::size_t i = 0; i < entries.size(); ++i) {
            if (i > 0 && entries[i].first == entries[i - 1].first)
                scan.fail("vertex " + std::to_string(k) + " names node " + std::to_string(entries[i].first) + " twice");
            out.node.push_back(entries[i].first);
            out.weight.push_back(entries[i].second);
        }
        out.row.push_back(static_cast<std::uint32_t>(out.node.size()));
    }
    if (scan.next_line())
        scan.fail("more lines than the " + std::to_string(vertices) + " vertices declared");
    return out;
}

std::vector<Clip> parse_clips_text(std::string_view bytes, const std::string& file, std::uint32_t nodes)
{
    require_default_arithmetic();
    TextScan scan(bytes, file, {.comment = '#'});
    const std::size_t clips = count_between(scan, "the number of clips", 1);
    std::vector<Clip> out;
    for (std::size_t c = 0; c < clips; ++c) {
        const std::string name(scan.word_across_lines("the name of a clip"));
        std::vector<double> time_s;
        std::vector<Clip::Frame> all;
        const std::size_t frames = count_between(scan, "the number of frames", 1);
        expect_count(scan, count_between(scan, "the number of nodes", 1), nodes, "nodes", "weights have");
        for (std::size_t f = 0; f < frames; ++f) {
            time_s.push_back(scan.number(scan.word_across_lines("a time"), "a time"));
            Clip::Frame frame;
            for (std::uint32_t j = 0; j < nodes; ++j) {
                AffineMap map;
                for (auto& row : map.m)
                    for (double& x : row)
                        x = scan.number(scan.word_across_lines("a matrix entry"), "a matrix entry");
                frame.push_back(map);
            }
            all.push_back(std::move(frame));
        }
        out.emplace_back(name, std::move(time_s), std::move(all));
    }
    if (scan.next_line())
        scan.fail("more lines than the " + std::to_string(clips) + " clips declared");
    return out;
}

Influences read_weights_text(const std::filesystem::path& path, std::size_t vertices)
{
    return parse_weights_text(read_bytes(path), path.string(), vertices);
}

std::vector<Clip> read_clips_text(const std::filesystem::path& path, std::uint32_t nodes)
{
    return parse_clips_text(read_bytes(path), path.string(), nodes);
}

} // namespace cinch
