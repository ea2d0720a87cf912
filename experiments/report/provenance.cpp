// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/provenance.hpp"

#include <fstream>

#include <fmt/format.h>

#include "commit.hpp"
#include "toolkit/bounds/kernel/bound_kernel.hpp"

namespace cinch {
namespace {

std::string cpu_name()
{
    std::ifstream info("/proc/cpuinfo");
    for (std::string line; std::getline(info, line);)
        if (line.starts_with("model name") && line.find(": ") != std::string::npos)
            return line.substr(line.find(": ") + 2);
    return "unknown";
}

std::string compiler_name()
{
#if defined(__clang__)
    return fmt::format("clang {}.{}.{}", __clang_major__, __clang_minor__, __clang_patchlevel__);
#else
    return fmt::format("g++ {}.{}.{}", __GNUC__, __GNUC_MINOR__, __GNUC_PATCHLEVEL__);
#endif
}

} // namespace

Provenance provenance(int threads, std::uint64_t seed)
{
    return {CINCH_VERSION, CINCH_COMMIT, compiler_name(), CINCH_FLAGS, cpu_name(), kernel_target(), threads, seed};
}

std::string describe(const Provenance& p)
{
    return fmt::format("cinch {} ({}), {}, seed {}\n{}, {} {}, {}", p.version, p.commit, p.compiler, p.seed, p.cpu, p.threads,
                       p.threads == 1 ? "thread" : "threads", p.simd);
}

} // namespace cinch
