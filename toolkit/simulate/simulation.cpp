// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <istream>
#include <numbers>
#include <stdexcept>

#include <Eigen/Geometry>

#include "cinch/environment.hpp"
#include "cinch/surface.hpp"
#include "toolkit/deform/parallel.hpp"
#include "toolkit/simulate/body_builder.hpp"
#include "toolkit/simulate/load_body.hpp"
#include "toolkit/simulate/stream.hpp"

namespace cinch {
namespace {

MeshlessBody discretised(const LoadedBody& loaded, const SceneBody& spec, const std::string& file)
{
    MeshlessOptions options = spec.meshless;
    options.total_volume = loaded.total_volume;
    try {
        return discretise(loaded.nodes, loaded.volume, options);
    } catch (const std::invalid_argument& error) { // sizes that leave the range of doubles
        throw InputError::in_file(file, spec.path + ": " + error.what());
    }
}

bool follows_clip(const Scene& scene, const SceneBody& body)
{
    return std::any_of(scene.effects.begin(), scene.effects.end(), [&](const SceneEffect& effect) {
        return effect.plan.follows_clip && effect.acts_on(body.name);
    });
}

Simulation::Body built(const Scene& scene, const SceneBody& spec, const std::string& file, MeshCache& meshes)
{
    LoadedBody loaded = load_body(spec, file, scene.decoders, meshes);
    MeshlessBody body = discretised(loaded, spec, file);
    std::vector<std::string> notes = loaded.notes;
    notes.insert(notes.end(), body.notes.begin(), body.notes.end());
    const std::size_t n = body.size();
    Field x(4 * n, 0), v(4 * n, 0);
    const Mat3 r =
        Eigen::AngleAxisd(spec.angle_deg * std::numbers::pi / 180, spec.axis.normalized()).toRotationMatrix();
    const bool clipped = follows_clip(scene, spec) && loaded.clip;
    const Vec3 origin = clipped ? Vec3::Zero() : spec.position;
    for (std::size_t i = 0; i < n; ++i) {
        at(x, i) = clipped ? loaded.clip(i, 0) : Vec3(r * body.rest[i]);
        at(v, i) = spec.velocity + spec.spin.cross(clipped ? Vec3(at(x, i) - spec.position) : Vec3(at(x, i)));
    }
    Simulation::Body made{spec.name, BodySimulation(std::move(body), std::move(loaded.surface)), std::move(notes)};
    BodyBuilder(scene, spec, file, loaded.clip, x, origin, made.simulation).build();
    if (clipped)
        made.simulation.place(x, v);
    else
        made.simulation.place(origin, r, v);
    return made;
}

std::vector<CouplingBuilder::Member> members_of(const SceneEffect& effect, std::vector<Simulation::Body>& bodies)
{
    std::vector<CouplingBuilder::Member> members;
    for (Simulation::Body& body : bodies)
        if (effect.acts_on(body.name))
            members.push_back({body.name, body.simulation});
    return members;
}

} // namespace

Simulation::Simulation(Scene scene, const std::string& file) : scene_(std::move(scene))
{
    MeshCache meshes;
    for (const SceneBody& spec : scene_.bodies)
        bodies_.push_back(built(scene_, spec, file, meshes));
    for (const SceneEffect& effect : scene_.effects)
        if (effect.plan.couple) {
            CouplingBuilder builder(members_of(effect, bodies_), effect, file);
            couplings_.push_back(effect.plan.couple(builder));
        }
}

std::size_t Simulation::frame_count() const
{
    return static_cast<std::size_t>(std::floor(scene_.duration_s / scene_.frame_s + 1e-9)) + 1;
}

std::vector<std::string> Simulation::notes() const
{
    std::vector<std::pair<std::string, std::size_t>> counted;
    for (const Body& body : bodies_)
        for (const std::string& note : body.notes) {
            const auto known =
                std::find_if(counted.begin(), counted.end(), [&](const auto& c) { return c.first == note; });
            if (known == counted.end())
                counted.emplace_back(note, 1);
            else
                ++known->second;
        }
    std::vector<std::string> lines;
    for (const auto& [note, count] : counted)
        lines.push_back(note + (count > 1 ? " (each of " + std::to_string(count) + " bodies)" : ""));
    return lines;
}

std::vector<StepReport> Simulation::advance()
{
    require_default_arithmetic();
    std::vector<BodyState> before;
    for (const Body& body : bodies_)
        before.push_back(body.simulation.state());
    auto take_back = [&] {
        for (std::size_t b = 0; b < bodies_.size(); ++b)
            bodies_[b].simulation.set_state(std::move(before[b]));
    };
    std::vector<StepReport> reports(bodies_.size());
    try {
        for (const auto& coupling : couplings_)
            coupling->find();
        parallel_blocks(bodies_.size(), 1, [&](std::size_t first, std::size_t last) {
            for (std::size_t b = first; b < last; ++b)
                reports[b] = bodies_[b].simulation.advance(scene_.frame_s, scene_.integration);
        });
    } catch (...) {
        take_back();
        throw;
    }
    if (std::any_of(reports.begin(), reports.end(), [](const StepReport& r) { return !r.failure.empty(); }))
        take_back();
    else
        ++frame_;
    return reports;
}

void Simulation::save(std::ostream& out) const
{
    write_raw<std::size_t>(out, {&frame_, 1});
    for (const Body& body : bodies_)
        body.simulation.save(out);
}

void Simulation::restore(std::istream& in)
{
    std::size_t frame = 0;
    read_raw<std::size_t>(in, {&frame, 1});
    std::vector<BodyState> states;
    for (const Body& body : bodies_) {
        states.push_back(body.simulation.state());
        states.back().restore(in);
    }
    if (!in)
        return;
    frame_ = frame;
    for (std::size_t b = 0; b < bodies_.size(); ++b)
        bodies_[b].simulation.set_state(std::move(states[b]));
}

} // namespace cinch
