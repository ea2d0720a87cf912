// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <chrono>
#include <filesystem>

#include <fmt/format.h>
#include <sched.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "experiments/bench/measure.hpp"
#include "experiments/report/provenance.hpp"

namespace cinch::bench {
namespace {

using Clock = std::chrono::steady_clock;
double since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

Child wait_for(pid_t pid, Clock::time_point start, int out, double limit)
{
    Child child;
    char buffer[1 << 16];
    if (out >= 0)
        for (ssize_t n; (n = read(out, buffer, sizeof buffer)) > 0;) {
            child.out.append(buffer, static_cast<std::size_t>(n));
            if (since(start) > limit)
                kill(pid, SIGKILL);
        }
    int status = 0;
    rusage usage = {};
    wait4(pid, &status, 0, &usage);
    child.seconds = since(start);
    child.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    child.peak_mb = static_cast<double>(usage.ru_maxrss) / 1024;
    return child;
}

} // namespace

double median_seconds(const std::function<void()>& call, double total_seconds)
{
    std::vector<double> times;
    const auto begin = Clock::now();
    while (times.size() < 3 || since(begin) < total_seconds) {
        const auto start = Clock::now();
        call();
        times.push_back(since(start));
    }
    std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2), times.end());
    return times[times.size() / 2];
}

Child run(const std::vector<std::string>& command, double limit)
{
    int pipe_ends[2];
    if (pipe(pipe_ends) != 0)
        throw std::runtime_error("no pipe");
    const auto start = Clock::now();
    const pid_t pid = fork();
    if (pid == 0) {
        alarm(static_cast<unsigned>(limit) + 1); // ends a child that prints nothing, too
        dup2(pipe_ends[1], STDOUT_FILENO);
        close(pipe_ends[0]);
        close(pipe_ends[1]);
        std::vector<char*> arguments;
        for (const std::string& word : command)
            arguments.push_back(const_cast<char*>(word.c_str()));
        arguments.push_back(nullptr);
        execvp(arguments[0], arguments.data());
        _exit(127);
    }
    close(pipe_ends[1]);
    Child child = wait_for(pid, start, pipe_ends[0], limit);
    close(pipe_ends[0]);
    return child;
}

Child run(const std::function<void()>& call)
{
    const auto start = Clock::now();
    const pid_t pid = fork();
    if (pid == 0) {
        call();
        _exit(0);
    }
    return wait_for(pid, start, -1, 0);
}

void print(const std::vector<Figure>& figures)
{
    for (const Figure& f : figures)
        fmt::print("{:<62} {:>16}  {:>12}  {}\n", f.what, f.measured, f.target, f.reached ? "reached" : "FALLS SHORT");
}

} // namespace cinch::bench

int main(int argc, char** argv)
{
    if (argc != 2 || std::string(argv[1]) != "exact") {
        fmt::print(stderr, "usage: cinch-bench exact\n\nMeasures the exact side against lrs and CGAL's linear program "
                           "solver on one core, as ratios in one run.\n");
        return 2;
    }
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(0, &one);
    sched_setaffinity(0, sizeof one, &one); // children inherit it
    const auto program = std::filesystem::read_symlink("/proc/self/exe").parent_path().parent_path() / "cinch";
    const int status = cinch::bench::exact(program.string());
    fmt::print("{}\n", cinch::describe(cinch::provenance(1, 0)));
    return status;
}
