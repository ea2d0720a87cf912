// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/progress.hpp"

#include <cstdio>
#include <cstdlib>
#include <string_view>

#include <fmt/format.h>
#include <unistd.h>

#include "experiments/report/number.hpp"

namespace cinch {

bool draws_over_lines()
{
    const char* kind = std::getenv("TERM");
    return isatty(STDERR_FILENO) == 1 && !(kind && std::string_view(kind) == "dumb");
}

Progress::Progress(std::string what, std::size_t steps)
    : what_(std::move(what)), steps_(steps), terminal_(draws_over_lines()), start_(std::chrono::steady_clock::now())
{
    draw(0);
}

Progress::~Progress()
{
    if (terminal_)
        fmt::print(stderr, "\r\x1b[K");
}

void Progress::done(std::size_t steps) { draw(steps); }

void Progress::draw(std::size_t done) const
{
    if (!terminal_ || steps_ == 0)
        return;
    constexpr std::size_t width = 30;
    const std::size_t filled = width * done / steps_;
    std::string left;
    if (done > 0) {
        const double elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
        left = ", " + duration(elapsed / static_cast<double>(done) * static_cast<double>(steps_ - done)) + " left";
    }
    fmt::print(stderr, "\r\x1b[K{} [{}{}] {}/{}{}", what_, std::string(filled, '#'), std::string(width - filled, ' '),
               done, steps_, left);
    std::fflush(stderr);
}

} // namespace cinch
