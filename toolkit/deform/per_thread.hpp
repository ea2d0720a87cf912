// SPDX-License-Identifier: Apache-2.0
#pragma once

#if defined(CINCH_WITHOUT_TBB)
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#else
#include <tbb/enumerable_thread_specific.h>
#endif

namespace cinch {

#if defined(CINCH_WITHOUT_TBB)
/// A value for each thread that asks for its own, made when it first does.
template <class T> class PerThread {
public:
    T& local()
    {
        const std::lock_guard lock(all_->mutex);
        return all_->of[std::this_thread::get_id()]; // stays where it is
    }

private:
    struct All {
        std::mutex mutex;
        std::map<std::thread::id, T> of;
    };
    std::unique_ptr<All> all_ = std::make_unique<All>();
};
#else
template <class T> using PerThread = tbb::enumerable_thread_specific<T>;
#endif

} // namespace cinch
