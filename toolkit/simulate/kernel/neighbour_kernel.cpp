// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/kernel/neighbour_kernel.hpp"

// As the kernels of the bounds: targets with fused multiply-add, and portable code that calls fma().
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "toolkit/simulate/kernel/neighbour_kernel.cpp"
#include <hwy/foreach_target.h>

#include "toolkit/simulate/kernel/quad-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

// Two neighbours at a time, each with sums of its own, hide the latency of the multiply-adds.
void gather_gradients(const NeighbourLists& lists, const double* x, double* gradient)
{
    const std::uint32_t* node = lists.node.data();
    const double* d = lists.d.data();
    for (std::size_t i = 0; i + 1 < lists.row.size(); ++i) {
        const Quad here = Quad::load(x + 4 * i);
        Quad even[3] = {Quad::zero(), Quad::zero(), Quad::zero()}, odd[3] = {Quad::zero(), Quad::zero(), Quad::zero()};
        std::size_t e = lists.row[i];
        const std::size_t last = lists.row[i + 1];
        for (; e + 1 < last; e += 2) {
            const Quad a = Quad::load(x + 4 * std::size_t(node[e])) - here, b = Quad::load(x + 4 * std::size_t(node[e + 1])) - here;
            for (std::size_t c = 0; c < 3; ++c) {
                even[c] = multiply_add(a, d[4 * e + c], even[c]);
                odd[c] = multiply_add(b, d[4 * e + 4 + c], odd[c]);
            }
        }
        if (e < last) {
            const Quad a = Quad::load(x + 4 * std::size_t(node[e])) - here;
            for (std::size_t c = 0; c < 3; ++c)
                even[c] = multiply_add(a, d[4 * e + c], even[c]);
        }
        for (std::size_t c = 0; c < 3; ++c)
            (even[c] + odd[c]).store(gradient + 12 * i + 4 * c);
    }
}

void scatter_stresses(const NeighbourLists& lists, const double* stress, double* force)
{
    const std::uint32_t* node = lists.node.data();
    const double* d = lists.d.data();
    for (std::size_t i = 0; i + 1 < lists.row.size(); ++i) {
        const Quad s[3] = {Quad::load(stress + 12 * i), Quad::load(stress + 12 * i + 4), Quad::load(stress + 12 * i + 8)};
        Quad sum = Quad::zero();
        for (std::size_t e = lists.row[i]; e < lists.row[i + 1]; ++e) {
            const Quad t = multiply_add(s[2], d[4 * e + 2], multiply_add(s[1], d[4 * e + 1], times(s[0], d[4 * e])));
            double* other = force + 4 * std::size_t(node[e]);
            (Quad::load(other) + t).store(other);
            sum = sum + t;
        }
        (Quad::load(force + 4 * i) - sum).store(force + 4 * i);
    }
}

double scatter_residuals(const NeighbourLists& offsets, const double* x, const double* gradient, double* force)
{
    const std::uint32_t* node = offsets.node.data();
    const double* d = offsets.d.data();
    Quad energy = Quad::zero();
    for (std::size_t i = 0; i + 1 < offsets.row.size(); ++i) {
        const Quad here = Quad::load(x + 4 * i);
        const Quad g[3] = {Quad::load(gradient + 12 * i), Quad::load(gradient + 12 * i + 4), Quad::load(gradient + 12 * i + 8)};
        Quad sum = Quad::zero();
        for (std::size_t e = offsets.row[i]; e < offsets.row[i + 1]; ++e) {
            const Quad linear = multiply_add(g[2], d[4 * e + 2], multiply_add(g[1], d[4 * e + 1], times(g[0], d[4 * e])));
            double* other = force + 4 * std::size_t(node[e]);
            const Quad r = (Quad::load(x + 4 * std::size_t(node[e])) - here) - linear;
            const Quad t = times(r, d[4 * e + 3]);
            (Quad::load(other) - t).store(other);
            sum = sum + t;
            energy = energy + r * t;
        }
        (Quad::load(force + 4 * i) + sum).store(force + 4 * i);
    }
    double parts[4];
    energy.store(parts);
    return 0.5 * ((parts[0] + parts[1]) + parts[2]);
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cinch {
HWY_EXPORT(gather_gradients);
HWY_EXPORT(scatter_stresses);
HWY_EXPORT(scatter_residuals);

void gather_gradients(const NeighbourLists& lists, const Field& x, MatrixField& gradient) noexcept
{
    HWY_DYNAMIC_DISPATCH(gather_gradients)(lists, x.data(), gradient.data());
}
void scatter_stresses(const NeighbourLists& lists, const MatrixField& stress, Field& force) noexcept
{
    HWY_DYNAMIC_DISPATCH(scatter_stresses)(lists, stress.data(), force.data());
}
double scatter_residuals(const NeighbourLists& offsets, const Field& x, const MatrixField& gradient, Field& force) noexcept
{
    return HWY_DYNAMIC_DISPATCH(scatter_residuals)(offsets, x.data(), gradient.data(), force.data());
}

} // namespace cinch
#endif
