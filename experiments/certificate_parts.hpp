// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "exact/certificate.hpp"
#include "experiments/records/row_folder.hpp"

namespace cinch {

/// A certificate in a folder, each part a compressed file that appears when it is whole: the surface, every frame, and
/// the end, which makes it one. One after the other, in the order of the alphabet, they are a certificate in one file.
class CertificateParts {
public:
    explicit CertificateParts(std::filesystem::path folder) : folder_(std::move(folder)) {}

    /// Each replaces what is there. Throw InputError where that cannot be, and Interrupted.
    void write_surface(const DeformableSurface& surface, const Bvh& bvh, const exact::Claim& claim) const;
    exact::BoundCounts write_frame(const exact::Claim& claim, std::size_t frame, const exact::FramePose& pose,
                                   std::span<const double> supports, const exact::FrameVerdict& verdict) const;
    /// Throws InputError, which names it, where a part before the end is missing.
    void write_end(std::size_t frames, const exact::BoundCounts& counts, const std::string& transforms) const;

private:
    std::filesystem::path folder_;
};

} // namespace cinch
