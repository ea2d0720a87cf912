// SPDX-License-Identifier: GPL-3.0-or-later
// Micro-benchmarks of single bounds; for ratios between methods in one run see `cinch scaling` and `cinch cost`.
#include <limits>
#include <map>

#include <benchmark/benchmark.h>

#include "cinch/bounds.hpp"
#include "cinch/deform.hpp"
#include "experiments/baselines/optimal_box.hpp"
#include "experiments/baselines/textbook.hpp"
#include "experiments/input.hpp"
#include "toolkit/bounds/bound_box.hpp"
#include "toolkit/hierarchy/packed_bvh.hpp"

using namespace cinch;

namespace {

struct Scene {
    Input input;
    Bvh bvh;
    Clip::Frame frame;
};

// The shipped 3,500-vertex brain with so many simulation nodes, as one BV.
const Scene& scene(std::size_t nodes)
{
    static std::map<std::size_t, Scene> all;
    auto found = all.find(nodes);
    if (found == all.end()) {
        InputOptions options;
        options.input = "brain-3500";
        options.nodes = nodes;
        options.frames = 1;
        Scene s{load_input(options), {}, {}};
        s.frame = s.input.clip.frame(0);
        s.bvh = build_bvh(s.input.surface, std::numeric_limits<std::size_t>::max());
        found = all.emplace(nodes, std::move(s)).first;
    }
    return found->second;
}

template <class T> void kernel(benchmark::State& state, Method method, int kdop, Rounding rounding)
{
    const Scene& s = scene(static_cast<std::size_t>(state.range(0)));
    const PackedBvh<T> packed = pack<T>(s.bvh, s.input.surface, choose_kinds(s.bvh, s.input.surface, method));
    ProjectedMaps<T> maps;
    project(std::span<const AffineMap>(s.frame), packed.rest, kdop, rounding, maps);
    KernelScratch<T> scratch;
    double supports[most_directions];
    for (auto _ : state) {
        bound_packed<T>({packed.bvs, packed.node, packed.value, &maps, rounding, 1}, 0, 1, scratch,
                        std::span(supports).first(static_cast<std::size_t>(kdop)));
        benchmark::DoNotOptimize(supports);
    }
    state.SetComplexityN(state.range(0));
}

void readable(benchmark::State& state, Method method)
{
    const Scene& s = scene(static_cast<std::size_t>(state.range(0)));
    BoundScratch scratch;
    double supports[6];
    for (auto _ : state) {
        bound_box(s.bvh.rest(0), s.frame, method, Rounding::proven, axes_of(6), scratch, supports);
        benchmark::DoNotOptimize(supports);
    }
}

void textbook(benchmark::State& state, TransformedBox box)
{
    const Scene& s = scene(static_cast<std::size_t>(state.range(0)));
    Textbook eq12(s.bvh, 0, s.frame);
    double supports[6];
    for (auto _ : state) {
        eq12.bound(box, supports);
        benchmark::DoNotOptimize(supports);
    }
}

void projection(benchmark::State& state, int kdop)
{
    const Scene& s = scene(static_cast<std::size_t>(state.range(0)));
    const RestExtent rest = rest_extent(s.bvh, s.input.surface);
    ProjectedMaps<float> maps;
    for (auto _ : state)
        project<float>(s.frame, rest, kdop, Rounding::proven, maps);
}

void evaluation(benchmark::State& state)
{
    const Scene& s = scene(static_cast<std::size_t>(state.range(0)));
    std::vector<Vec3> out(s.input.surface.mesh.vertices.size());
    for (auto _ : state)
        evaluate(s.input.surface.mesh.vertices, s.input.surface.weights, s.frame, out);
}

} // namespace

int main(int argc, char** argv)
{
    const std::vector<std::int64_t> nodes{65, 225, 509};
    auto sized = [&](benchmark::internal::Benchmark* b) { b->ArgName("n")->ArgsProduct({nodes}); };
    sized(benchmark::RegisterBenchmark("textbook/corners", textbook, TransformedBox::corners));
    sized(benchmark::RegisterBenchmark("textbook/axes", textbook, TransformedBox::axes));
    for (const Method method : {Method::eq12, Method::limited})
        sized(benchmark::RegisterBenchmark(("readable/" + std::string(name_of(method))).c_str(), readable, method));
    for (const Method method : kernel_methods)
        for (const int kdop : kdops) {
            const std::string name = std::string(name_of(method)) + "/k" + std::to_string(kdop);
            sized(
                benchmark::RegisterBenchmark(("float/" + name).c_str(), kernel<float>, method, kdop, Rounding::proven));
            sized(benchmark::RegisterBenchmark(("double/" + name).c_str(), kernel<double>, method, kdop,
                                               Rounding::proven));
        }
    for (const int kdop : {6, 26})
        sized(benchmark::RegisterBenchmark(("projection/k" + std::to_string(kdop)).c_str(), projection, kdop));
    sized(benchmark::RegisterBenchmark("evaluate 3,500 vertices", evaluation));
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv))
        return 2;
    benchmark::RunSpecifiedBenchmarks();
}
