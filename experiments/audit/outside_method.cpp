// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/audit/outside_method.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "experiments/audit/exact_clip.hpp"
#include "experiments/bake/timed_body.hpp"
#include "experiments/report/child.hpp"
#include "experiments/report/interrupt.hpp"
#include "experiments/report/scratch_folder.hpp"

namespace cinch {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const Vec3& v) { return {v[0], v[1], v[2]}; }

Json surface_of(const TimedBody& body, const std::string& clip, std::size_t frames)
{
    const DeformableSurface& surface = body.input.surface;
    Json vertices = Json::array(), triangles = Json::array(), weights = Json::array(), targets = Json::array();
    for (const Vec3& v : surface.mesh.vertices)
        vertices.push_back(to_json(v));
    for (const auto& t : surface.mesh.triangles)
        triangles.push_back(t);
    for (std::size_t v = 0; v < surface.weights.vertex_count(); ++v) {
        const Weights::Row row = surface.weights.of(v);
        Json all = Json::array();
        for (std::size_t i = 0; i < row.node.size(); ++i)
            all.push_back({row.node[i], row.weight[i]});
        weights.push_back(std::move(all));
    }
    for (const MorphTarget& target : body.targets()) {
        Json all = Json::array();
        for (std::size_t i = 0; i < target.vertex.size(); ++i)
            all.push_back({target.vertex[i], to_json(target.displacement[i])});
        targets.push_back(std::move(all));
    }
    return {{"surface", body.input.name}, {"clip", clip},           {"frames", frames},
            {"vertices", vertices},       {"triangles", triangles}, {"nodes", surface.weights.node_count},
            {"weights", weights},         {"targets", targets}};
}

Json frame_of(const Instant& at)
{
    Json maps = Json::array();
    for (const AffineMap& map : at.maps) {
        Json rows = Json::array();
        for (const auto& row : map.m)
            for (const double x : row)
                rows.push_back(x);
        maps.push_back(std::move(rows));
    }
    return {{"time", at.time_s}, {"maps", maps}, {"morphs", at.weights}};
}

Vec3 vector_of(const Json& json)
{
    if (!json.is_array() || json.size() != 3)
        throw std::domain_error("three numbers");
    return {json[0].get<double>(), json[1].get<double>(), json[2].get<double>()};
}

// Throws std::exception for what is no bound.
EngineBound bound_of(const std::string& line)
{
    const Json json = Json::parse(line);
    if (json.contains("low"))
        return {vector_of(json.at("low")), vector_of(json.at("high")), {}};
    return EngineBound::around(vector_of(json.at("centre")), json.at("radius").get<double>());
}

} // namespace

OutsideMethod parse_outside(const std::string& text)
{
    const std::size_t sign = text.find('=');
    if (sign == std::string::npos || sign == 0 || sign + 1 == text.size())
        throw InputError(fmt::format("--outside: expected NAME=COMMAND, found '{}'", text));
    OutsideMethod method{text.substr(0, sign), text.substr(sign + 1)};
    bool taken = method.name.starts_with("cinch");
    for (const EngineFormula& formula : engine_formulas())
        taken |= formula.name == method.name;
    if (taken)
        throw InputError(fmt::format("--outside: '{}' is the name of another row; choose one", method.name));
    return method;
}

std::vector<EngineBound> bounds_of(const OutsideMethod& method, const TimedBody& body, const std::string& clip,
                                   const std::vector<Instant>& instants)
{
    const ScratchFolder folder;
    const std::filesystem::path in = folder.path / "frames.jsonl", out = folder.path / "bounds.jsonl";
    {
        std::ofstream lines(in);
        lines << surface_of(body, clip, instants.size()).dump() << '\n';
        for (const Instant& at : instants)
            lines << frame_of(at).dump() << '\n';
        if (!lines.flush())
            throw InputError::in_file(in.string(), "cannot be written");
    }
    const int status = run_program("/bin/sh", {"sh", "-c", method.command}, in, out);
    throw_if_interrupted();
    if (status != 0)
        throw InputError(fmt::format("--outside {}: '{}' ended with status {}", method.name, method.command, status));
    std::vector<EngineBound> bounds;
    std::ifstream lines(out);
    for (std::string line; std::getline(lines, line);) {
        try {
            bounds.push_back(bound_of(line));
        } catch (const std::exception&) {
            throw InputError(fmt::format(R"(--outside {}: line {}: expected {{"low":[x,y,z],"high":[x,y,z]}} or )"
                                         R"({{"centre":[x,y,z],"radius":r}}, found '{:.60}')",
                                         method.name, bounds.size() + 1, line));
        }
    }
    if (bounds.size() != instants.size())
        throw InputError(fmt::format("--outside {}: expected a line for each of {} frames, found {}", method.name,
                                     instants.size(), bounds.size()));
    return bounds;
}

} // namespace cinch
