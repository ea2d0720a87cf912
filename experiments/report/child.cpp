// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/child.hpp"

#include <cerrno>
#include <csignal>
#include <ctime>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cinch/surface.hpp"
#include "experiments/report/interrupt.hpp"

namespace cinch {

namespace {

// `own_group`: what the program starts ends with it.
int run(const std::string& program, const std::vector<std::string>& words, const std::filesystem::path& input,
        const std::filesystem::path& output, bool own_group)
{
    std::vector<char*> pointers;
    for (const std::string& word : words)
        pointers.push_back(const_cast<char*>(word.c_str()));
    pointers.push_back(nullptr);
    const int out = open(output.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0644),
              in = open(input.c_str(), O_RDONLY | O_CLOEXEC);
    if (out < 0 || in < 0)
        throw InputError::in_file(output.string(), "cannot be written");
    const pid_t parent = getpid(), child = fork();
    if (child == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        if (own_group)
            setpgid(0, 0);
        sigset_t ours; // what a terminal sends to both is for the parent to answer
        sigemptyset(&ours);
        sigaddset(&ours, SIGINT);
        sigprocmask(SIG_BLOCK, &ours, nullptr);
        if (getppid() != parent || dup2(in, STDIN_FILENO) < 0 || dup2(out, STDOUT_FILENO) < 0)
            _exit(127);
        execv(program.c_str(), pointers.data());
        _exit(127);
    }
    close(out);
    close(in);
    if (child < 0)
        throw InputError("no process can be started");
    int status = 0;
    for (;;) {
        const pid_t ended = waitpid(child, &status, WNOHANG);
        if (ended == child)
            break;
        if (ended < 0 && errno != EINTR)
            throw InputError("a process was lost");
        if (interrupted()) // nobody reads half a result
            kill(own_group && getpgid(child) == child ? -child : child, SIGKILL);
        const timespec pause{0, 20'000'000};
        nanosleep(&pause, nullptr);
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

} // namespace

int run_child(const std::vector<std::string>& arguments, const std::filesystem::path& output)
{
    std::vector<std::string> words{"cinch"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    return run("/proc/self/exe", words, "/dev/null", output, false);
}

int run_program(const std::string& program, const std::vector<std::string>& words, const std::filesystem::path& input,
                const std::filesystem::path& output)
{
    return run(program, words, input, output, true);
}

} // namespace cinch
