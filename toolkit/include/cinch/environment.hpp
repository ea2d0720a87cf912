// SPDX-License-Identifier: Apache-2.0
#pragma once

/// \file
/// What the guarantee rests on, the thread's floating-point environment; and who runs what goes in parallel.

#include <cfenv>
#include <cstddef>
#include <functional>

#include "cinch/version.hpp"

namespace cinch {

/// Throws std::runtime_error unless this thread's arithmetic rounds to nearest and keeps subnormals: every guarantee
/// rests on it. Linking anything with -ffast-math, or a plug-in host that sets flush-to-zero, breaks it for the whole
/// thread. Asked wherever numbers are made that bounds rest on: by readers, weights, motions and clips, trees, refits,
/// queries and steps.
void require_default_arithmetic();

/// While it lives, this thread's arithmetic is the default one: rounded to nearest, with subnormal numbers, no traps.
/// Afterwards it is what it was, flush-to-zero included. For hosts that change it: an audio or game engine's thread.
class DefaultArithmetic {
public:
    DefaultArithmetic();
    ~DefaultArithmetic();
    DefaultArithmetic(const DefaultArithmetic&) = delete;
    DefaultArithmetic& operator=(const DefaultArithmetic&) = delete;

private:
    std::fenv_t before_;
};

/// An engine's jobs in the place of oneTBB.
class Executor {
public:
    virtual ~Executor() = default;
    /// Calls task(i) once for every i < count, on any threads, in any order or at once, and returns when all have
    /// returned. No task throws.
    virtual void run(std::size_t count, const std::function<void(std::size_t)>& task) = 0;
};

/// While it lives, what this thread calls goes in parallel by that executor; results are the same bits. The executor
/// must stay alive.
class UseExecutor {
public:
    /// Until the end of this value's life.
    explicit UseExecutor(Executor& executor);
    ~UseExecutor();
    UseExecutor(const UseExecutor&) = delete;
    UseExecutor& operator=(const UseExecutor&) = delete;

private:
    Executor* before_;
};

} // namespace cinch
