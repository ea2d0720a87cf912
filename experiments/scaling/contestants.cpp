// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/scaling/contestants.hpp"

#include <limits>
#include <map>

#include "experiments/baselines/optimal_box.hpp"
#include "experiments/baselines/textbook.hpp"
#include "experiments/report/interrupt.hpp"
#include "toolkit/bounds/bound_box.hpp"
#include "toolkit/hierarchy/packed_bvh.hpp"
#include "toolkit/hierarchy/spheres.hpp"

namespace cinch {
namespace {

// One kernel on a BVH of a single BV.
template <class T> struct Kernel {
    PackedBvh<T> packed;
    ProjectedMaps<T> maps;
    KernelScratch<T> scratch;
    Rounding rounding;
    int passes;

    Kernel(const Bvh& bvh, const DeformableSurface& surface, std::span<const AffineMap> frame, Method method,
           Rounding rounding_, int passes_)
        : packed(pack<T>(bvh, surface, choose_kinds(bvh, surface, method))), rounding(rounding_), passes(passes_)
    {
        project(frame, packed.rest, 6, rounding, maps);
    }
    void bound(std::span<double> supports)
    {
        bound_packed<T>({packed.bvs, packed.node, packed.value, &maps, rounding, passes}, 0, 1, scratch, supports);
    }
};

template <class T> ContestantTimes measure(const Input& input, int passes, double seconds)
{
    const Clip::Frame frame = input.clip.frame(input.clip.frame_count() - 1);
    const Bvh bvh = build_bvh(input.surface, std::numeric_limits<std::size_t>::max());
    double supports[6];
    Textbook textbook(bvh, 0, frame);
    const OptimalBox<T> optimal(input.surface, frame);
    const RestSpheres spheres = rest_spheres(bvh, input.surface);
    BoundScratch scratch;
    std::map<std::string, Kernel<T>> kernels;
    for (const Method method : kernel_methods) {
        throw_if_interrupted();
        kernels.try_emplace(std::string(name_of(method)), bvh, input.surface, frame, method, Rounding::proven, passes);
    }
    kernels.try_emplace("unproven", bvh, input.surface, frame, Method::best, Rounding::plain, passes);

    std::vector<std::function<void()>> calls;
    for (const std::string& name : scaling_contestants()) {
        if (name == "textbook")
            calls.emplace_back([&] { textbook.bound(TransformedBox::corners, supports); });
        else if (name == "textbook-axes")
            calls.emplace_back([&] { textbook.bound(TransformedBox::axes, supports); });
        else if (name == "optimal")
            calls.emplace_back([&] { optimal.bound(supports); });
        else if (name == "sphere")
            calls.emplace_back([&] {
                bound_sphere(spheres.of(bvh.bvs[0], 0), spheres.place, frame, bvh.bvs[0].vertex_influences,
                             Rounding::proven, axes_of(6), supports);
            });
        else if (name == "corners")
            calls.emplace_back([&] {
                bound_box(bvh.rest(0), frame, Method::corners, Rounding::proven, axes_of(6), scratch, supports);
            });
        else
            calls.emplace_back([&supports, &kernel = kernels.at(name)] { kernel.bound(supports); });
    }
    Kernel<T>& best = kernels.at("best");
    ProjectedMaps<T> projected;
    calls.emplace_back(
        [&] { project(std::span<const AffineMap>(frame), best.packed.rest, 6, Rounding::proven, projected); });
    ContestantTimes times;
    times.race = race(calls, seconds);
    times.project_ns = times.race.of(scaling_contestants().size()).value;
    times.kind = name_of(best.packed.bvs[0].kind);
    if (best.packed.bvs[0].also)
        times.kind += "+" + std::string(name_of(best.packed.bvs[best.packed.bvs[0].also].kind));
    return times;
}

} // namespace

const std::vector<std::string>& scaling_contestants()
{
    static const std::vector<std::string> all = [] {
        std::vector<std::string> names{"textbook", "textbook-axes"};
        for (const Method method : all_methods.without(Method::vertices)) // has no kernel
            names.emplace_back(name_of(method));
        names.insert(names.end(), {"unproven", "optimal"});
        return names;
    }();
    return all;
}

ContestantTimes time_contestants(const Input& input, Precision precision, int passes, double seconds)
{
    return precision == Precision::float32 ? measure<float>(input, passes, seconds)
                                           : measure<double>(input, passes, seconds);
}

} // namespace cinch
