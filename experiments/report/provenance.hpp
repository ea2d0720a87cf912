// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

namespace cinch {

/// Where a result comes from; recorded with every run.
struct Provenance {
    std::string version, commit, compiler, flags, cpu, simd;
    int threads = 0;
    std::uint64_t seed = 0;
};
Provenance provenance(int threads, std::uint64_t seed);

/// Two lines for people.
std::string describe(const Provenance& p);

} // namespace cinch
