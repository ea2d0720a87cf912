// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

namespace cinch {

struct ReproduceOptions {
    std::string out = "results";
    bool quick = false;
    std::uint64_t seed = 0;
    std::string shard; ///< "I/N": every N-th experiment, and no page; empty: all
};

/// Runs every experiment that is not stored yet, each as a process of its own, and writes the page. An experiment's
/// file appears only when it is whole, so a run that was stopped or killed continues where it was; those that run in
/// cells keep their cells in a folder meanwhile. Returns the exit
/// status: 0 done, 1 a check of an experiment failed, 2 an experiment could not run or a stored result is damaged, 130
/// interrupted, with what is finished kept.
int reproduce(const ReproduceOptions& options);

struct ReportOptions {
    std::string folder;
    std::string page; ///< file to write; empty: report.html in the folder
};

/// Whether a folder holds results of `reproduce`, of any of its shards.
bool holds_results(const std::string& folder);

/// Writes the page of all shards, where every experiment is stored; else says which are not, and how to run them.
/// Returns the exit status.
int merge_results(const std::string& folder);

/// Writes the page of stored results again. Returns the exit status: 2 if a file is damaged; it is named and left out.
int report(const ReportOptions& options);

} // namespace cinch
