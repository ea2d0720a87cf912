// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/page/sections.hpp"
namespace cinch {
Section tightness_section(const Results&) { return {"fig-5", "", "", {}}; }
Section collide_section(const Results&) { return {"fig-5", "", "", {}}; }
Section cost_section(const Results&) { return {"fig-5", "", "", {}}; }
Section proof_section(const Results&) { return {"fig-5", "", "", {}}; }
}
