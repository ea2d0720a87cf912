// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "cinch/bounds.hpp"
#include "experiments/input.hpp"

namespace cinch {

/// What rows of a study are about: a run as a whole; or beside that each level of its tree, each frame, each BV of each
/// frame.
enum class Detail { run, levels, frames, bvs };

/// What is to be studied: every input with every number of simulation nodes, seed and motion, by every method, in every
/// arithmetic, as every k-DOP.
struct Plan {
    std::vector<std::string> inputs{"brain"};
    std::vector<std::uint64_t> nodes{0}; ///< 0: as many as the input has or is usual
    std::vector<std::uint64_t> seeds{0};
    std::vector<std::string> motions{""}; ///< "": the usual one
    std::vector<std::string> clips{""};   ///< of characters; "": the first
    std::vector<Methods> methods{Method::best};
    std::vector<Precision> precisions{Precision::float32};
    std::vector<int> kdops{6};
    std::uint64_t frames = 0; ///< 0: all
    std::uint64_t leaf = 1;   ///< most triangles per leaf
    std::uint64_t passes = 1; ///< evaluations of the dual function
    double fps = 0;           ///< of a character's clip; 0: as usual
    double support = 0;       ///< reach of a simulation node, in fill distances; 0: as usual
    bool partial = false;     ///< bound what is modelled of characters
    Detail detail = Detail::run;
};

/// From a JSON object; names of inputs may be patterns (*, ?, [...]) of files, taken in the order of the alphabet.
/// Throws InputError, which names file and field, for what it does not know or cannot be.
Plan parse_plan(const std::string& text, const std::string& file);

/// All of it, patterns replaced by what they matched.
nlohmann::ordered_json to_json(const Plan& plan);

/// A cell: what is deformed, and how. Its rows are those of the methods, precisions and k-DOPs, in this order.
InputOptions cell_of(const Plan& plan, std::size_t cell);
std::size_t cell_count(const Plan& plan);

} // namespace cinch
