// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/kernel/neighbour_kernel.hpp"

#include "toolkit/deform/kernel/disabled_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "toolkit/simulate/kernel/neighbour_kernel.cpp"
#include <hwy/foreach_target.h>

#include "toolkit/deform/kernel/quad-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

struct Columns {
    Quad column[3];

    static HWY_INLINE Columns load(const double* p) { return {{Quad::load(p), Quad::load(p + 4), Quad::load(p + 8)}}; }
    static HWY_INLINE Columns zero() { return {{Quad::all(0), Quad::all(0), Quad::all(0)}}; }
    HWY_INLINE void add_outer(const Quad& a, const Quad& b) // a bᵀ
    {
        column[0] = fma(a, broadcast<0>(b), column[0]);
        column[1] = fma(a, broadcast<1>(b), column[1]);
        column[2] = fma(a, broadcast<2>(b), column[2]);
    }
    HWY_INLINE Quad times(const Quad& b) const
    {
        return fma(column[2], broadcast<2>(b), fma(column[1], broadcast<1>(b), column[0] * broadcast<0>(b)));
    }
};

// Two neighbours at a time, each with sums of its own, hide the latency of the multiply-adds.
void gather_gradients(const NeighbourLists& lists, const double* x, double* gradient)
{
    const std::uint32_t* node = lists.node.data();
    const double* d = lists.record.data();
    for (std::size_t i = 0; i + 1 < lists.row.size(); ++i) {
        const Quad here = Quad::load(x + 4 * i);
        Columns even = Columns::zero(), odd = even;
        std::size_t e = lists.row[i];
        const std::size_t last = lists.row[i + 1];
        for (; e + 1 < last; e += 2) {
            even.add_outer(Quad::load(x + 4 * std::size_t(node[e])) - here, Quad::load(d + 4 * e));
            odd.add_outer(Quad::load(x + 4 * std::size_t(node[e + 1])) - here, Quad::load(d + 4 * e + 4));
        }
        if (e < last)
            even.add_outer(Quad::load(x + 4 * std::size_t(node[e])) - here, Quad::load(d + 4 * e));
        for (std::size_t c = 0; c < 3; ++c)
            (even.column[c] + odd.column[c]).store(gradient + 12 * i + 4 * c);
    }
}

template <bool kSprings>
void scatter(const NeighbourLists& lists, const double* stress, const double* spring, const double* x, double* force)
{
    const std::uint32_t* node = lists.node.data();
    const double* d = lists.record.data();
    for (std::size_t i = 0; i + 1 < lists.row.size(); ++i) {
        const Columns s = Columns::load(stress + 12 * i);
        const Quad here = Quad::load(x + 4 * i), k = Quad::all(kSprings ? spring[i] : 0);
        Quad sum = Quad::all(0);
        for (std::size_t e = lists.row[i]; e < lists.row[i + 1]; ++e) {
            const std::size_t j = 4 * std::size_t(node[e]);
            const Quad record = Quad::load(d + 4 * e);
            Quad t = s.times(record);
            if constexpr (kSprings) // towards i
                t = fma(k, broadcast<3>(record) * (here - Quad::load(x + j)), t);
            (Quad::load(force + j) + t).store(force + j);
            sum = sum + t;
        }
        (Quad::load(force + 4 * i) - sum).store(force + 4 * i);
    }
}

void scatter_stresses(const NeighbourLists& lists, const double* stress, const double* spring, const double* x,
                      double* force)
{
    spring ? scatter<true>(lists, stress, spring, x, force) : scatter<false>(lists, stress, spring, x, force);
}

double residual_energy(const NeighbourLists& lists, const double* offset, const double* spring, const double* x,
                       const double* gradient)
{
    const std::uint32_t* node = lists.node.data();
    Quad energy = Quad::all(0);
    for (std::size_t i = 0; i + 1 < lists.row.size(); ++i) {
        const Quad here = Quad::load(x + 4 * i);
        const Columns g = Columns::load(gradient + 12 * i);
        Quad sum = Quad::all(0);
        for (std::size_t e = lists.row[i]; e < lists.row[i + 1]; ++e) {
            const Quad r = (Quad::load(x + 4 * std::size_t(node[e])) - here) - g.times(Quad::load(offset + 4 * e));
            sum = fma(r * r, Quad::all(lists.record[4 * e + 3]), sum);
        }
        energy = fma(sum, Quad::all(spring[i]), energy);
    }
    double parts[4];
    energy.store(parts);
    return 0.5 * ((parts[0] + parts[1]) + parts[2]);
}

void add_matrix_products(const double* a, const double* b, std::size_t count, double* out)
{
    for (std::size_t i = 0; i < count; ++i) {
        const Columns left = Columns::load(a + 12 * i);
        for (std::size_t c = 0; c < 3; ++c) {
            double* column = out + 12 * i + 4 * c;
            (Quad::load(column) + left.times(Quad::load(b + 12 * i + 4 * c))).store(column);
        }
    }
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cinch {
HWY_EXPORT(gather_gradients);
HWY_EXPORT(scatter_stresses);
HWY_EXPORT(residual_energy);
HWY_EXPORT(add_matrix_products);

void gather_gradients(const NeighbourLists& lists, const Field& x, MatrixField& gradient) noexcept
{
    HWY_DYNAMIC_DISPATCH(gather_gradients)(lists, x.data(), gradient.data());
}
void scatter_stresses(const NeighbourLists& lists, const MatrixField& stress, std::span<const double> spring,
                      const Field& x, Field& force) noexcept
{
    HWY_DYNAMIC_DISPATCH(scatter_stresses)
    (lists, stress.data(), spring.empty() ? nullptr : spring.data(), x.data(), force.data());
}
double residual_energy(const NeighbourLists& lists, std::span<const double> offset, std::span<const double> spring,
                       const Field& x, const MatrixField& gradient) noexcept
{
    return HWY_DYNAMIC_DISPATCH(residual_energy)(lists, offset.data(), spring.data(), x.data(), gradient.data());
}

void add_matrix_products(const MatrixField& a, const MatrixField& b, MatrixField& out) noexcept
{
    HWY_DYNAMIC_DISPATCH(add_matrix_products)(a.data(), b.data(), a.size() / 12, out.data());
}

} // namespace cinch
#endif
