// SPDX-License-Identifier: GPL-3.0-or-later
// Internal to page/: how pages look.
#pragma once

namespace cinch {

extern const char* const page_style;
extern const char* const page_script;

} // namespace cinch
