// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <ranges>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cinch/surface.hpp"

namespace cinch::test {

/// A folder that disappears with the object.
class TemporaryFolder {
public:
    TemporaryFolder();
    ~TemporaryFolder();
    std::filesystem::path write(const std::string& name, std::string_view bytes) const;
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

/// A file or folder of the reference material, or empty with a line that ctest takes for "skipped".
std::optional<std::filesystem::path> shared(const std::string& name);

/// How much of the long tests is run, as the environment's CINCH_TEST_SHARE says: 1 if it says nothing; little for
/// sanitizers, like 0.05; above 1 also what takes minutes.
double test_share();
/// Of so many cases, but at least one, and all from a share of 1 on.
std::size_t share_of(std::size_t cases);
/// The first ones of a list, which must outlive the result.
template <std::ranges::contiguous_range List> auto share_of(List& cases)
{
    return std::span(cases).first(share_of(std::size(cases)));
}

struct Run {
    int status = -1;
    std::string out, err;
    std::vector<std::string> lines() const; ///< of out
};
/// Runs the program with these arguments (a shell line) and waits.
Run cinch(const std::string& arguments);
/// The same with a setting of the environment, NAME=value.
Run cinch_with(const std::string& setting, const std::string& arguments);
/// The same, with an interrupt (Ctrl-C) after so many seconds.
Run cinch_interrupted(const std::string& arguments, int seconds);
/// The same, killed outright after so many seconds.
Run cinch_killed(const std::string& arguments, double seconds);

/// A small closed surface with kernel weights: `vertices` on a bumpy sphere, `nodes` simulation nodes.
struct Example {
    DeformableSurface surface;
    std::vector<std::vector<AffineMap>> frames; ///< rest, half and full strong motion
};
Example example(std::size_t vertices, std::size_t nodes);

} // namespace cinch::test
