// SPDX-License-Identifier: Apache-2.0
#include "cinch/simulate.hpp"

#include "toolkit/c/arrays.hpp"
#include "toolkit/c/call.hpp"
#include "toolkit/c/character.hpp"

namespace {

using namespace cinch;
using namespace cinch::c;

struct Scene {
    static constexpr Kind kind = Kind::simulation;
    using Handle = cinch_simulation;

    SceneSimulation simulation;
    std::atomic<bool> busy{false};

    explicit Scene(const std::filesystem::path& path) : simulation(path, decoders()) {}

    void require(std::size_t body) const
    {
        if (body >= simulation.body_count())
            throw std::invalid_argument("there is no body " + std::to_string(body) + " of " +
                                        std::to_string(simulation.body_count()));
    }
};

} // namespace

cinch_status cinch_simulation_read(const char* path, cinch_simulation** simulation)
{
    return call([&] {
        given(simulation, "simulation") = nullptr;
        *simulation = put(std::make_shared<Scene>(std::filesystem::path(&given(path, "path"))));
    });
}

cinch_status cinch_simulation_get_state(const cinch_simulation* simulation, cinch_simulation_state* state)
{
    return call([&] {
        const auto scene = get<Scene>(simulation);
        const InUse use(scene->busy, Kind::simulation);
        const SceneSimulation& s = scene->simulation;
        given(state, "state") = {s.body_count(), s.frame(), s.frame_count(), s.time_s()};
    });
}

cinch_status cinch_simulation_get_body(const cinch_simulation* simulation, size_t body, const char** name,
                                       cinch_surface** surface)
{
    return call([&] {
        given(surface, "surface") = nullptr;
        const auto scene = get<Scene>(simulation);
        const InUse use(scene->busy, Kind::simulation);
        scene->require(body);
        given(name, "name") = scene->simulation.name(body).c_str();
        const DeformableSurface* const there = scene->simulation.surface(body);
        if (!there)
            return;
        auto made = std::make_shared<Surface>();
        made->surface = std::shared_ptr<const DeformableSurface>(scene, there); // part of the scene
        made->targets = std::make_shared<const std::vector<MorphTarget>>();
        *surface = put(std::move(made));
    });
}

cinch_status cinch_simulation_advance(cinch_simulation* simulation)
{
    return call([&] {
        const auto scene = get<Scene>(simulation);
        const InUse use(scene->busy, Kind::simulation);
        scene->simulation.advance();
    });
}

cinch_status cinch_simulation_get_maps(const cinch_simulation* simulation, size_t body, double* maps, size_t capacity,
                                       size_t* count)
{
    return call([&] {
        const auto scene = get<Scene>(simulation);
        const InUse use(scene->busy, Kind::simulation);
        scene->require(body);
        write_list<AffineMap>(scene->simulation.transforms(body), maps, capacity, count);
    });
}
