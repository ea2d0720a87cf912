// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "experiments/measure/race.hpp"

namespace cinch {

/// Times of one explicit substep on the shipped brain: against nodes, neighbours and the plain Eigen version of the
/// same step, which must agree; and of evaluating the surface against the plain Eigen loop. All take turns on one core.
struct StepFigures {
    struct Row {
        std::size_t nodes;
        double neighbours; ///< mean
        double step_us, plain_us;
        Range ratio; ///< of these, plain over ours
        double off;  ///< greatest difference of a position after the steps of both, m
    };
    std::vector<Row> rows;
    double nodes_slope = 0, neighbours_slope = 0;
    double evaluate_us = 0, evaluate_float_us = 0, evaluate_plain_us = 0; ///< 30,000 vertices, 509 nodes
    Range evaluate_ratio = 0, evaluate_float_ratio = 0;                   ///< plain over ours
    std::vector<Figure> figures;
};
StepFigures measure_steps(double seconds);

} // namespace cinch
