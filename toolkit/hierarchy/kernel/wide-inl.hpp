// SPDX-License-Identifier: Apache-2.0
// No #pragma once: compiled anew for every target.
#if defined(CINCH_WIDE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CINCH_WIDE_INL
#undef CINCH_WIDE_INL
#else
#define CINCH_WIDE_INL
#endif

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <hwy/highway.h>

#include "toolkit/bounds/rounding.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// L floats, one per vertex or triangle of a leaf, as however many vectors the target needs. The same lane by lane
/// everywhere.
template <std::size_t L> struct Wide {
    using D = hn::CappedTag<float, L>;
    using V = hn::Vec<D>;
    static constexpr std::size_t width = hn::MaxLanes(D()), vectors = L / width;

    V v[vectors];

    static HWY_INLINE Wide load(const float* p) // aligned
    {
        Wide x;
        for (std::size_t i = 0; i < vectors; ++i)
            x.v[i] = hn::Load(D(), p + i * width);
        return x;
    }
    static HWY_INLINE Wide load_unaligned(const float* p)
    {
        Wide x;
        for (std::size_t i = 0; i < vectors; ++i)
            x.v[i] = hn::LoadU(D(), p + i * width);
        return x;
    }
    static HWY_INLINE Wide all(float value)
    {
        Wide x;
        for (std::size_t i = 0; i < vectors; ++i)
            x.v[i] = hn::Set(D(), value);
        return x;
    }
    /// The same four values over and over.
    static HWY_INLINE Wide fours(const float* p)
    {
        Wide x;
        for (std::size_t i = 0; i < vectors; ++i) {
            if constexpr (width == 1)
                x.v[i] = hn::Set(D(), p[i % 4]);
            else
                x.v[i] = hn::LoadDup128(D(), p);
        }
        return x;
    }
    HWY_INLINE void store(float* p) const // aligned
    {
        for (std::size_t i = 0; i < vectors; ++i)
            hn::Store(v[i], D(), p + i * width);
    }
};

template <std::size_t L, class F> HWY_INLINE Wide<L> each(const Wide<L>& a, F&& f)
{
    Wide<L> x;
    for (std::size_t i = 0; i < Wide<L>::vectors; ++i)
        x.v[i] = f(a.v[i]);
    return x;
}
template <std::size_t L, class F> HWY_INLINE Wide<L> each(const Wide<L>& a, const Wide<L>& b, F&& f)
{
    Wide<L> x;
    for (std::size_t i = 0; i < Wide<L>::vectors; ++i)
        x.v[i] = f(a.v[i], b.v[i]);
    return x;
}
template <std::size_t L> HWY_INLINE Wide<L> operator+(const Wide<L>& a, const Wide<L>& b)
{
    return each(a, b, [](auto x, auto y) { return hn::Add(x, y); });
}
template <std::size_t L> HWY_INLINE Wide<L> operator-(const Wide<L>& a, const Wide<L>& b)
{
    return each(a, b, [](auto x, auto y) { return hn::Sub(x, y); });
}
template <std::size_t L> HWY_INLINE Wide<L> operator*(const Wide<L>& a, const Wide<L>& b)
{
    return each(a, b, [](auto x, auto y) { return hn::Mul(x, y); });
}
template <std::size_t L> HWY_INLINE Wide<L> magnitude(const Wide<L>& a)
{
    return each(a, [](auto x) { return hn::Abs(x); });
}
template <std::size_t L> HWY_INLINE Wide<L> root(const Wide<L>& a)
{
    return each(a, [](auto x) { return hn::Sqrt(x); });
}
template <std::size_t L> HWY_INLINE Wide<L> greater(const Wide<L>& a, const Wide<L>& b)
{
    return each(a, b, [](auto x, auto y) { return hn::Max(x, y); });
}
template <std::size_t L> HWY_INLINE Wide<L> less(const Wide<L>& a, const Wide<L>& b)
{
    return each(a, b, [](auto x, auto y) { return hn::Min(x, y); });
}

/// a·b + c, rounded once: part of the definition of every result.
template <std::size_t L> HWY_INLINE Wide<L> fma(const Wide<L>& a, const Wide<L>& b, const Wide<L>& c)
{
    Wide<L> x;
    for (std::size_t i = 0; i < Wide<L>::vectors; ++i)
#if HWY_NATIVE_FMA
        x.v[i] = hn::MulAdd(a.v[i], b.v[i], c.v[i]);
#else // the emulation would round twice
        x.v[i] =
            hn::Set(typename Wide<L>::D(), std::fma(hn::GetLane(a.v[i]), hn::GetLane(b.v[i]), hn::GetLane(c.v[i])));
    static_assert(Wide<L>::width == 1);
#endif
    return x;
}
/// a·b − c, rounded once.
template <std::size_t L> HWY_INLINE Wide<L> fms(const Wide<L>& a, const Wide<L>& b, const Wide<L>& c)
{
    Wide<L> x;
    for (std::size_t i = 0; i < Wide<L>::vectors; ++i)
#if HWY_NATIVE_FMA
        x.v[i] = hn::MulSub(a.v[i], b.v[i], c.v[i]);
#else
        x.v[i] =
            hn::Set(typename Wide<L>::D(), std::fma(hn::GetLane(a.v[i]), hn::GetLane(b.v[i]), -hn::GetLane(c.v[i])));
#endif
    return x;
}

/// One bit per lane, as the target keeps them.
template <std::size_t L> struct Lanes {
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
template <std::size_t L> HWY_INLINE Lanes<L> operator>(const Wide<L>& a, const Wide<L>& b)
{
    Lanes<L> x;
    for (std::size_t i = 0; i < Wide<L>::vectors; ++i)
        x.v[i] = hn::Gt(a.v[i], b.v[i]);
    return x;
}
template <std::size_t L> HWY_INLINE Lanes<L> operator|(const Lanes<L>& a, const Lanes<L>& b)
{
    Lanes<L> x;
    for (std::size_t i = 0; i < Wide<L>::vectors; ++i)
        x.v[i] = hn::Or(a.v[i], b.v[i]);
    return x;
}
/// Bit i: whether a > b in lane i; false for NaN.
template <std::size_t L> HWY_INLINE std::uint32_t bits_where_greater(const Wide<L>& a, const Wide<L>& b)
{
    return (a > b).bits();
}

/// succ of rounding.hpp.
template <std::size_t L> HWY_INLINE Wide<L> next(const Wide<L>& x)
{
    constexpr float phi = unit_roundoff_of<float> * (1 + 2 * unit_roundoff_of<float>);
    return x + (magnitude(x) * Wide<L>::all(phi) + Wide<L>::all(smallest_subnormal_of<float>));
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
