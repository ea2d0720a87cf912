// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cfenv>
#include <cstddef>
#if defined(__SANITIZE_THREAD__)
#include <atomic>
#endif

#if !defined(CINCH_WITHOUT_TBB)
#include <tbb/parallel_for.h>
#endif

#include "toolkit/surface/current_executor.hpp"

namespace cinch {

/// body(first, last) on pieces of [0, count), in parallel, by the thread's executor (cinch/environment.hpp) or else
/// oneTBB, or in a build without it as one piece; every piece in the *caller's* floating-point environment. TBB would
/// otherwise run tasks, on the calling thread too, in the environment in which its arena was created long ago.
template <class Body> void parallel_blocks(std::size_t count, std::size_t grain, const Body& body)
{
    if (count <= grain) {
        if (count > 0)
            body(std::size_t{0}, count);
        return;
    }
    if (Executor* const executor = current_executor()) {
        std::fenv_t callers;
        std::fegetenv(&callers);
        executor->run((count + grain - 1) / grain, [&](std::size_t piece) {
            std::fenv_t own;
            std::fegetenv(&own);
            std::fesetenv(&callers);
            { // what the piece does in parallel goes the same way
                const UseExecutor same(*executor);
                body(piece * grain, std::min(count, (piece + 1) * grain));
            }
            std::fesetenv(&own);
        });
        return;
    }
#if defined(CINCH_WITHOUT_TBB)
    body(std::size_t{0}, count);
#else
    tbb::task_group_context context(tbb::task_group_context::isolated,
                                    tbb::task_group_context::default_traits | tbb::task_group_context::fp_settings);
    auto run = [&](const auto& range) { body(range.begin(), range.end()); };
    const tbb::blocked_range<std::size_t> all(0, count, grain);
#if defined(__SANITIZE_THREAD__) // says what a TBB without instrumentation cannot: pieces come after what was before,
                                 // and before what is after
    std::atomic<int> before{0}, after{0}; // two: pieces do not order each other
    before.store(1, std::memory_order_release);
    auto told = [&](const auto& range) {
        before.load(std::memory_order_acquire);
        run(range);
        after.fetch_add(1, std::memory_order_release);
    };
    tbb::parallel_for(all, told, tbb::auto_partitioner(), context);
    after.load(std::memory_order_acquire);
#else
    tbb::parallel_for(all, run, tbb::auto_partitioner(), context);
#endif
#endif
}

} // namespace cinch
