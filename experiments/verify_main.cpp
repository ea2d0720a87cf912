// SPDX-License-Identifier: GPL-3.0-or-later
// `verify` of boxes on shapes and meshes: what experiments/run builds for a first proof, in a third of the time that
// the whole program takes.
#include "cinch/surface.hpp"
#include "experiments/command_line.hpp"
#include "experiments/input_parts.hpp"
#include "experiments/input_scene.hpp"
#include "experiments/report/picture_output.hpp"
#include "experiments/verify.hpp"
#include "experiments/verify_lazy.hpp"
#include "experiments/verify_report.hpp"
#include "experiments/volumes.hpp"
#include "toolkit/bounds/kernel/bound_kdop.hpp"

namespace cinch {
namespace {

[[noreturn]] void elsewhere(const std::string& what)
{
    throw InputError(what +
                     ": this is the program of the first proof; the whole one, 'experiments/run verify', has it");
}

} // namespace

Inputs load_scene(const InputOptions& options) { elsewhere(options.input); }
void load_character(Input&, const InputOptions& options) { elsewhere(options.input); }
int verify_all_times(const VerifyOptions&) { elsewhere("--times all"); }
void verify_lazy(const Inputs&, const VerifyOptions&, VerifyTotals&, LazyTotals&) { elsewhere("--update"); }
void add_volumes(const DeformableSurface&, const Bvh&, std::span<const AffineMap>, int, std::span<const double>,
                 std::vector<VolumeTotals>&)
{
    elsewhere("--volume");
}
std::unique_ptr<PictureOutput> picture_output(const OutputOptions& options)
{
    for (const std::string& file : {options.plot, options.plot_data, options.report})
        if (!file.empty())
            elsewhere(file);
    return nullptr;
}
void print_lazy_table(const VerifiedInput&, const VerifyOptions&, const VerifyTotals&, const LazyTotals&,
                      const Provenance&)
{
    elsewhere("--update");
}
std::vector<nlohmann::ordered_json> lazy_records_of(const VerifiedInput&, const VerifyOptions&, const VerifyTotals&,
                                                    const LazyTotals&)
{
    elsewhere("--update");
}

template <class T> void bound_packed(const KernelInput<T>& input, std::size_t first, std::size_t last,
                                     KernelScratch<T>& scratch, std::span<double> supports)
{
    if (input.maps->kdop != 6)
        elsewhere("--kdop " + std::to_string(input.maps->kdop));
    bound_kdop<T, 3>(input, first, last, scratch, supports.data());
}
template <class T>
void bound_packed(const KernelInput<T>&, std::span<const std::uint32_t>, KernelScratch<T>&, std::size_t, float*)
{
    elsewhere("--update");
}
#define CINCH_BOUND_PACKED(T)                                                                                          \
    template void bound_packed(const KernelInput<T>&, std::size_t, std::size_t, KernelScratch<T>&, std::span<double>); \
    template void bound_packed(const KernelInput<T>&, std::span<const std::uint32_t>, KernelScratch<T>&, std::size_t,  \
                               float*)
CINCH_BOUND_PACKED(float);
CINCH_BOUND_PACKED(double);
#undef CINCH_BOUND_PACKED

} // namespace cinch

int main(int argc, char** argv)
{
    constexpr cinch::AddCommand commands[] = {cinch::add_verify};
    return cinch::run_program(argc, argv, commands);
}
