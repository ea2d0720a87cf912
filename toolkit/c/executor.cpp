// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <exception>
#include <mutex>
#include <vector>

#include "toolkit/c/call.hpp"

namespace cinch::c {
namespace {

struct Jobs {
    cinch_run run = nullptr;
    void* context = nullptr;
};
thread_local Jobs jobs_of_thread;

// What an engine does the parts of. Each is done once, whatever it calls, and no exception goes through its frames.
struct Work {
    const std::function<void(std::size_t)>& task;
    std::vector<std::atomic<bool>> begun;
    std::atomic<std::size_t> done{0};
    std::mutex mutex;
    std::exception_ptr thrown;

    Work(const std::function<void(std::size_t)>& of, std::size_t count) : task(of), begun(count) {}

    static void part(void* work, std::size_t i) noexcept
    {
        Work& w = *static_cast<Work*>(work);
        if (i >= w.begun.size() || w.begun[i].exchange(true))
            return;
        try {
            w.task(i);
        } catch (...) {
            const std::lock_guard lock(w.mutex);
            if (!w.thrown)
                w.thrown = std::current_exception();
        }
        w.done.fetch_add(1);
    }
};

} // namespace

Parallel::Parallel()
{
    if (!jobs_of_thread.run)
        return;
    jobs_.emplace(jobs_of_thread.run, jobs_of_thread.context);
    use_.emplace(*jobs_);
}

void Parallel::Jobs::run(std::size_t count, const std::function<void(std::size_t)>& task)
{
    Work work(task, count);
    run_(context_, count, Work::part, &work);
    if (work.thrown)
        std::rethrow_exception(work.thrown);
    if (work.done.load() != count)
        throw std::runtime_error("the executor did " + std::to_string(work.done.load()) + " of " +
                                 std::to_string(count) + " tasks");
}

} // namespace cinch::c

cinch_status cinch_use_executor(cinch_run run, void* context)
{
    cinch::c::jobs_of_thread = {run, context};
    return CINCH_OK;
}
