// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <string>

namespace cinch {

/// Whether lines on standard error can be drawn over: a terminal, and no TERM=dumb.
bool draws_over_lines();

/// A progress bar with the time left, on standard error and only where lines can be drawn over. It erases itself.
class Progress {
public:
    Progress(std::string what, std::size_t steps);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    void done(std::size_t steps);

private:
    void draw(std::size_t done) const;

    std::string what_;
    std::size_t steps_;
    bool terminal_;
    std::chrono::steady_clock::time_point start_;
};

} // namespace cinch
