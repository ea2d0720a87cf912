// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

/// Files that are part of the program: embed.cmake turns them into code.
namespace cinch::embedded {

extern const std::string_view record_schema;     ///< records/record.schema.json
extern const std::string_view view_css, view_js; ///< of report/view
extern const std::string_view
    three_js; ///< three.js and what the view needs of its examples; empty if it was not there at build

} // namespace cinch::embedded
