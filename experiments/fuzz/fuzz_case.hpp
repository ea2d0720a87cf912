// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "experiments/case_file.hpp"
#include "toolkit/surface/skin.hpp"

namespace cinch {

/// One differential test: a weight space with rows of extrema, or, where `rest` is not empty, a small surface.
struct FuzzCase {
    std::string family;
    Case space;                               ///< of a weight-space case; b has one row
    std::vector<Vec3> rest;                   ///< vertices of a surface case
    std::vector<std::vector<double>> weights; ///< per vertex, dense over the nodes, dyadic with sum 1
    std::vector<AffineMap> maps;              ///< per node
    int kdop = 6;
    std::uint32_t trial = 0; ///< of a surface case: which methods are tried, 1 to surface_trials; 0 for all
    int passes = 1;          ///< evaluations of the dual function in it
    std::uint64_t drawn = 0; ///< of a case of times: what draw_time_case makes it from

    bool is_of_times() const { return family == "times"; }
    bool is_surface() const { return !rest.empty(); }
    std::size_t nodes() const { return is_surface() ? maps.size() : space.l.size(); }
};

inline constexpr std::uint32_t surface_trials = 18;

/// The families that cases are drawn from, by name; the last one, "times", only where it is asked for: its cases take a
/// hundred times as long.
std::vector<std::string_view> fuzz_families();

/// Case `index` of a seed: the same whatever else is drawn, on any thread. `family` empty: each in turn.
FuzzCase draw_case(std::uint64_t seed, std::uint64_t index, std::string_view family);

/// Defects planted on purpose, to see what the comparison makes of them.
enum class Defect {
    none,
    no_rounding,  ///< error terms dropped: must be found
    wrong_lambda, ///< λ moved away from the optimum: harmless, must stay proven
    lower_h,      ///< one h lowered by 2^-53: must be found
    sum_order,    ///< sums taken backwards: harmless, the error bound holds in any order
    small_box,    ///< the tightest rest box shrunk by one ulp: must be found
    no_remainder, ///< of bounds over time, as the next ones: chords alone: must be found
    half_bump,    ///< half of what may rise above them: must be found
    skip_key,     ///< the end of every interval forgotten: must be found
    still_morphs, ///< morph targets as at the beginning: must be found
};
constexpr bool is_of_times(Defect defect) { return defect >= Defect::no_remainder; }

inline constexpr std::array defects{std::pair{"", Defect::none},
                                    std::pair{"no-rounding", Defect::no_rounding},
                                    std::pair{"wrong-lambda", Defect::wrong_lambda},
                                    std::pair{"lower-h", Defect::lower_h},
                                    std::pair{"sum-order", Defect::sum_order},
                                    std::pair{"small-box", Defect::small_box},
                                    std::pair{"no-remainder", Defect::no_remainder},
                                    std::pair{"half-bump", Defect::half_bump},
                                    std::pair{"skip-key", Defect::skip_key},
                                    std::pair{"still-morphs", Defect::still_morphs}};
constexpr const char* name_of(Defect defect) { return defects[static_cast<std::size_t>(defect)].first; }

/// Empty if every method of the toolkit holds against the exact side; otherwise what is wrong.
std::string find_fault(const FuzzCase& problem, Defect defect);
std::string time_fault(const FuzzCase& problem, Defect defect); ///< the same of a case of times

/// The smallest case found by dropping nodes and vertices and simplifying numbers that still has a fault.
FuzzCase shrink(FuzzCase problem, Defect defect);

/// A case as one JSON object (hexadecimal floats), readable by `cinch corners` if it is a weight space, and back.
std::string to_json(const FuzzCase& problem, const std::string& fault);
FuzzCase fuzz_case_from_json(const std::string& text, const std::string& file);

} // namespace cinch
