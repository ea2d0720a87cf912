// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace cinch {

/// What a user, a batch system or a closed terminal asks by SIGINT (Ctrl-C), SIGTERM and SIGHUP: to stop, which is
/// answered at once by "stopping …" on standard error. There are two ways to stop:
///
/// 1. from end_on_interrupt() on: partial files are removed, and the process ends. For all that comes before there are
/// results.
/// 2. from catch_interrupt() on: interrupted() says so, and the command ends by itself, with its results so far. A
/// second signal ends it as in 1.
///
/// Either way a reader that goes away (SIGPIPE) ends the process in silence, partial files removed.
void end_on_interrupt();
void catch_interrupt();

bool interrupted();

/// Thrown by throw_if_interrupted() through whatever computes, to whoever keeps results. No std::exception, so that
/// none takes it for a failure.
struct Interrupted {};
/// For loops that have nothing of their own to keep, on any thread.
void throw_if_interrupted();

/// What the process ends with after an interrupt: 128 + the signal, as shells say it: 130 for Ctrl-C, 143 for SIGTERM,
/// 129 for SIGHUP.
int interrupt_status();

} // namespace cinch
