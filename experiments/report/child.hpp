// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace cinch {

/// Runs this program with other arguments and waits. Its standard output goes to the file, its standard error is ours.
/// An interrupt of this process ends it at once, and it never outlives this process. Returns its exit status, 128 + the
/// signal if one ended it.
int run_child(const std::vector<std::string>& arguments, const std::filesystem::path& output);

/// The same of any program; `words` begin with its name. An interrupt ends what it has started, too.
int run_program(const std::string& program, const std::vector<std::string>& words, const std::filesystem::path& input,
                const std::filesystem::path& output);

} // namespace cinch
