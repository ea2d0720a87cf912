// SPDX-License-Identifier: Apache-2.0
// No #pragma once: compiled anew for every target.
#if defined(CINCH_QUAD_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CINCH_QUAD_INL
#undef CINCH_QUAD_INL
#else
#define CINCH_QUAD_INL
#endif

#include <cstddef>
#include <cstdint>

#include "toolkit/deform/kernel/simd-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

/// 4 doubles (x, y, z and a pad).
using Quad = Simd<double, 4>;

HWY_INLINE Quad times(const Quad& a, double s) { return a * Quad::all(s); }

/// Lane k everywhere. From a register: the loads, not the arithmetic, are what limits these kernels.
template <std::size_t k> HWY_INLINE Quad broadcast(const Quad& a)
{
#if HWY_TARGET == HWY_SCALAR
    return Quad::all(hn::GetLane(a.v[k]));
#else
    Quad q;
    if constexpr (Quad::width == 4) {
        HWY_ALIGN constexpr std::int64_t lanes[4] = {k, k, k, k};
        q.v[0] = hn::TableLookupLanes(a.v[0], hn::SetTableIndices(Quad::D(), lanes));
    } else {
        for (std::size_t i = 0; i < Quad::vectors; ++i)
            q.v[i] = hn::Broadcast<k % Quad::width>(a.v[k / Quad::width]);
    }
    return q;
#endif
}

/// Rows become columns.
HWY_INLINE void transpose(Quad (&q)[4])
{
#if HWY_TARGET != HWY_SCALAR
    if constexpr (Quad::width == 4) {
        const Quad::D d;
        const auto a = hn::InterleaveLower(d, q[0].v[0], q[1].v[0]), b = hn::InterleaveUpper(d, q[0].v[0], q[1].v[0]);
        const auto e = hn::InterleaveLower(d, q[2].v[0], q[3].v[0]), f = hn::InterleaveUpper(d, q[2].v[0], q[3].v[0]);
        q[0].v[0] = hn::ConcatLowerLower(d, e, a);
        q[1].v[0] = hn::ConcatLowerLower(d, f, b);
        q[2].v[0] = hn::ConcatUpperUpper(d, e, a);
        q[3].v[0] = hn::ConcatUpperUpper(d, f, b);
        return;
    }
#endif
    double rows[4][4];
    for (std::size_t r = 0; r < 4; ++r)
        q[r].store(rows[r]);
    HWY_ALIGN double columns[4][4];
    for (std::size_t r = 0; r < 4; ++r)
        for (std::size_t c = 0; c < 4; ++c)
            columns[c][r] = rows[r][c];
    for (std::size_t r = 0; r < 4; ++r)
        q[r] = Quad::load(columns[r]);
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
