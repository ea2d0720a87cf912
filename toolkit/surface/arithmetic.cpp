// SPDX-License-Identifier: Apache-2.0
#include "toolkit/surface/arithmetic.hpp"

#include <stdexcept>

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

} // namespace cinch
