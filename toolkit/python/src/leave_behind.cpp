// SPDX-License-Identifier: Apache-2.0
#include <mutex>
#include <vector>

#include "toolkit/python/src/calls.hpp"

namespace cinch::python {
namespace {

std::mutex left_mutex;
std::vector<std::thread> left;

// Without the GIL: what was left may need it.
void join_left()
{
    const py::gil_scoped_release unlocked;
    for (;;) {
        std::vector<std::thread> some;
        {
            const std::lock_guard lock(left_mutex);
            some.swap(left);
        }
        if (some.empty())
            return;
        for (std::thread& thread : some)
            thread.join();
    }
}

} // namespace

void leave_behind(std::thread&& thread)
{
    const std::lock_guard lock(left_mutex);
    left.push_back(std::move(thread));
}

void join_at_exit(py::module_& module)
{
    module.def("_join_left", &join_left);
    py::module_::import("atexit").attr("register")(module.attr("_join_left"));
}

} // namespace cinch::python
