// SPDX-License-Identifier: Apache-2.0
#include "toolkit/bounds/kernel/bound_kernel.hpp"

#include "cinch/bounds.hpp"
#include "toolkit/bounds/kernel/bound_kdop.hpp"

namespace cinch {

template <class T> void bound_packed(const KernelInput<T>& input, std::size_t first, std::size_t last,
                                     KernelScratch<T>& scratch, std::span<double> supports)
{
    with_axes(input.maps->kdop,
              [&]<std::size_t kAxes>() { bound_kdop<T, kAxes>(input, first, last, scratch, supports.data()); });
}

template <class T> void bound_packed(const KernelInput<T>& input, std::span<const std::uint32_t> list,
                                     KernelScratch<T>& scratch, std::size_t side, float* dops)
{
    with_axes(input.maps->kdop, [&]<std::size_t kAxes>() { bound_kdop<T, kAxes>(input, list, scratch, side, dops); });
}

template void bound_packed(const KernelInput<float>&, std::size_t, std::size_t, KernelScratch<float>&,
                           std::span<double>);
template void bound_packed(const KernelInput<double>&, std::size_t, std::size_t, KernelScratch<double>&,
                           std::span<double>);
template void bound_packed(const KernelInput<float>&, std::span<const std::uint32_t>, KernelScratch<float>&,
                           std::size_t, float*);
template void bound_packed(const KernelInput<double>&, std::span<const std::uint32_t>, KernelScratch<double>&,
                           std::size_t, float*);

} // namespace cinch
