// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "experiments/measure/race.hpp"
#include "experiments/report/paper_figures.hpp"
#include "experiments/report/results.hpp"

namespace cinch {

/// The surfaces and numbers of simulation nodes of the paper's Table 1.
struct ScalingSize {
    const char *shape, *paper; ///< and its name in the table
    std::size_t vertices;

    /// Its Eq. 12 with so many simulation nodes, µs.
    const PaperFigure& eq12(std::size_t nodes) const;
    /// Its optimal AABB, µs.
    const PaperFigure& optimal() const { return paper_figure("Table 1", paper, "optimal"); }
};
inline constexpr ScalingSize scaling_sizes[] = {
    {"brain-3500", "3.5K", 3500}, {"brain-30000", "30K", 30000}, {"brain-145000", "145K", 145000}};
inline constexpr std::size_t scaling_nodes[] = {65, 225, 509};

/// What records of `cinch scaling` say of the paper's sizes. Whoever shows a figure of them, on a terminal or a page,
/// has it from here.
struct ScalingFigures {
    const Results& results;

    /// Of one bound, µs.
    Traced us(const char* method, std::size_t vertices, std::size_t n) const;
    /// Its time over the default's, in the same rounds.
    Traced over_default(const char* method, std::size_t vertices, std::size_t n) const;
    /// Exponent of n in its time.
    Traced exponent(const char* method, std::size_t vertices) const;
    /// The greatest of its times with 145,000 vertices over those with 3,500.
    Traced over_fewest_vertices(const char* method, std::size_t n) const;

    /// All that has a target.
    std::vector<Figure> with_targets() const;

private:
    const Record* record(const char* method, std::size_t vertices, std::size_t n) const;
};

} // namespace cinch
