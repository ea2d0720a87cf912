// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "toolkit/surface/skin.hpp"

namespace cinch {

/// Frames of node transforms as a binary file, little-endian:
///
///     8 bytes  "cinchfrm"
///     u32      version, 1
///     u32      bodies B
///     f64      seconds from frame to frame
///     u32 × B  simulation nodes of each body
///
/// then per frame
///
///     u64      number of the frame, from 0
///     f64      its time, s
///     f64 × 12 × all nodes   body by body, node by node: T_j, a 3×4 matrix row by row (Eq. 3)
///     u64      FNV-1a of the bytes of the frame before it
struct FrameLayout {
    double frame_s = 0;
    std::vector<std::uint32_t> nodes; ///< of each body

    std::size_t header_bytes() const;
    std::size_t frame_bytes() const;
};

/// The bytes of the header, and of one frame; `maps` has one list per body.
std::string frame_header(const FrameLayout& layout);
std::string frame_record(const FrameLayout& layout, std::uint64_t frame, double time_s,
                         std::span<const std::vector<AffineMap>> maps);

/// All frames of such a file, one clip per body. A file that ends within a frame has the frames before it, and
/// `cut_off` says so. Throws InputError for what is no such file or was changed.
struct FrameFile {
    FrameLayout layout;
    std::vector<Clip> bodies;
    bool cut_off = false;
};
FrameFile read_frames(const std::filesystem::path& path);

} // namespace cinch
