// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <stdexcept>
#include <string>

#include "cinch/cinch.h"
#include "cinch/environment.hpp"

namespace cinch::c {

/// What fails with a status that no exception of the library has.
class Fault : public std::runtime_error {
public:
    Fault(cinch_status status, const std::string& why) : std::runtime_error(why), status_(status) {}
    cinch_status status() const { return status_; }

private:
    cinch_status status_;
};

/// The exception that is being handled, as a status; its sentence is the thread's message from now on.
cinch_status failed() noexcept;

/// While it lives, this thread goes parallel by what cinch_use_executor() was given.
class Parallel {
public:
    Parallel();

private:
    class Jobs : public Executor {
    public:
        Jobs(cinch_run jobs, void* context) : run_(jobs), context_(context) {}
        void run(std::size_t count, const std::function<void(std::size_t)>& task) override;

    private:
        cinch_run run_;
        void* context_;
    };
    std::optional<Jobs> jobs_;
    std::optional<UseExecutor> use_;
};

/// What every function of cinch.h does: no exception leaves it.
template <class F> cinch_status call(F&& f) noexcept
{
    try {
        const Parallel parallel;
        f();
        return CINCH_OK;
    } catch (...) {
        return failed();
    }
}

} // namespace cinch::c
