// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bake/baked_clip.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "experiments/report/interrupt.hpp"
#include "toolkit/hierarchy/box_radius.hpp"

namespace cinch {
namespace {

double radius_of(std::span<const double> supports, std::size_t bv, int kdop)
{
    return box_radius(supports.subspan(bv * static_cast<std::size_t>(kdop), 6));
}

void take(std::vector<double>& to, std::span<const double> from)
{
    for (std::size_t i = 0; i < to.size(); ++i)
        to[i] = std::max(to[i], from[i]);
}

// Times between two keys, both included.
template <class F> void each_time(const TimedMotion& motion, int samples, double a, double b, F&& use)
{
    std::vector<double> cuts{a};
    for (const double key : motion.keys)
        if (key > a && key < b)
            cuts.push_back(key);
    cuts.push_back(b);
    for (std::size_t i = 1; i < cuts.size(); ++i)
        for (int s = i == 1 ? 0 : 1; s <= samples; ++s)
            use(s == samples ? cuts[i] : cuts[i - 1] + (cuts[i] - cuts[i - 1]) * s / samples);
}

// What the vertices of every BV reach at a time, but for rounding.
class Truth {
public:
    Truth(const DeformableSurface& surface, const Bvh& bvh, std::span<const MorphTarget> targets, int kdop)
        : surface_(surface), bvh_(bvh), targets_(targets), axes_(axes_of(kdop)), place_(surface.mesh.vertices.size())
    {
        for (const MorphTarget& target : targets)
            for (std::size_t n = 0; n < target.half.size(); ++n)
                half_[target.vertex[n]] = target.half[n]; // of with_any_weights, which makes one of all targets
    }

    void operator()(const TimedMotion& motion, double t, std::vector<double>& supports)
    {
        std::vector<Vec3> rest = surface_.mesh.vertices;
        if (motion.weights)
            displace(targets_, motion.weights(t), rest);
        const std::vector<AffineMap> maps = motion.at(t);
        evaluate(rest, surface_.weights, maps, place_);
        const std::size_t k = 2 * axes_.size();
        std::fill(supports.begin(), supports.end(), -std::numeric_limits<double>::infinity());
        for (std::size_t i = bvh_.bvs.size(); i-- > 0;) {
            const Bv& bv = bvh_.bvs[i];
            double* out = supports.data() + i * k;
            if (!bv.is_leaf()) {
                for (std::size_t d = 0; d < k; ++d)
                    out[d] = std::max(supports[bv.first_child * k + d], supports[(bv.first_child + 1) * k + d]);
                continue;
            }
            for (std::uint32_t t0 = bv.first_triangle; t0 < bv.first_triangle + bv.triangle_count; ++t0)
                for (const std::uint32_t v : surface_.mesh.triangles[bvh_.triangle[t0]])
                    for (std::size_t a = 0; a < axes_.size(); ++a) {
                        const auto& g = axes_[a];
                        const Vec3& x = place_[v];
                        const double along = g[0] * x[0] + g[1] * x[1] + g[2] * x[2], more = around(v, g, maps);
                        out[2 * a] = std::max(out[2 * a], along + more);
                        out[2 * a + 1] = std::max(out[2 * a + 1], more - along);
                    }
        }
    }

private:
    // How far a vertex's displacement, which may be anywhere in a box, takes it along an axis: |Σ w_j A_jᵀγ|·half.
    double around(std::uint32_t v, const Axis& g, std::span<const AffineMap> maps) const
    {
        const auto half = half_.find(v);
        if (half == half_.end())
            return 0;
        double sum = 0;
        const Weights::Row row = surface_.weights.of(v);
        for (int c = 0; c < 3; ++c) {
            double along = 0;
            for (std::size_t i = 0; i < row.node.size(); ++i)
                for (std::size_t r = 0; r < 3; ++r)
                    along += row.weight[i] * g[r] * maps[row.node[i]].m[r][c];
            sum += std::abs(along) * half->second[c];
        }
        return sum;
    }

    const DeformableSurface& surface_;
    const Bvh& bvh_;
    std::span<const MorphTarget> targets_;
    std::map<std::uint32_t, Vec3> half_;
    std::span<const Axis> axes_;
    std::vector<Vec3> place_;
};

} // namespace

std::vector<BakedInterval> bake_clip(IntervalRefitter& refit, const TimedMotion& motion, const BakeOptions& options,
                                     std::size_t supports)
{
    const ClipCuts cuts{options.whole, options.interval_s, options.tolerance};
    return bake_clip(refit, motion, cuts, supports / refit.kdop(), [](double) { throw_if_interrupted(); });
}

BakedFigures figures_of(const DeformableSurface& surface, const Bvh& bvh, std::span<const MorphTarget> targets,
                        IntervalRefitter& refit, const TimedMotion& motion, const BakeOptions& options,
                        const std::vector<BakedInterval>& baked)
{
    const int kdop = options.bounds.kdop;
    const std::size_t count = bvh.bvs.size() * static_cast<std::size_t>(kdop);
    const double least = -std::numeric_limits<double>::infinity();
    BakedFigures out;
    out.key_segments = motion.keys.size() - 1;
    out.length_s = motion.last_s() - motion.first_s();
    Truth vertices(surface, bvh, targets, kdop);
    std::vector<double> now(count), truth(count, least), all(count, least), at_keys(count, least), at_30(count, least);
    double sum = 0, number = 0;
    for (const BakedInterval& interval : baked) {
        throw_if_interrupted();
        std::vector<double> hull(count, least);
        each_time(motion, options.samples, interval.first_s, interval.last_s, [&](double t) {
            take(hull, refit.at(refit.all(), motion.at(t), motion.weights ? motion.weights(t) : std::vector<double>())
                           .supports);
            vertices(motion, t, now);
            take(truth, now);
            for (std::size_t d = 0; d < 6; ++d)
                out.missed_by_us = std::max(out.missed_by_us, now[d] - interval.supports[d]);
        });
        for (std::size_t bv = 0; bv < bvh.bvs.size(); ++bv) {
            const double ratio = radius_of(interval.supports, bv, kdop) / radius_of(hull, bv, kdop);
            out.time_max = std::max(out.time_max, ratio);
            sum += ratio;
            ++number;
        }
        take(all, interval.supports);
        out.intervals += interval.intervals;
    }
    out.time_mean = sum / number;
    auto sampled = [&](std::vector<double>& to, double t) {
        vertices(motion, t, now);
        take(to, now);
    };
    for (const double key : motion.keys)
        sampled(at_keys, key);
    const double length = motion.last_s() - motion.first_s();
    const int frames = static_cast<int>(std::round(length * 30));
    for (int i = 0; i <= frames; ++i)
        sampled(at_30, frames ? motion.first_s() + length * i / frames : motion.first_s());
    const double half_diagonal = radius_of(truth, 0, kdop);
    for (std::size_t d = 0; d < 6; ++d) {
        out.missed_keys = std::max(out.missed_keys, (truth[d] - at_keys[d]) / half_diagonal);
        out.missed_30fps = std::max(out.missed_30fps, (truth[d] - at_30[d]) / half_diagonal);
    }
    out.missed_by_us = std::max(0.0, out.missed_by_us / half_diagonal);
    out.root = radius_of(all, 0, kdop) / half_diagonal;
    double leaves = 0, leaf_count = 0;
    for (std::size_t bv = 0; bv < bvh.bvs.size(); ++bv)
        if (bvh.bvs[bv].is_leaf()) {
            leaves += radius_of(all, bv, kdop) / radius_of(truth, bv, kdop);
            ++leaf_count;
        }
    out.leaves = leaves / leaf_count;
    return out;
}

std::size_t bvs_down_to(const Bvh& bvh, int level)
{
    const std::size_t levels = bvh.level.size() - 1;
    return level < 0 ? bvh.bvs.size() : bvh.level[std::min<std::size_t>(static_cast<std::size_t>(level) + 1, levels)];
}

std::size_t level_of(std::span<const std::uint32_t> levels, std::size_t bv)
{
    return static_cast<std::size_t>(std::upper_bound(levels.begin(), levels.end(), bv) - levels.begin()) - 1;
}

} // namespace cinch
