// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <chrono>
#include <future>
#include <thread>
#include <type_traits>

#include "experiments/report/interrupt.hpp"

namespace cinch {

/// Set once a call was left behind: the process has to end by _exit, as nobody waits for its thread.
inline std::atomic<bool> some_call_was_left = false;

/// call(), on a thread of its own, for what takes long and cannot be stopped between its steps (files, trees,
/// discretisations). Throws Interrupted as soon as there is an interrupt, and leaves the call behind: it goes on until
/// the process ends, so it must own all that it reads, or share it.
template <class Call> std::invoke_result_t<Call&> or_leave(Call call)
{
    throw_if_interrupted();
    std::packaged_task<std::invoke_result_t<Call&>()> task(std::move(call));
    auto result = task.get_future();
    std::thread thread(std::move(task));
    while (result.wait_for(std::chrono::milliseconds(20)) != std::future_status::ready)
        if (interrupted()) {
            thread.detach();
            some_call_was_left = true;
            throw Interrupted{};
        }
    thread.join();
    return result.get();
}

} // namespace cinch
