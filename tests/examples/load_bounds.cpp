// SPDX-License-Identifier: GPL-3.0-or-later
// What an engine does with `cinch bake FILE.glb --json > bounds.jsonl`: load_bounds bounds.jsonl TIME prints each
// clip's box then. Fields: `cinch schema`.
#include <cinch/bounds.hpp>
#include <fstream>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>

struct Interval {
    double t0, t1;
    cinch::Aabb box;
};

int main(int argc, char** argv)
{
    std::ifstream file(argc > 1 ? argv[1] : "bounds.jsonl");
    const double time = argc > 2 ? std::stod(argv[2]) : 0;
    std::map<std::string, std::vector<Interval>> clips; // intervals of a clip follow one another
    for (std::string line; std::getline(file, line);) {
        const nlohmann::json record = nlohmann::json::parse(line);
        if (record.value("experiment", "") != "bake" || record.value("bv", 1) != 0)
            continue; // BV 0 is the whole character
        const auto low = record.at("min").get<std::array<double, 3>>(),
                   high = record.at("max").get<std::array<double, 3>>();
        clips[record.at("clip")].push_back(
            {record.at("t0"), record.at("t1"), {cinch::Vec3(low.data()), cinch::Vec3(high.data())}});
    }
    for (const auto& [name, intervals] : clips)
        for (const Interval& i : intervals)
            if (i.t0 <= time && time <= i.t1)
                std::cout << name << ": " << i.box.lower.transpose() << " to " << i.box.upper.transpose() << '\n';
    return clips.empty() ? 1 : 0;
}
