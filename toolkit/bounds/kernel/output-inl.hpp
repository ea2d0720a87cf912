// SPDX-License-Identifier: Apache-2.0
// No #pragma once: compiled anew for every target.
// From a bound to the supports that a caller wants.
#if defined(CINCH_OUTPUT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CINCH_OUTPUT_INL
#undef CINCH_OUTPUT_INL
#else
#define CINCH_OUTPUT_INL
#endif

#include <algorithm>

#include "cinch/bounds.hpp"
#include "toolkit/bounds/kernel/rows-inl.hpp"
#include "toolkit/bounds/kernel/search-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

/// Supports about the body's origin, with the errors of the BV's nodes on top.
template <class T, std::size_t kAxes>
void finish(const KernelInput<T>& in, const PackedBv<T>& bv, const Bound<T, kAxes>& bound, double (&own)[2][kAxes])
{
    const double wider = widening<T, kAxes>(in, bv, bound);
    for (std::size_t s = 0; s < 2; ++s)
        for (std::size_t a = 0; a < kAxes; ++a) {
            const double sum = static_cast<double>(bound.value[s][a]) + wider,
                         support = in.rounding == Rounding::proven ? succ(sum) : sum;
            own[s][a] = support < infinite ? support : infinite;
        }
}

/// And in the world.
template <class T, std::size_t kAxes>
void to_world(const KernelInput<T>& in, const double (&own)[2][kAxes], double* supports)
{
    const bool proven = in.rounding == Rounding::proven;
    const Vec3& origin = in.maps->origin;
    const bool at_home = origin[0] == 0 && origin[1] == 0 && origin[2] == 0;
    const auto axes = axes_of(in.maps->kdop);
    for (std::size_t a = 0; a < kAxes; ++a)
        for (std::size_t s = 0; s < 2; ++s) {
            double sum = own[s][a];
            for (std::size_t r = 0; r < 3 && !at_home; ++r)
                if (axes[a][r] != 0) {
                    sum += ((axes[a][r] > 0) == (s == 0) ? 1 : -1) * origin[static_cast<int>(r)];
                    sum = proven ? succ(sum) : sum;
                }
            supports[2 * a + s] = sum < infinite ? sum : infinite;
        }
}

/// The same about the origin, as floats.
template <class T, std::size_t kAxes>
void finish(const KernelInput<T>& in, const PackedBv<T>& bv, const Bound<T, kAxes>& bound, std::size_t side, float* dop)
{
    const double wider = widening<T, kAxes>(in, bv, bound);
    if constexpr (sizeof(T) == 4) {
        const float by = succ(static_cast<float>(wider)); // fl(x) ≥ x(1 − u), and succ goes past x
        for (std::size_t s = 0; s < 2; ++s)
            for (std::size_t c = 0; c < row_chunks<kAxes>; ++c) {
                const auto sum = next(Rows<float>::load(bound.value[s] + 4 * c) + Rows<float>::all(by));
                HWY_ALIGN float own[16];
                lesser(sum, Rows<float>::all(infinity_of<float>)).store(own);
                for (std::size_t a = 4 * c; a < std::min(4 * c + 4, kAxes); ++a)
                    dop[s * side + a] = own[a % 4];
            }
    } else {
        for (std::size_t a = 0; a < kAxes; ++a)
            for (std::size_t s = 0; s < 2; ++s) {
                const float support = succ(static_cast<float>(succ(static_cast<double>(bound.value[s][a]) + wider)));
                dop[s * side + a] = support < infinity_of<float> ? support : infinity_of<float>;
            }
    }
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
