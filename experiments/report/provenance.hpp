// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

#include <nlohmann/json.hpp>

namespace cinch {

/// Where a result comes from; recorded with every run.
struct Provenance {
    std::string command; ///< line that started this process, without folders of the program's own
    std::string version, commit, compiler, flags, cpu, simd;
    int threads = 0;
    std::uint64_t seed = 0;
};
Provenance provenance(int threads, std::uint64_t seed);

/// Its fields in every record.
nlohmann::ordered_json to_json(const Provenance& p);

/// Two lines for people.
std::string describe(const Provenance& p);

} // namespace cinch
