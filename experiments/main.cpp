// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/command_line.hpp"

namespace {

using namespace cinch;

// In the order in which --help lists them.
constexpr AddCommand commands[] = {
#ifdef CINCH_EXACT
    add_verify,  add_bake,     add_audit,   add_cost, add_tightness, add_corners, add_fuzz,  add_stability,
#endif
    add_scaling, add_simulate, add_collide, add_view, add_reproduce, add_report,  add_study, add_merge,     add_schema,
};

} // namespace

int main(int argc, char** argv) { return run_program(argc, argv, commands); }
