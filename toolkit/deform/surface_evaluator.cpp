// SPDX-License-Identifier: Apache-2.0
#include "cinch/deform.hpp"
#include "cinch/environment.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "toolkit/deform/aligned.hpp"
#include "toolkit/deform/kernel/evaluate_group.hpp"
#include "toolkit/deform/parallel.hpp"
#include "toolkit/surface/triangle_mesh.hpp"

namespace cinch {
namespace {

// Halves by the median of the longest side, at multiples of 8, until each 8 lie together.
void split(const std::vector<Vec3>& rest, std::span<std::uint32_t> order)
{
    if (order.size() <= 8)
        return;
    Vec3 low = rest[order[0]], high = low;
    for (const std::uint32_t k : order) {
        low = low.cwiseMin(rest[k]);
        high = high.cwiseMax(rest[k]);
    }
    Eigen::Index axis;
    (high - low).maxCoeff(&axis);
    const std::size_t half = (order.size() / 2 + 7) / 8 * 8;
    std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(half), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) {
                         return rest[a][axis] != rest[b][axis] ? rest[a][axis] < rest[b][axis] : a < b;
                     });
    split(rest, order.first(half));
    split(rest, order.subspan(half));
}

} // namespace

template <class T> struct SurfaceEvaluator<T>::Parts {
    struct alignas(64) Group {
        T rest[3][8];                       ///< about centre
        std::uint32_t vertex[8];            ///< the last one repeated where there are fewer
        std::uint32_t first = 0, count = 0; ///< in node; weights at 8 times that
    };

    explicit Parts(const DeformableSurface& surface);
    void evaluate(std::span<const AffineMap> maps, std::span<Vec3> out) const;

    const DeformableSurface* surface_;
    Vec3 centre_ = Vec3::Zero(); ///< 0 in double
    AlignedVector<Group> groups_;
    std::vector<std::uint32_t> node_;
    AlignedVector<T> weight_;
};

template <class T> SurfaceEvaluator<T>::SurfaceEvaluator(const DeformableSurface& surface)
    : parts_(std::make_unique<Parts>(surface))
{
}
template <class T> SurfaceEvaluator<T>::~SurfaceEvaluator() = default;
template <class T> SurfaceEvaluator<T>::SurfaceEvaluator(SurfaceEvaluator&&) noexcept = default;
template <class T> SurfaceEvaluator<T>& SurfaceEvaluator<T>::operator=(SurfaceEvaluator&&) noexcept = default;

template <class T> void SurfaceEvaluator<T>::operator()(std::span<const AffineMap> maps, std::span<Vec3> out) const
{
    parts_->evaluate(maps, out);
}

template <class T> SurfaceEvaluator<T>::Parts::Parts(const DeformableSurface& surface) : surface_(&surface)
{
    if constexpr (sizeof(T) == 4)
        centre_ = extent(surface.mesh).centre;
    const std::vector<Vec3>& rest = surface.mesh.vertices;
    std::vector<std::uint32_t> order(rest.size());
    std::iota(order.begin(), order.end(), 0u);
    split(rest, order);

    std::vector<std::uint32_t> nodes;
    for (std::size_t first = 0; first < order.size(); first += 8) {
        Group group;
        nodes.clear();
        for (std::size_t lane = 0; lane < 8; ++lane) {
            const std::uint32_t k = group.vertex[lane] = order[std::min(first + lane, order.size() - 1)];
            for (int r = 0; r < 3; ++r)
                group.rest[r][lane] = static_cast<T>(rest[k][r] - centre_[r]);
            const auto row = surface.weights.of(k).node;
            nodes.insert(nodes.end(), row.begin(), row.end());
        }
        std::sort(nodes.begin(), nodes.end());
        nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
        group.first = static_cast<std::uint32_t>(node_.size());
        group.count = static_cast<std::uint32_t>(nodes.size());
        node_.insert(node_.end(), nodes.begin(), nodes.end());
        weight_.resize(8 * node_.size(), 0);
        for (std::size_t lane = 0; lane < 8; ++lane) {
            const Weights::Row row = surface.weights.of(group.vertex[lane]);
            for (std::size_t e = 0; e < row.node.size(); ++e) {
                const auto place =
                    static_cast<std::size_t>(std::lower_bound(nodes.begin(), nodes.end(), row.node[e]) - nodes.begin());
                weight_[8 * (group.first + place) + lane] = static_cast<T>(row.weight[e]);
            }
        }
        groups_.push_back(group);
    }
}

template <class T> void SurfaceEvaluator<T>::Parts::evaluate(std::span<const AffineMap> maps, std::span<Vec3> out) const
{
    require_default_arithmetic();
    std::vector<std::uint8_t> finite(maps.size());
    Vec3 origin = Vec3::Zero();
    std::size_t count = 0;
    for (std::size_t j = 0; j < maps.size(); ++j) {
        finite[j] = is_finite(maps[j]);
        count += finite[j];
        if (finite[j] && sizeof(T) == 4) // the mean image of the rest centre
            origin += (apply(maps[j], centre_) - origin) / static_cast<double>(count);
    }
    AlignedVector<T> packed(12 * maps.size(), 0);
    for (std::size_t j = 0; j < maps.size(); ++j) {
        const Vec3 t = sizeof(T) == 4 && finite[j] ? Vec3(apply(maps[j], centre_) - origin)
                                                   : Vec3(maps[j].m[0][3], maps[j].m[1][3], maps[j].m[2][3]);
        for (std::size_t r = 0; r < 3; ++r) {
            for (std::size_t c = 0; c < 3; ++c)
                packed[12 * j + 4 * r + c] = static_cast<T>(maps[j].m[r][c]);
            packed[12 * j + 4 * r + 3] = static_cast<T>(t[static_cast<Eigen::Index>(r)]);
        }
    }
    const bool all_finite = count == maps.size();
    parallel_blocks(groups_.size(), 128, [&](std::size_t first, std::size_t last) {
        for (std::size_t g = first; g < last; ++g) {
            const Group& group = groups_[g];
            const std::uint32_t* node = node_.data() + group.first;
            if (!all_finite && !std::all_of(node, node + group.count, [&](std::uint32_t j) { return finite[j]; })) {
                for (const std::uint32_t k : group.vertex) // 0 times infinity is no 0
                    out[k] = evaluate_vertex(surface_->mesh.vertices[k], surface_->weights.of(k), maps);
                continue;
            }
            alignas(64) T place[3][8];
            evaluate_group(group.rest[0], node, weight_.data() + 8 * std::size_t(group.first), group.count,
                           packed.data(), place[0]);
            for (std::size_t lane = 0; lane < 8; ++lane)
                out[group.vertex[lane]] = origin + Vec3(place[0][lane], place[1][lane], place[2][lane]);
        }
    });
}

template class SurfaceEvaluator<double>;
template class SurfaceEvaluator<float>;

} // namespace cinch
