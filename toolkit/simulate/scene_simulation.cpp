// SPDX-License-Identifier: Apache-2.0
#include "cinch/simulate.hpp"

#include <stdexcept>

#include "toolkit/simulate/simulation.hpp"
#include "toolkit/surface/read_mesh.hpp"

namespace cinch {
namespace {

// An OwnForce among the effects.
class Own : public Effect {
public:
    explicit Own(std::unique_ptr<const OwnForce> force) : Effect("own force"), force_(std::move(force)) {}

    double energy(const Configuration& c) const override { return force_->energy(Seen(c).nodes); }
    void add_forces(const Configuration& c, Forces out) const override
    {
        std::vector<Vec3> force(c.body.size(), Vec3::Zero());
        force_->add(Seen(c).nodes, force);
        for (std::size_t i = 0; i < force.size(); ++i)
            at(out.force, i) += force[i];
    }

private:
    struct Seen {
        std::vector<Vec3> position;
        OwnForce::Nodes nodes;

        explicit Seen(const Configuration& c)
        {
            for (std::size_t i = 0; i < c.body.size(); ++i)
                position.push_back(c.reference.origin + Vec3(at(c.x, i)));
            nodes = {position, c.body.mass, c.time_s};
        }
    };

    std::unique_ptr<const OwnForce> force_;
};

} // namespace

struct SceneSimulation::Parts {
    Simulation simulation;

    explicit Parts(Scene&& scene, const std::string& name) : simulation(std::move(scene), name) {}
};

SceneSimulation::SceneSimulation(const std::filesystem::path& scene, const Decompression* decoders)
    : SceneSimulation(read_bytes(scene), scene.string(), scene.parent_path(), decoders)
{
}
SceneSimulation::SceneSimulation(std::string_view json, const std::string& name, const std::filesystem::path& folder,
                                 const Decompression* decoders)
{
    Scene scene = parse_scene(json, name, folder.string());
    scene.decoders = decoders;
    parts_ = std::make_unique<Parts>(std::move(scene), name);
}
SceneSimulation::~SceneSimulation() = default;
SceneSimulation::SceneSimulation(SceneSimulation&&) noexcept = default;
SceneSimulation& SceneSimulation::operator=(SceneSimulation&&) noexcept = default;

std::size_t SceneSimulation::body_count() const { return parts_->simulation.bodies().size(); }
const std::string& SceneSimulation::name(std::size_t body) const { return parts_->simulation.bodies().at(body).name; }
const DeformableSurface* SceneSimulation::surface(std::size_t body) const
{
    const auto& surface = parts_->simulation.bodies().at(body).simulation.surface();
    return surface ? &*surface : nullptr;
}
void SceneSimulation::add(std::size_t body, std::unique_ptr<const OwnForce> force)
{
    parts_->simulation.bodies().at(body).simulation.add(std::make_unique<Own>(std::move(force)));
}
std::size_t SceneSimulation::frame() const { return parts_->simulation.frame(); }
std::size_t SceneSimulation::frame_count() const { return parts_->simulation.frame_count(); }
double SceneSimulation::time_s() const { return parts_->simulation.time_s(); }

void SceneSimulation::advance()
{
    const std::vector<StepReport> reports = parts_->simulation.advance();
    for (std::size_t b = 0; b < reports.size(); ++b)
        if (!reports[b].failure.empty())
            throw std::runtime_error(std::to_string(time_s()) + " s, body '" + name(b) + "': " + reports[b].failure);
}

std::vector<AffineMap> SceneSimulation::transforms(std::size_t body) const
{
    return parts_->simulation.bodies().at(body).simulation.frame();
}

} // namespace cinch
