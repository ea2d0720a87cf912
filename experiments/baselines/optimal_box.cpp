// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/baselines/optimal_box.hpp"

#include <limits>

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "experiments/baselines/optimal_box.cpp"
#include <hwy/foreach_target.h>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class T, class Influence> void optimal(const T* column, const T* position, std::span<const std::uint32_t> row,
                                                 const Influence* influence, double* supports)
{
    using D = hn::CappedTag<T, 4>;
    constexpr std::size_t width = hn::MaxLanes(D()), vectors = 4 / width;
    const D d;
    hn::Vec<D> low[vectors], high[vectors];
    for (std::size_t i = 0; i < vectors; ++i) {
        low[i] = hn::Set(d, std::numeric_limits<T>::infinity());
        high[i] = hn::Set(d, -std::numeric_limits<T>::infinity());
    }
    for (std::size_t k = 0; k + 1 < row.size(); ++k) {
        const auto x = hn::Set(d, position[3 * k]), y = hn::Set(d, position[3 * k + 1]),
                   z = hn::Set(d, position[3 * k + 2]);
        hn::Vec<D> v[vectors];
        for (std::size_t i = 0; i < vectors; ++i)
            v[i] = hn::Zero(d);
        for (std::size_t e = row[k]; e < row[k + 1]; ++e) {
            const T* m = column + 16 * influence[e].node;
            const auto w = hn::Set(d, influence[e].weight);
            for (std::size_t i = 0; i < vectors; ++i) {
                const T* c = m + i * width;
                const auto image = hn::MulAdd(
                    hn::Load(d, c), x,
                    hn::MulAdd(hn::Load(d, c + 4), y, hn::MulAdd(hn::Load(d, c + 8), z, hn::Load(d, c + 12))));
                v[i] = hn::MulAdd(w, image, v[i]);
            }
        }
        for (std::size_t i = 0; i < vectors; ++i) {
            low[i] = hn::Min(low[i], v[i]);
            high[i] = hn::Max(high[i], v[i]);
        }
    }
    T least[4], most[4];
    for (std::size_t i = 0; i < vectors; ++i) {
        hn::StoreU(low[i], d, least + i * width);
        hn::StoreU(high[i], d, most + i * width);
    }
    for (std::size_t r = 0; r < 3; ++r) {
        supports[2 * r] = static_cast<double>(most[r]);
        supports[2 * r + 1] = -static_cast<double>(least[r]);
    }
}

struct FloatInfluence {
    std::uint32_t node;
    float weight;
};
struct DoubleInfluence {
    std::uint32_t node;
    double weight;
};
void optimal_float(const float* column, const float* position, std::span<const std::uint32_t> row,
                   const void* influence, double* supports)
{
    optimal(column, position, row, static_cast<const FloatInfluence*>(influence), supports);
}
void optimal_double(const double* column, const double* position, std::span<const std::uint32_t> row,
                    const void* influence, double* supports)
{
    optimal(column, position, row, static_cast<const DoubleInfluence*>(influence), supports);
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cinch {

HWY_EXPORT(optimal_float);
HWY_EXPORT(optimal_double);

template <class T> OptimalBox<T>::OptimalBox(const DeformableSurface& surface, std::span<const AffineMap> maps)
    : row_(surface.weights.row)
{
    column_.resize(maps.size() * 16);
    for (std::size_t j = 0; j < maps.size(); ++j)
        for (std::size_t s = 0; s < 4; ++s)
            for (std::size_t r = 0; r < 3; ++r)
                column_[16 * j + 4 * s + r] = static_cast<T>(maps[j].m[r][s]);
    for (const Vec3& x : surface.mesh.vertices)
        for (int s = 0; s < 3; ++s)
            position_.push_back(static_cast<T>(x[s]));
    for (std::size_t e = 0; e < surface.weights.node.size(); ++e)
        influence_.push_back({surface.weights.node[e], static_cast<T>(surface.weights.weight[e])});
}

template <> void OptimalBox<float>::bound(std::span<double> supports) const
{
    HWY_DYNAMIC_DISPATCH(optimal_float)(column_.data(), position_.data(), row_, influence_.data(), supports.data());
}
template <> void OptimalBox<double>::bound(std::span<double> supports) const
{
    HWY_DYNAMIC_DISPATCH(optimal_double)(column_.data(), position_.data(), row_, influence_.data(), supports.data());
}

template class OptimalBox<float>;
template class OptimalBox<double>;

} // namespace cinch
#endif
