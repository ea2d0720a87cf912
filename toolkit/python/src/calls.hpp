// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <stdexcept>
#include <thread>
#include <type_traits>
#include <utility>

#include <pybind11/pybind11.h>

namespace cinch::python {

namespace py = pybind11;

/// From here on, in this module, a value that is none of a kind's is a TypeError.
inline void say_type_error()
{
    py::register_local_exception_translator([](std::exception_ptr raised) {
        try {
            if (raised)
                std::rethrow_exception(raised);
        } catch (const py::cast_error& error) {
            PyErr_SetString(PyExc_TypeError, error.what());
        }
    });
}

/// How often a long call looks for Ctrl-C.
constexpr std::chrono::milliseconds look_every{50};

/// Throws KeyboardInterrupt, or what else a signal's handler raises. With the GIL.
inline void throw_if_signalled()
{
    if (PyErr_CheckSignals() != 0)
        throw py::error_already_set();
}

/// Between the pieces of a long call, without the GIL: now and then looks for Ctrl-C and tells how far it is.
class Ticker {
public:
    explicit Ticker(py::handle progress = py::none()) : progress_(progress) {}

    void operator()(std::size_t done, std::size_t all)
    {
        const auto now = std::chrono::steady_clock::now();
        if (now - last_ < look_every && !(done == all && !progress_.is_none()))
            return;
        last_ = now;
        const py::gil_scoped_acquire locked;
        throw_if_signalled();
        if (!progress_.is_none())
            progress_(done, all);
    }

private:
    py::handle progress_;
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// Whoever is in a call of an object; another call at the same time, from another thread, is an error.
class Busy {
public:
    Busy(std::atomic<bool>& flag, const char* what) : flag_(flag)
    {
        if (flag_.exchange(true))
            throw std::runtime_error(std::string("this ") + what + " is in a call already; it takes one at a time");
    }
    ~Busy() { flag_ = false; }
    Busy(const Busy&) = delete;
    Busy& operator=(const Busy&) = delete;

private:
    std::atomic<bool>& flag_;
};

/// Keeps what was left behind by Ctrl-C until it ends by itself; the interpreter waits for it before it ends.
void leave_behind(std::thread&& thread);
/// Of each module that leaves anything behind.
void join_at_exit(py::module_& module);

/// `work` in a thread of its own, while this one waits without the GIL and looks for Ctrl-C: then it is left behind,
/// and what it returns is thrown away. So it must own all that it uses, and touch nothing of Python. Work that takes
/// a flag may look at it between its pieces: true, nobody waits any more.
template <class Work> auto apart(Work&& work)
{
    auto stop = std::make_shared<std::atomic<bool>>(false);
    auto run = [work = std::forward<Work>(work), stop]() mutable {
        if constexpr (std::is_invocable_v<Work&, const std::atomic<bool>&>)
            return work(*stop);
        else
            return work();
    };
    using Result = decltype(run());
    auto task = std::make_shared<std::packaged_task<Result()>>(std::move(run));
    std::future<Result> result = task->get_future();
    std::thread thread([task = std::move(task)]() mutable {
        (*task)();
        task.reset();
    });
    for (;;) {
        std::future_status status;
        {
            const py::gil_scoped_release unlocked;
            status = result.wait_for(look_every);
            if (status == std::future_status::ready)
                thread.join();
        }
        if (status == std::future_status::ready)
            return result.get();
        if (PyErr_CheckSignals() != 0) {
            *stop = true;
            py::error_already_set interrupt;
            leave_behind(std::move(thread));
            throw interrupt;
        }
    }
}

} // namespace cinch::python
