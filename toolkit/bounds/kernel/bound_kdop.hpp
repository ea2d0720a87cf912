// SPDX-License-Identifier: Apache-2.0
// Internal to the kernels: bound_packed for one k-DOP and arithmetic, each of which is compiled by itself.
#pragma once

#include "toolkit/bounds/kernel/bound_kernel.hpp"

namespace cinch {

template <class T, std::size_t kAxes> void bound_kdop(const KernelInput<T>& input, std::size_t first, std::size_t last,
                                                      KernelScratch<T>& scratch, double* supports);

template <class T, std::size_t kAxes> void bound_kdop(const KernelInput<T>& input, std::span<const std::uint32_t> list,
                                                      KernelScratch<T>& scratch, std::size_t side, float* dops);

} // namespace cinch
