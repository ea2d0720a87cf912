// SPDX-License-Identifier: Apache-2.0
#include "cinch/environment.hpp"

#include <stdexcept>

#include "toolkit/surface/current_executor.hpp"

namespace cinch {

void require_default_arithmetic()
{
    // volatile: computed here and now, not by the compiler
    volatile double one = 1, tiny = 0x1p-60, small = 0x1p-1050, half = 0.5;
    const bool to_nearest = one + tiny == 1 && -one - tiny == -1 && one - tiny == 1;
    const volatile double subnormal = small * half;
    const bool keeps_subnormals = subnormal != 0 && subnormal * 2 == small;
    if (!to_nearest)
        throw std::runtime_error("the rounding mode is not to-nearest; restore it before computing bounds");
    if (!keeps_subnormals)
        throw std::runtime_error("subnormal numbers are flushed to zero; clear FTZ and DAZ before computing bounds");
}

DefaultArithmetic::DefaultArithmetic()
{
    std::fegetenv(&before_);
    std::fesetenv(FE_DFL_ENV);
}

DefaultArithmetic::~DefaultArithmetic() { std::fesetenv(&before_); }

UseExecutor::UseExecutor(Executor& executor) : before_(current_executor()) { current_executor() = &executor; }
UseExecutor::~UseExecutor() { current_executor() = before_; }

Executor*& current_executor()
{
    thread_local Executor* executor = nullptr;
    return executor;
}

} // namespace cinch
