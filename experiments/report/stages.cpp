// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/stages.hpp"

#include <iterator>
#include <sstream>

namespace cinch {
namespace {

std::vector<std::string> words(const char* text)
{
    std::istringstream in(text);
    return {std::istream_iterator<std::string>(in), {}};
}

} // namespace

std::vector<Stage> stages()
{
    std::vector<Stage> all;
    auto stage = [&](const char* name, const char* what, double seconds, const char* arguments, double quick_seconds, const char* quick) {
        all.push_back({name, what, words(arguments), words(quick), seconds, quick_seconds});
    };
    stage("scaling", "time of one bound (Table 1)", 45, "scaling --seconds 3", 8, "scaling --seconds 0.2");
#ifdef CINCH_EXACT
    stage("tightness", "tightness of the pulled brain (Figs. 1 and 5)", 200, "tightness brain-pull --frames 12", 15, "tightness brain-pull --frames 2 --leaf 64 --sweep 65 --methods sphere,eq12,limited,best");
#endif
    stage("santa-ring-1", "collisions, scene 1 (Tables 2 to 4)", 30, "collide santa-ring-1", 10, "collide santa-ring-1 --frames 10 --rounds 1");
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
