// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/interrupt.hpp"

#include <csignal>

namespace cinch {
namespace {

volatile std::sig_atomic_t flag = 0;

void raise_flag(int) { flag = 1; }

} // namespace

void catch_interrupt()
{
    struct sigaction action = {};
    action.sa_handler = raise_flag;
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
}

bool interrupted() { return flag != 0; }

} // namespace cinch
