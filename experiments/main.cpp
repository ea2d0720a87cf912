// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <system_error>

#include <fmt/format.h>
#include <unistd.h>

#include "cinch/surface.hpp"
#include "exact/check_failed.hpp"
#include "experiments/command_line.hpp"
#include "experiments/report/interrupt.hpp"
#include "experiments/report/or_leave.hpp"
#include "experiments/report/provenance.hpp"
#include "toolkit/deform/kernel/targets.hpp"

namespace {

using namespace cinch;

constexpr int refuted = 1, bad_input = 2, stopped = 130;

/// The exit status of what runs, and one line on standard error where it throws: 1 for a verdict and nothing else, 2
/// for all that keeps a command from reaching one.
template <class Run> int status_of(const Run& run)
{
    auto refuse = [](const std::string& why) {
        fmt::print(stderr, "cinch: {}\n", why);
        return bad_input;
    };
    try {
        const int status = run();
        if (std::fflush(stdout) != 0 || std::ferror(stdout))
            return refuse("the results could not be written; is the disk full?");
        return status == stopped ? interrupt_status() : status;
    } catch (const Interrupted&) {
        fmt::print(stderr, "cinch: interrupted before there was a result\n");
        return interrupt_status();
    } catch (const CheckFailed& error) {
        fmt::print(stderr, "cinch: a check failed: {}\n", error.what());
        return refuted;
    } catch (const InputError& error) {
        return refuse(error.what());
    } catch (const std::filesystem::filesystem_error& error) {
        return refuse(fmt::format("{}: {}; check the name, the disk and the permissions", error.path1().string(),
                                  error.code().message()));
    } catch (const std::system_error&
                 error) { // thrown by the print functions when their buffer overflows into a full disk, for one
        return refuse(fmt::format("the system refused: {}; is the disk full, or a limit reached?", error.what()));
    } catch (const std::bad_alloc&) {
        return refuse("out of memory; fewer --frames, or larger leaves (--leaf), take less");
    } catch (const std::length_error& error) {
        return refuse(fmt::format("too large: {}", error.what()));
    } catch (const std::exception& error) {
        return refuse(fmt::format("cannot be computed: {}; nothing is said of any bound", error.what()));
    }
}

} // namespace

int main(int argc, char** argv)
{
    end_on_interrupt();
    CLI::App app{"cinch: tight, proven bounds for surfaces deformed by few simulation nodes", "cinch"};
    app.require_subcommand(1);
    app.set_version_flag("--version", describe(provenance(0, 0)).substr(0, describe(provenance(0, 0)).find(',')));
    app.footer("'cinch COMMAND --help' says more, with examples. CINCH_TARGET=NAME forces the\n"
               "instruction set of the kernels, for example CINCH_TARGET=AVX2.\n"
               "\n"
               "Exit status:\n"
               "  0    done, and all that was checked holds\n"
               "  1    a verdict: a bound is refuted, or a check or a step failed; nothing else\n"
               "  2    no verdict: bad usage or input, a full disk, too little memory\n"
               "  130  interrupted (Ctrl-C; 143 by SIGTERM): results so far are printed and say\n"
               "       that they are not all; a second Ctrl-C ends the command at once\n"
               "An output appears when it is whole; until then it is NAME.XXXXXX.part beside it.");
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
    StudyOptions study_options;
    add_study(app, study_options);
    MergeOptions merge_options;
    add_merge(app, merge_options);
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
            if (fuzz_options.corpus.empty() && fuzz_options.defect == Defect::none &&
                fuzz_options.shards.folder.empty())
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
        if (parsed.got_subcommand("study"))
            return study(study_options);
        if (parsed.got_subcommand("merge"))
            return merge_shards(merge_options);
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
        const bool of_command = argv[1][0] != '-'; // a known one, by now
        fmt::print(stderr, "cinch: {} (see 'cinch {}--help')\n", error.what(),
                   of_command ? std::string(argv[1]) + " " : "");
        return bad_input;
    }
    const int status = status_of([&] { return run(app); });
    if (some_call_was_left) { // and still reads what the end of main would destroy
        std::fflush(nullptr);
        _exit(status);
    }
    return status;
}
