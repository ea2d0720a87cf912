// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/interrupt.hpp"

#include <atomic>
#include <csignal>
#include <cstdint>
#include <ctime>
#include <string_view>

#include <unistd.h>

#include "experiments/report/whole_file.hpp"

namespace cinch {
namespace {

static_assert(std::atomic<int>::is_always_lock_free &&
              std::atomic<std::int64_t>::is_always_lock_free); // handlers read and write these
std::atomic<int> signal_met = 0;
std::atomic<std::int64_t> met_ms = 0; ///< when
std::atomic<bool> is_caught = false;

/// No two of anybody's keystrokes are so close, but two signals of one wish may be: `timeout` sends one to the process
/// and one to its group.
constexpr std::int64_t one_wish_ms = 30;

std::int64_t now_ms()
{
    timespec t = {};
    clock_gettime(CLOCK_MONOTONIC, &t);
    return std::int64_t{t.tv_sec} * 1000 + t.tv_nsec / 1'000'000;
}

void say(std::string_view text)
{
    const ssize_t ignored = write(STDERR_FILENO, text.data(), text.size());
    static_cast<void>(ignored);
}

[[noreturn]] void end_now(int signal)
{
    remove_partial_files();
    _exit(128 + signal);
}

// Only what is safe in a handler: atomics, clock_gettime, isatty, write, unlink, _exit.
void on_signal(int signal)
{
    const std::int64_t now = now_ms();
    int none = 0;
    std::int64_t never = 0;
    met_ms.compare_exchange_strong(never, now);
    const bool first = signal_met.compare_exchange_strong(none, signal);
    if (first)
        say(isatty(STDERR_FILENO) == 1 ? "\r\x1b[Kcinch: stopping …\n"
                                       : "cinch: stopping …\n"); // over the progress bar
    if (!is_caught || (!first && now - met_ms > one_wish_ms))
        end_now(signal);
}

void on_broken_pipe(int signal) { end_now(signal); }

void handle(int signal, void (*handler)(int))
{
    struct sigaction action = {};
    action.sa_handler = handler;
    action.sa_flags = SA_RESTART;
    sigaction(signal, &action, nullptr);
}

} // namespace

void end_on_interrupt()
{
    is_caught = false;
    handle(SIGINT, on_signal);
    handle(SIGTERM, on_signal);
    struct sigaction now = {};
    if (sigaction(SIGHUP, nullptr, &now) == 0 && now.sa_handler != SIG_IGN) // nohup
        handle(SIGHUP, on_signal);
    handle(SIGPIPE, on_broken_pipe);
    struct sigaction ignore = {};
    ignore.sa_handler = SIG_IGN;
    sigaction(SIGXFSZ, &ignore, nullptr); // a limit on file sizes is an error of writing like any other
}

void catch_interrupt()
{
    end_on_interrupt();
    is_caught = true;
}

bool interrupted() { return signal_met != 0; }

void throw_if_interrupted()
{
    if (interrupted())
        throw Interrupted{};
}

int interrupt_status() { return 128 + (signal_met ? signal_met.load() : SIGINT); }

} // namespace cinch
