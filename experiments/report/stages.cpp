// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/stages.hpp"

#include <algorithm>
#include <iterator>
#include <sstream>

#include <fmt/format.h>

namespace cinch {
namespace {

std::vector<std::string> words(const std::string& text)
{
    std::istringstream in(text);
    return {std::istream_iterator<std::string>(in), {}};
}

} // namespace

bool Stage::runs_in_cells() const
{
    return arguments.front() == "tightness" ||
           (arguments.front() == "verify" &&
            std::find(arguments.begin(), arguments.end(), "--update") == arguments.end());
}

std::vector<Stage> stages()
{
    std::vector<Stage> all;
    auto stage = [&](const std::string& name, const std::string& what, double seconds, const std::string& arguments,
                     double quick_seconds, const std::string& quick) {
        all.push_back({name, what, words(arguments), words(quick), seconds, quick_seconds});
    };
    stage("scaling", "time of one bound (Table 1)", 30, "scaling --seconds 3", 12, "scaling --seconds 0.2");
#ifdef CINCH_EXACT
    stage("tightness", "tightness of the pulled brain (Figs. 1 and 5)", 160, "tightness brain-pull --frames 12", 25,
          "tightness brain-pull --frames 2 --leaf 256 --sweep 65 --methods sphere,eq12,limited,best");
#endif
    // Contacts come and go over all frames, so a quick run leaves out peers and rounds, and spatial hashing where that
    // takes long, but no frame.
    const std::string few = " --rounds 1 --backends cinch,cinch-full,refit-16,refit-1,eq12-aabb,eq12-obb-14";
    for (int ring = 1; ring <= 8; ++ring) {
        const bool large = ring == 3 || ring == 4 || ring >= 7;
        const std::string scene = fmt::format("santa-ring-{}", ring),
                          what = fmt::format("collisions, scene {} (Tables 2 to 4)", ring);
        if (large)
            stage(scene, what, 120, "collide " + scene, 24, ring == 3 ? "collide " + scene + few : "");
        else
            stage(scene, what, 20, "collide " + scene, 8, "collide " + scene + few + ",hash");
    }
    stage("fishes", "collisions of 24 fishes (Fig. 7)", 90, "collide fishes", 30, "collide fishes --frames 20" + few);
#ifdef CINCH_EXACT
    stage("cost", "what accuracy costs", 50, "cost", 12, "cost --kdops 6 --seconds 0.3 --leaf 64 --this-input-only");
    stage("verify", "every bound of the pulled brain, proven exactly", 25, "verify brain-pull --frames 4", 12,
          "verify brain-pull --frames 1 --leaf 64");
    stage("verify-lazy", "the bounds that collision reads, proven exactly", 5, "verify santa-ring-1 --update lazy", 12,
          "verify santa-ring-1 --update lazy --frames 6");
    const std::string cases = "003_n1_n1 010_generic_n7 017_generic_n14 024_lzero_n10 031_narrow_n9 038_hyper_n5 "
                              "045_hyperdeg_n4 052_grid_n2 059_grid_n10 066_lh_fixed_n8 073_infeasible_suml_n8 "
                              "080_single_point_n2 087_fewslack_n5 094_simplex01_n12 101_leaf_rounded_n6 "
                              "108_ulp_slack_n2 115_large_generic_n100 122_large_narrow_n100 129_large_infeasible_n200";
    stage("corners", "true corners and maxima of the reference cases", 2, "corners " + cases, 2, "corners " + cases);
#endif
    stage("views", "views of deforming surfaces (Figs. 1, 6 and 7)", 50, "view", 15,
          "view brain-pull --frames 16 --levels 6 --kdop 14 --bits 14 --camera -55,14");
    return all;
}

std::vector<std::string> arguments_of(const Stage& stage, bool quick, std::uint64_t seed)
{
    std::vector<std::string> all = quick && !stage.quick.empty() ? stage.quick : stage.arguments;
    all.push_back("--json");
    if (stage.arguments.front() != "corners") { // which has nothing random
        all.push_back("--seed");
        all.push_back(std::to_string(seed));
    }
    return all;
}

} // namespace cinch
