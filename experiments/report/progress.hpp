// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <string>

namespace cinch {

/// A progress bar with the time left, on standard error and only if that is a terminal. It erases itself.
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
