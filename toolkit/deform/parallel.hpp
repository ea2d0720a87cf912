// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include <tbb/parallel_for.h>

namespace cinch {

/// body(first, last) on pieces of [0, count), in parallel, every piece in the *caller's* floating-point environment. TBB would
/// otherwise run tasks, on the calling thread too, in the environment in which its arena was created long ago.
template <class Body> void parallel_blocks(std::size_t count, std::size_t grain, const Body& body)
{
    if (count <= grain) {
        if (count > 0)
            body(std::size_t{0}, count);
        return;
    }
    tbb::task_group_context context(tbb::task_group_context::isolated,
                                    tbb::task_group_context::default_traits | tbb::task_group_context::fp_settings);
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, grain), [&](const auto& range) { body(range.begin(), range.end()); }, tbb::auto_partitioner(), context);
}

} // namespace cinch
