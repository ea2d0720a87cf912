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

namespace cinch {
namespace {

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

int run_program(int argc, char** argv, std::span<const AddCommand> commands)
{
    end_on_interrupt();
    if (const char* target = std::getenv("CINCH_TARGET"); target && *target && !force_kernel_target(target)) {
        fmt::print(stderr, "cinch: CINCH_TARGET={}: this machine has {}\n", target, fmt::join(kernel_targets(), ", "));
        return bad_input;
    }
    Run run;
    if (const std::optional<int> status = parse_command_line(argc, argv, commands, run))
        return *status;
    const int status = status_of(run);
    if (some_call_was_left) { // and still reads what the end of main would destroy
        std::fflush(nullptr);
        _exit(status);
    }
    return status;
}

} // namespace cinch
