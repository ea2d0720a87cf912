// SPDX-License-Identifier: Apache-2.0
// No #pragma once: compiled anew for every target.
#if defined(CINCH_WIDE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CINCH_WIDE_INL
#undef CINCH_WIDE_INL
#else
#define CINCH_WIDE_INL
#endif

#include <bit>
#include <cstddef>
#include <cstdint>

#include <hwy/highway.h>

#include "toolkit/bounds/kernel/next-inl.hpp"
#include "toolkit/deform/kernel/simd-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

/// L floats, one per vertex or triangle of a leaf.
template <std::size_t L> using Wide = Simd<float, L>;

/// One bit per lane, as the target keeps them.
template <std::size_t L> struct Mask {
    using D = typename Wide<L>::D;

    hn::Mask<D> v[Wide<L>::vectors];

    HWY_INLINE std::uint32_t bits() const ///< bit i: of lane i
    {
        std::uint32_t bits = 0;
        for (std::size_t i = 0; i < Wide<L>::vectors; ++i) {
            if constexpr (Wide<L>::width == 1) {
                bits |= static_cast<std::uint32_t>(!hn::AllFalse(D(), v[i])) << i;
            } else {
                std::uint8_t bytes[8] = {};
                hn::StoreMaskBits(D(), v[i], bytes);
                bits |= (std::uint32_t{bytes[0]} | std::uint32_t{bytes[1]} << 8) << (i * Wide<L>::width);
            }
        }
        return bits;
    }
};
/// Whether a > b; false for NaN.
template <std::size_t L> HWY_INLINE Mask<L> operator>(const Wide<L>& a, const Wide<L>& b)
{
    Mask<L> x;
    for (std::size_t i = 0; i < Wide<L>::vectors; ++i)
        x.v[i] = hn::Gt(a.v[i], b.v[i]);
    return x;
}
template <std::size_t L> HWY_INLINE Mask<L> operator|(const Mask<L>& a, const Mask<L>& b)
{
    Mask<L> x;
    for (std::size_t i = 0; i < Wide<L>::vectors; ++i)
        x.v[i] = hn::Or(a.v[i], b.v[i]);
    return x;
}
/// Bit i: whether a > b in lane i; false for NaN.
template <std::size_t L> HWY_INLINE std::uint32_t bits_where_greater(const Wide<L>& a, const Wide<L>& b)
{
    return (a > b).bits();
}

/// a where the lane's bit is set, else b.
template <std::size_t L> HWY_INLINE Wide<L> select(std::uint32_t bits, const Wide<L>& a, const Wide<L>& b)
{
    Wide<L> x;
    for (std::size_t i = 0; i < Wide<L>::vectors; ++i) {
        if constexpr (Wide<L>::width == 1) {
            x.v[i] = bits >> i & 1 ? a.v[i] : b.v[i];
        } else {
            const std::uint32_t own = bits >> (i * Wide<L>::width);
            const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(own), static_cast<std::uint8_t>(own >> 8)};
            x.v[i] = hn::IfThenElse(hn::LoadMaskBits(typename Wide<L>::D(), bytes), a.v[i], b.v[i]);
        }
    }
    return x;
}

/// Lane n is that of table at index[n].
template <std::size_t L> HWY_INLINE Wide<L> lookup(const Wide<L>& table, const std::uint8_t* index)
{
#if HWY_TARGET != HWY_SCALAR
    if constexpr (Wide<L>::vectors == 1 && L == 16) {
        using D = typename Wide<L>::D;
        const hn::RebindToSigned<D> di;
        const hn::Rebind<std::uint8_t, D> d8;
        return {{hn::TableLookupLanes(table.v[0], hn::IndicesFromVec(D(), hn::PromoteTo(di, hn::LoadU(d8, index))))}};
    } else if constexpr (Wide<L>::width == 8) { // L = 8 or 16
        using D = typename Wide<L>::D;
        const hn::RebindToSigned<D> di;
        const hn::Rebind<std::uint8_t, D> d8;
        Wide<L> out;
        for (std::size_t i = 0; i < Wide<L>::vectors; ++i) {
            const auto place = hn::PromoteTo(di, hn::LoadU(d8, index + 8 * i));
            const auto low = hn::IndicesFromVec(D(), hn::And(place, hn::Set(di, 7)));
            out.v[i] = hn::TableLookupLanes(table.v[0], low);
            if constexpr (L == 16)
                out.v[i] = hn::IfThenElse(hn::RebindMask(D(), hn::Gt(place, hn::Set(di, 7))),
                                          hn::TableLookupLanes(table.v[1], low), out.v[i]);
        }
        return out;
    }
#endif
    HWY_ALIGN float in[L], out[L];
    table.store(in);
    for (std::size_t n = 0; n < L; ++n)
        out[n] = in[index[n]];
    return Wide<L>::load(out);
}

/// out[n] = table[index[n]], of L bytes each.
template <std::size_t L>
HWY_INLINE void lookup_bytes(const std::uint8_t* table, const std::uint8_t* index, std::uint8_t* out)
{
#if HWY_TARGET != HWY_SCALAR
    const hn::FixedTag<std::uint8_t, L> d;
    hn::StoreU(hn::TableLookupBytes(hn::LoadU(d, table), hn::LoadU(d, index)), d, out);
#else
    for (std::size_t n = 0; n < L; ++n)
        out[n] = table[index[n]];
#endif
}

/// The places of the bits that are set, in order, to `out`; up to L bytes more are overwritten. Without branches where
/// lanes can be compressed.
template <std::size_t L> HWY_INLINE void list_bits(std::uint32_t bits, std::uint8_t* out)
{
#if HWY_TARGET != HWY_SCALAR
    if constexpr (Wide<L>::vectors == 1 && L == 16) {
        const hn::RebindToSigned<typename Wide<L>::D> d;
        const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 8)};
        const auto places = hn::Compress(hn::Iota(d, 0), hn::LoadMaskBits(d, bytes));
        return hn::StoreU(hn::DemoteTo(hn::Rebind<std::uint8_t, decltype(d)>(), places),
                          hn::Rebind<std::uint8_t, decltype(d)>(), out);
    }
#endif
    for (; bits != 0; bits &= bits - 1)
        *out++ = static_cast<std::uint8_t>(std::countr_zero(bits));
}

/// Of all lanes; NaN hides.
template <std::size_t L> HWY_INLINE float greatest(const Wide<L>& a)
{
    auto most = a.v[0];
    for (std::size_t i = 1; i < Wide<L>::vectors; ++i)
        most = hn::Max(most, a.v[i]);
    return hn::GetLane(hn::MaxOfLanes(typename Wide<L>::D(), most));
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
