// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <stdexcept>

#include <Eigen/Geometry>

#include "cinch/environment.hpp"
#include "cinch/surface.hpp"
#include "toolkit/deform/parallel.hpp"
#include "toolkit/simulate/load_body.hpp"
#include "toolkit/simulate/stream.hpp"

namespace cinch {
namespace {

// Adds the effects of a scene to one body.
class Builder {
public:
    /// `start`: where the nodes begin, seen from `origin`.
    Builder(const Scene& scene, const SceneBody& body, const std::string& file, const LoadedBody& loaded,
            const Field& start, const Vec3& origin, BodySimulation& out)
        : scene_(scene), body_(body), file_(file), loaded_(loaded), start_(start), origin_(origin), out_(out)
    {
    }
    void build()
    {
        for (const SceneEffect& effect : scene_.effects)
            if (is_mine(effect)) {
                path_ = effect.path;
                std::visit([&](const auto& spec) { add(spec); }, effect.what);
            }
    }

private:
    bool is_mine(const SceneEffect& effect) const
    {
        return effect.bodies.empty() ||
               std::find(effect.bodies.begin(), effect.bodies.end(), body_.name) != effect.bodies.end();
    }
    [[noreturn]] void complain(const std::string& what) const { throw InputError::in_file(file_, path_ + ": " + what); }
    std::vector<std::uint32_t> select(const NodeSelection& nodes) const
    {
        return select_nodes(nodes, out_.body().rest, file_, path_, body_.name);
    }
    std::vector<Vec3> starts(const std::vector<std::uint32_t>& nodes) const
    {
        std::vector<Vec3> places;
        for (const std::uint32_t i : nodes)
            places.push_back(at(start_, i));
        return places;
    }
    std::function<Vec3(std::size_t, double)> clip(const std::vector<std::uint32_t>& nodes) const
    {
        if (!loaded_.clip)
            complain("'clip' needs a body whose surface is an animated character; '" + body_.name + "' is none");
        return [nodes, path = loaded_.clip](std::size_t k, double t) { return path(nodes[k], t); };
    }
    double elastic_young() const
    {
        for (const SceneEffect& effect : scene_.effects)
            if (const auto* elastic = std::get_if<ElasticSpec>(&effect.what); elastic && is_mine(effect))
                return elastic->young;
        complain("needs 'young', or an effect 'elastic' on the same body");
    }
    Pin seen_from_origin(Pin made) const
    {
        made.origin = origin_;
        return made;
    }
    void pin(Pin made)
    {
        for (const std::uint32_t i : made.nodes) {
            if (std::find(pinned_.begin(), pinned_.end(), i) != pinned_.end())
                complain("simulation node " + std::to_string(i) + " of body '" + body_.name +
                         "' is pinned or scripted already");
            pinned_.push_back(i);
        }
        out_.add(std::move(made));
    }

    void add(const GravitySpec& s) { out_.add(make_gravity(s.acceleration)); }
    void add(const PullingForceSpec& s)
    {
        PullingForce pull = s.force;
        pull.nodes = select(s.nodes);
        out_.add(make_pulling(out_.body(), std::move(pull)));
    }
    void add(const PullingTargetSpec& s)
    {
        PullingTarget pull{select(s.nodes), s.stiffness, {}};
        if (s.clip) {
            pull.target = clip(pull.nodes);
        } else {
            pull.origin = origin_;
            pull.target = [places = starts(pull.nodes), s](std::size_t k, double t) {
                return Vec3(places[k] + (s.ramp_s > 0 ? std::min(1.0, t / s.ramp_s) : 1.0) * s.offset);
            };
        }
        out_.add(make_pulling(out_.body(), std::move(pull)));
    }
    void add(const ElasticSpec& s)
    {
        if (s.model == ElasticSpec::Model::neo_hookean)
            out_.add(make_neo_hookean(s.young, s.poisson));
        else
            out_.add(make_stvk(s.young, s.poisson, s.model == ElasticSpec::Model::stvk_paper));
    }
    void add(const VolumeSpec& s) { out_.add(make_volume(s.stiffness)); }
    void add(const HourglassSpec& s)
    {
        out_.add(make_hourglass(out_.body(), s.alpha, s.young > 0 ? s.young : elastic_young()));
    }
    void add(const PlasticitySpec& s) { out_.add(make_plasticity(s.flow)); }
    void add(const ViscositySpec& s) { out_.add(make_viscosity(s.viscosity)); }
    void add(const DampingSpec& s) { out_.add(make_mass_damping(s.rate)); }
    void add(const GroundSpec& s) { out_.add(make_ground(s.ground)); }
    void add(const ContactSpec&) {} // of several bodies, see search_contacts
    void add(const PinnedSpec& s)
    {
        std::vector<std::uint32_t> nodes = select(s.nodes);
        std::vector<Vec3> places = starts(nodes);
        pin(seen_from_origin(fixed_pin(std::move(nodes), std::move(places))));
    }
    void add(const ScriptedSpec& s)
    {
        std::vector<std::uint32_t> nodes = select(s.nodes);
        std::vector<Vec3> places = starts(nodes);
        if (s.clip) {
            auto path = clip(nodes);
            pin({std::move(nodes), std::move(path), [](double, double) { return 0.0; }, Vec3::Zero()});
        } else if (s.velocity.norm() > 0) {
            pin(seen_from_origin(sliding_pin(std::move(nodes), std::move(places), s.velocity, s.end_s)));
        } else {
            Turning turning = s.turning;
            turning.centre -= origin_;
            pin(seen_from_origin(turning_pin(std::move(nodes), std::move(places), turning)));
        }
    }

    const Scene& scene_;
    const SceneBody& body_;
    const std::string& file_;
    const LoadedBody& loaded_;
    const Field& start_;
    Vec3 origin_;
    BodySimulation& out_;
    std::string path_;
    std::vector<std::uint32_t> pinned_;
};

bool follows_clip(const Scene& scene, const SceneBody& body)
{
    for (const SceneEffect& effect : scene.effects) {
        const bool mine = effect.bodies.empty() ||
                          std::find(effect.bodies.begin(), effect.bodies.end(), body.name) != effect.bodies.end();
        const auto* pull = std::get_if<PullingTargetSpec>(&effect.what);
        const auto* script = std::get_if<ScriptedSpec>(&effect.what);
        if (mine && ((pull && pull->clip) || (script && script->clip)))
            return true;
    }
    return false;
}

std::unique_ptr<ContactSearch> search_contacts(const SceneEffect& effect, const ContactSpec& spec,
                                               std::vector<Simulation::Body>& bodies, const std::string& file)
{
    auto search = std::make_unique<ContactSearch>(spec.stiffness);
    std::size_t members = 0;
    for (Simulation::Body& body : bodies) {
        if (!effect.bodies.empty() &&
            std::find(effect.bodies.begin(), effect.bodies.end(), body.name) == effect.bodies.end())
            continue;
        if (!body.simulation.surface())
            throw InputError::in_file(file,
                                      effect.path + ": body '" + body.name + "' has no surface to touch others with");
        auto contact = std::make_unique<BodyContact>();
        search->add(body.simulation, *contact);
        body.simulation.add(std::move(contact));
        ++members;
    }
    if (members < 2)
        throw InputError::in_file(file, effect.path + ": needs at least two bodies");
    return search;
}

} // namespace

Simulation::Simulation(Scene scene, const std::string& file) : scene_(std::move(scene))
{
    MeshCache meshes;
    for (const SceneBody& spec : scene_.bodies) {
        LoadedBody loaded = load_body(spec, file, meshes);
        MeshlessBody body = [&] {
            try {
                return discretise(loaded.nodes, loaded.volume, spec.meshless);
            } catch (const std::invalid_argument& error) { // sizes that leave the range of doubles
                throw InputError::in_file(file, spec.path + ": " + error.what());
            }
        }();
        if (loaded.volume.empty() && loaded.total_volume > 0) {
            double sum = 0;
            for (const double v : body.volume)
                sum += v;
            for (std::size_t i = 0; i < body.size(); ++i) {
                body.volume[i] *= loaded.total_volume / sum;
                body.mass[i] = spec.meshless.density * body.volume[i];
            }
        }
        std::vector<std::string> notes = loaded.notes;
        notes.insert(notes.end(), body.notes.begin(), body.notes.end());
        const std::size_t n = body.size();
        Field x(4 * n, 0), v(4 * n, 0);
        const Mat3 r =
            Eigen::AngleAxisd(spec.angle_deg * std::numbers::pi / 180, spec.axis.normalized()).toRotationMatrix();
        const bool clipped = follows_clip(scene_, spec) && loaded.clip;
        const Vec3 origin = clipped ? Vec3::Zero() : spec.position;
        for (std::size_t i = 0; i < n; ++i) {
            at(x, i) = clipped ? loaded.clip(i, 0) : Vec3(r * body.rest[i]);
            at(v, i) = spec.velocity + spec.spin.cross(clipped ? Vec3(at(x, i) - spec.position) : Vec3(at(x, i)));
        }
        bodies_.push_back({spec.name, BodySimulation(std::move(body), loaded.surface), std::move(notes)});
        BodySimulation& made = bodies_.back().simulation;
        Builder(scene_, spec, file, loaded, x, origin, made).build();
        if (clipped)
            made.place(x, v);
        else
            made.place(origin, r, v);
    }
    for (const SceneEffect& effect : scene_.effects)
        if (const auto* spec = std::get_if<ContactSpec>(&effect.what))
            contacts_.push_back(search_contacts(effect, *spec, bodies_, file));
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
    std::vector<std::string> before(bodies_.size());
    std::vector<StepReport> reports(bodies_.size());
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
        std::ostringstream state;
        bodies_[b].simulation.save(state);
        before[b] = std::move(state).str();
    }
    for (const auto& search : contacts_)
        search->find();
    parallel_blocks(bodies_.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t b = first; b < last; ++b)
            reports[b] = bodies_[b].simulation.advance(scene_.frame_s, scene_.integration);
    });
    if (std::any_of(reports.begin(), reports.end(), [](const StepReport& r) { return !r.failure.empty(); })) {
        for (std::size_t b = 0; b < bodies_.size(); ++b) {
            std::istringstream state(before[b]);
            bodies_[b].simulation.restore(state);
        }
        return reports;
    }
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
    read_raw<std::size_t>(in, {&frame_, 1});
    for (Body& body : bodies_)
        body.simulation.restore(in);
}

} // namespace cinch
