// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/certificate_parts.hpp"

#include <fmt/format.h>

#include "cinch/surface.hpp"
#include "experiments/report/interrupt.hpp"
#include "experiments/report/line_file.hpp"

namespace cinch {
namespace {

constexpr const char *surface_file = "0-surface.jsonl.gz", *end_file = "2-end.jsonl.gz";

std::string frame_file(std::size_t frame) { return fmt::format("1-frame-{:08}.jsonl.gz", frame); }

// What `write` says, line by line.
template <class Write> void write_part(const std::filesystem::path& folder, const std::string& name, const Write& write)
{
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (!std::filesystem::is_directory(folder, error))
        throw InputError::in_file(folder.string(), "is no folder and cannot be made one");
    LineFile file((folder / name).string());
    write([&](std::string_view text) {
        throw_if_interrupted(); // then there is none
        file.line(text);
    });
    file.commit();
}

} // namespace

void CertificateParts::write_surface(const DeformableSurface& surface, const Bvh& bvh, const exact::Claim& claim) const
{
    write_part(folder_, surface_file,
               [&](const exact::LineSink& line) { exact::write_surface(surface, bvh, claim, line); });
}

exact::BoundCounts CertificateParts::write_frame(const exact::Claim& claim, std::size_t frame,
                                                 const exact::FramePose& pose, std::span<const double> supports,
                                                 const exact::FrameVerdict& verdict) const
{
    exact::BoundCounts counts;
    write_part(folder_, frame_file(frame), [&](const exact::LineSink& line) {
        counts = exact::write_frame(claim, frame, pose, supports, verdict, line);
    });
    return counts;
}

void CertificateParts::write_end(std::size_t frames, const exact::BoundCounts& counts,
                                 const std::string& transforms) const
{
    auto need = [&](const std::string& name) {
        if (!std::filesystem::is_regular_file(folder_ / name))
            throw InputError::in_file((folder_ / name).string(), "is missing, though its rows are there; remove the "
                                                                 "rows (shard-*.jsonl) and run their shards again");
    };
    need(surface_file);
    for (std::size_t f = 0; f < frames; ++f)
        need(frame_file(f));
    write_part(folder_, end_file,
               [&](const exact::LineSink& line) { exact::write_end(frames, counts, transforms, line); });
}

} // namespace cinch
