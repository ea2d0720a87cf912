// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace cinch {

/// From now on the first Ctrl-C (or SIGTERM) only sets a flag, so that results so far can be kept; the second one ends the process.
void catch_interrupt();
bool interrupted();

} // namespace cinch
