// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <memory>

#include "experiments/cost/cost.hpp"
#include "experiments/report/interrupt.hpp"
#include "toolkit/hierarchy/packed_bvh.hpp"

namespace cinch {
namespace {

template <class T> struct PreparedKernel {
    PackedBvh<T> packed;
    ProjectedMaps<T> maps;
    KernelScratch<T> scratch;
};

template <class T>
void add(const CostSample& sample, int kdop, const ChosenKinds& kinds, Method method, std::vector<CostContestant>& all)
{
    for (const Rounding rounding : {Rounding::plain, Rounding::proven}) {
        const auto prepared = std::make_shared<PreparedKernel<T>>();
        prepared->packed = pack<T>(sample.bvh, sample.surface, kinds);
        project(sample.maps, prepared->packed.rest, kdop, rounding, prepared->maps);
        const bool proven = rounding == Rounding::proven;
        const std::string name = sizeof(T) == 4 ? "float kernel" : "double kernel";
        all.push_back(
            {std::string(name_of(method)), proven ? name + ", proven" : name, proven ? "proven" : "none", proven,
             [prepared, rounding, kdop, bvs = sample.bvs](std::span<double> supports) {
                 const auto k = static_cast<std::size_t>(kdop);
                 const KernelInput<T> input{
                     prepared->packed.bvs, prepared->packed.node, prepared->packed.value, &prepared->maps, rounding, 1};
                 for (std::size_t i = 0; i < bvs.size(); ++i)
                     bound_packed<T>(input, bvs[i], bvs[i] + 1, prepared->scratch, supports.subspan(i * k, k));
             }});
    }
}

} // namespace

std::vector<CostContestant> kernel_contestants(const CostSample& sample, int kdop)
{
    std::vector<CostContestant> all;
    for (const Method method : kernel_methods) {
        throw_if_interrupted();
        const auto kinds = choose_kinds(sample.bvh, sample.surface, method);
        add<float>(sample, kdop, kinds, method, all);
        add<double>(sample, kdop, kinds, method, all);
    }
    return all;
}

std::vector<DualGap> dual_gaps(const Input& input, std::size_t leaf)
{
    constexpr std::size_t limits[] = {1, 9, 17, 33, 65, 129, 257, 1u << 31}; // of n
    constexpr int converged = 64;
    const Bvh bvh = build_bvh(input.surface, leaf);
    std::vector<DualGap> gaps;
    for (const Method method : {Method::local, Method::support, Method::best}) {
        std::vector<DualGap> by_n;
        for (std::size_t i = 0; i + 1 < std::size(limits); ++i)
            by_n.push_back({input.name, method, limits[i], limits[i + 1] - 1, 0, {}});
        by_n.push_back({input.name, method, 1, limits[std::size(limits) - 1] - 1, 0, {}}); // all
        std::vector<double> best(bvh.bvs.size() * 6), bound(best);
        Refitter optimum(bvh, input.surface, {method, 6, Rounding::plain, Precision::float64, converged});
        std::vector<Refitter> refits;
        for (int passes = 0; passes < 5; ++passes) {
            throw_if_interrupted();
            refits.emplace_back(bvh, input.surface,
                                RefitOptions{method, 6, Rounding::plain, Precision::float64, passes});
        }
        for (std::size_t f = 0; f < input.clip.frame_count(); ++f) {
            throw_if_interrupted();
            const Clip::Frame maps = input.clip.frame(f);
            optimum(maps, best);
            for (int passes = 0; passes < 5; ++passes) {
                throw_if_interrupted();
                refits[static_cast<std::size_t>(passes)](maps, bound);
                for (std::size_t bv = 0; bv < bvh.bvs.size(); ++bv)
                    for (DualGap& gap : by_n) {
                        const std::size_t n = bvh.bvs[bv].influence_count;
                        if (n < gap.least_n || n > gap.most_n)
                            continue;
                        for (std::size_t d = 6 * bv; d < 6 * bv + 6; ++d) {
                            const double width = best[d] + best[d ^ 1];
                            if (!(width > 0))
                                continue;
                            gap.gap[passes] += 100 * (bound[d] - best[d]) / width;
                            gap.bounds += passes == 0;
                        }
                    }
            }
        }
        for (DualGap& gap : by_n) {
            if (gap.bounds == 0)
                continue;
            for (double& g : gap.gap)
                g /= static_cast<double>(gap.bounds);
            gap.frames = input.clip.frame_count();
            gaps.push_back(gap);
        }
    }
    return gaps;
}

} // namespace cinch
