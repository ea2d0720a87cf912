// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>

namespace cinch {

/// A check that this program makes of itself, and that failed: a verdict, as a refuted bound is one. What cannot be
/// computed at all (bad input, no memory, an argument out of range) is another exception, and no verdict.
class CheckFailed : public std::logic_error {
public:
    using std::logic_error::logic_error;
};

} // namespace cinch
