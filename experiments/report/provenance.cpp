// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/provenance.hpp"

#include <fstream>

#include <fmt/format.h>

#include "commit.hpp"
#include "toolkit/deform/kernel/targets.hpp"

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

// An argument as a shell takes it.
std::string shell_word(const std::string& text)
{
    if (!text.empty() &&
        text.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./,:@%") ==
            std::string::npos)
        return text;
    std::string out = "'";
    for (const char c : text)
        out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return out + "'";
}

std::string command_line()
{
    std::ifstream in("/proc/self/cmdline");
    std::string out, word;
    while (std::getline(in, word, '\0'))
        out += out.empty() ? word.substr(word.find_last_of('/') + 1) : " " + shell_word(word);
    return out;
}

} // namespace

nlohmann::ordered_json to_json(const Provenance& p)
{
    return {{"command", p.command},   {"version", p.version}, {"commit", p.commit},
            {"compiler", p.compiler}, {"flags", p.flags},     {"cpu", p.cpu},
            {"simd_target", p.simd},  {"threads", p.threads}, {"seed", p.seed}};
}

Provenance provenance(int threads, std::uint64_t seed)
{
    return {command_line(),  CINCH_VERSION, CINCH_COMMIT, compiler_name(), CINCH_FLAGS, cpu_name(),
            kernel_target(), threads,       seed};
}

std::string describe(const Provenance& p)
{
    if (p.cpu == "any")
        return fmt::format("cinch {} ({}), {}, seed {}", p.version, p.commit, p.compiler, p.seed);
    return fmt::format("cinch {} ({}), {}, seed {}\n{}, {} {}, {}", p.version, p.commit, p.compiler, p.seed, p.cpu,
                       p.threads, p.threads == 1 ? "thread" : "threads", p.simd);
}

} // namespace cinch
