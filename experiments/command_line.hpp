// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/CLI.hpp>

#include "experiments/collide/collide.hpp"
#include "experiments/merge.hpp"
#include "experiments/report/reproduce.hpp"
#include "experiments/scaling.hpp"
#include "experiments/simulation/cost_simulation.hpp"
#include "experiments/simulation/simulate.hpp"
#include "experiments/study/study.hpp"
#include "experiments/view.hpp"
#ifdef CINCH_EXACT
#include "experiments/corners.hpp"
#include "experiments/cost/cost.hpp"
#include "experiments/fuzz/fuzz.hpp"
#include "experiments/stability/stability.hpp"
#include "experiments/tightness/tightness.hpp"
#include "experiments/verify.hpp"
#endif

namespace cinch {

/// Every subcommand with its options, which go to the struct given, and its help.
void add_scaling(CLI::App& app, ScalingOptions& o);
void add_simulate(CLI::App& app, SimulateOptions& o);
void add_collide(CLI::App& app, CollideOptions& o);
void add_view(CLI::App& app, ViewOptions& o);
void add_reproduce(CLI::App& app, ReproduceOptions& o);
void add_report(CLI::App& app, ReportOptions& o);
void add_study(CLI::App& app, StudyOptions& o);
void add_merge(CLI::App& app, MergeOptions& o);
#ifdef CINCH_EXACT
void add_verify(CLI::App& app, VerifyOptions& o);
void add_tightness(CLI::App& app, TightnessOptions& o);
void add_cost(CLI::App& app, CostOptions& o, CostSimulationOptions& s);
void add_corners(CLI::App& app, CornersOptions& o);
void add_stability(CLI::App& app, StabilityOptions& o);
void add_fuzz(CLI::App& app, FuzzOptions& o);
#endif

} // namespace cinch
