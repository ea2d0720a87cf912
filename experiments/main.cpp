// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdio>
#include <cstdlib>
#include <system_error>

#include <fmt/format.h>

#include "experiments/command_line.hpp"
#include "experiments/report/provenance.hpp"
#include "toolkit/bounds/kernel/bound_kernel.hpp"
#include "toolkit/surface/input_error.hpp"

namespace {

using namespace cinch;

constexpr int bad_input = 2;

} // namespace

int main(int argc, char** argv)
{
    CLI::App app{"cinch: tight, proven bounds for surfaces deformed by few simulation nodes", "cinch"};
    app.require_subcommand(1);
    app.set_version_flag("--version", describe(provenance(0, 0)).substr(0, describe(provenance(0, 0)).find(',')));
    app.footer("'cinch COMMAND --help' says more, with examples. CINCH_TARGET=NAME forces the\n"
               "instruction set of the kernels, for example CINCH_TARGET=AVX2.");
    ScalingOptions scaling_options;
#ifdef CINCH_EXACT
    VerifyOptions verify_options;
    CornersOptions corners_options;
    add_verify(app, verify_options);
    FuzzOptions fuzz_options;
    CostOptions cost_options;
    CostSimulationOptions cost_simulation_options;
    add_cost(app, cost_options, cost_simulation_options);
    TightnessOptions tightness_options;
    add_tightness(app, tightness_options);
    add_corners(app, corners_options);
    add_fuzz(app, fuzz_options);
    StabilityOptions stability_options;
    add_stability(app, stability_options);
#endif
    add_scaling(app, scaling_options);
    SimulateOptions simulate_options;
    add_simulate(app, simulate_options);
    CollideOptions collide_options;
    add_collide(app, collide_options);
    ViewOptions view_options;
    add_view(app, view_options);
    ReproduceOptions reproduce_options;
    add_reproduce(app, reproduce_options);
    ReportOptions report_options;
    add_report(app, report_options);
    const auto run = [&](const CLI::App& parsed) -> int {
#ifdef CINCH_EXACT
        if (parsed.got_subcommand("verify"))
            return verify(verify_options);
        if (parsed.got_subcommand("cost") && cost_simulation_options.scene.empty())
            return cost(cost_options);
        if (parsed.got_subcommand("cost")) {
            cost_simulation_options.output = cost_options.output;
            cost_simulation_options.seconds = cost_options.seconds;
            return cost_simulation(cost_simulation_options);
        }
        if (parsed.got_subcommand("tightness"))
            return tightness(tightness_options);
        if (parsed.got_subcommand("stability"))
            return stability(stability_options);
        if (parsed.got_subcommand("corners"))
            return corners(corners_options);
        if (parsed.got_subcommand("fuzz")) {
            if (!fuzz_options.seconds && !fuzz_options.cases)
                fuzz_options.cases = 100000;
            if (fuzz_options.corpus.empty() && fuzz_options.defect == Defect::none)
                fuzz_options.corpus = "data/hard";
            return fuzz(fuzz_options);
        }
#endif
        if (parsed.got_subcommand("scaling"))
            return scaling(scaling_options);
        if (parsed.got_subcommand("simulate"))
            return simulate(simulate_options);
        if (parsed.got_subcommand("collide"))
            return collide(collide_options);
        if (parsed.got_subcommand("view"))
            return view(view_options);
        if (parsed.got_subcommand("reproduce"))
            return reproduce(reproduce_options);
        if (parsed.got_subcommand("report"))
            return report(report_options);
        return parsed.get_subcommands().empty() ? bad_input : 0;
    };
    if (const char* target = std::getenv("CINCH_TARGET"); target && *target && !force_kernel_target(target)) {
        fmt::print(stderr, "cinch: CINCH_TARGET={}: this machine has {}\n", target, fmt::join(kernel_targets(), ", "));
        return bad_input;
    }
    if (argc == 1) {
        fmt::print(stderr, "cinch: no command given (see 'cinch --help')\n");
        return bad_input;
    }
    if (argv[1][0] != '-' && app.get_subcommands([&](const CLI::App* s) { return s->get_name() == argv[1]; }).empty()) {
        fmt::print(stderr, "cinch: unknown command '{}' (see 'cinch --help')\n", argv[1]);
        return bad_input;
    }
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& success) { // --help, --version
        return app.exit(success);
    } catch (const CLI::ParseError& error) {
        fmt::print(stderr, "cinch: {} (see 'cinch --help')\n", error.what());
        return bad_input;
    }
    try {
        const int status = run(app);
        if (std::fflush(stdout) != 0 || std::ferror(stdout)) {
            fmt::print(stderr, "cinch: the results could not be written; is the disk full?\n");
            return bad_input;
        }
        return status;
    } catch (const InputError& error) {
        fmt::print(stderr, "cinch: {}\n", error.what());
        return bad_input;
    } catch (const std::system_error& error) { // thrown by the print functions when their buffer overflows into a full disk
        fmt::print(stderr, "cinch: the results could not be written: {}\n", error.what());
        return bad_input;
    } catch (const std::bad_alloc&) {
        fmt::print(stderr, "cinch: out of memory\n");
        return bad_input;
    } catch (const std::exception& error) {
        fmt::print(stderr, "cinch: a check failed: {}\n", error.what());
        return 1;
    }
}
