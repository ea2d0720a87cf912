// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <functional>
#include <limits>

#include "toolkit/simulate/json_fields.hpp"
#include "toolkit/simulate/scene.hpp"

namespace cinch {
namespace {

using Json = nlohmann::json;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr const char* name_characters =
    "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_."; // also of file names
constexpr std::size_t most_nodes = 20000;                                // of a body
constexpr JsonFields::Range length{1e-30, 1e30, false, "a number from 1e-30 to 1e30 (m)"};
constexpr JsonFields::Range interval{1e-30, 1e30, false, "a number from 1e-30 to 1e30 (s)"};

NodeSelection read_nodes(JsonFields& parent, const std::string& key)
{
    const Json* json = parent.find(key);
    if (!json || *json == "all")
        return EveryNode{};
    JsonFields f(*json, parent.file(), parent.place(key));
    NodeSelection selection;
    if (f.has("box")) {
        const Json& box = f.need("box");
        if (!box.is_array() || box.size() != 2)
            f.fail("box", "two corners", box);
        selection = NodesInBox{f.vector_of("box/0", box[0]), f.vector_of("box/1", box[1])};
    } else if (f.has("centre")) {
        const Vec3 centre = f.vector("centre");
        selection = NodesInBall{centre, f.number("radius", JsonFields::positive())};
    } else if (f.has("index")) {
        NodesByIndex nodes;
        const Json& all = f.array("index");
        for (std::size_t i = 0; i < all.size(); ++i)
            nodes.index.push_back(
                static_cast<std::uint32_t>(f.count_of("index/" + std::to_string(i), all[i], 0, 1u << 30)));
        selection = nodes;
    } else if (f.has("nearest")) {
        const Vec3 point = f.vector("nearest");
        selection = NearestNodes{point, f.count("count", 1, 1u << 30, 1)};
    } else {
        f.complain("", "expected \"all\", or an object with box, centre and radius, index, or nearest");
    }
    f.finish();
    return selection;
}

Turning read_turning(JsonFields& f)
{
    Turning t;
    t.axis = f.direction("axis");
    t.centre = f.vector("centre", Vec3::Zero());
    if (f.has("period")) {
        t.period_s = f.number("period", interval);
        t.most = f.number("swing", JsonFields::any());
    } else {
        t.rate = f.number("rate", JsonFields::any());
        t.ramp_s = f.number("ramp", JsonFields::not_negative(), 0);
        t.most = f.number("until", JsonFields::not_negative(), 0);
    }
    return t;
}

using What = decltype(SceneEffect::what);
struct Kind {
    const char* name;
    What (*read)(JsonFields&);
};

What read_gravity(JsonFields& f) { return GravitySpec{f.vector("acceleration", Vec3(0, 0, -9.81))}; }

What read_pulling(JsonFields& f)
{
    const NodeSelection nodes = read_nodes(f, "nodes");
    if (!f.has("stiffness")) {
        PullingForce pull;
        pull.force = f.vector("force");
        pull.start_s = f.number("start", JsonFields::not_negative(), 0);
        pull.end_s = f.number("end", JsonFields::not_negative(), infinity);
        pull.period_s = f.number("period", JsonFields::positive(), 0);
        return PullingForceSpec{nodes, pull};
    }
    PullingTargetSpec pull;
    pull.nodes = nodes;
    pull.stiffness = f.number("stiffness", JsonFields::not_negative());
    pull.clip = f.flag("clip", false);
    if (!pull.clip) {
        pull.offset = f.vector("offset");
        pull.ramp_s = f.number("ramp", JsonFields::not_negative(), 0);
    }
    return pull;
}

What read_elastic(JsonFields& f)
{
    ElasticSpec elastic;
    const std::string model = f.text("model", "neo-hookean");
    if (model == "stvk")
        elastic.model = ElasticSpec::Model::stvk;
    else if (model == "stvk-paper")
        elastic.model = ElasticSpec::Model::stvk_paper;
    else if (model != "neo-hookean")
        f.complain("model", "'" + model + "' is unknown; known are neo-hookean, stvk, stvk-paper");
    elastic.young = f.number("young", JsonFields::positive());
    elastic.poisson = f.number("poisson", {-1, 0.5, true, "a number above -1 and below 0.5"}, 0.3);
    if (elastic.poisson == 0.5)
        f.complain("poisson", "must lie below 0.5; add the effect 'volume' for what hardly changes its volume");
    return elastic;
}

What read_volume(JsonFields& f) { return VolumeSpec{f.number("stiffness", JsonFields::not_negative())}; }

What read_hourglass(JsonFields& f)
{
    HourglassSpec hourglass;
    hourglass.alpha = f.number("alpha", JsonFields::not_negative(), 1);
    hourglass.young = f.number("young", JsonFields::positive(), 0);
    return hourglass;
}

What read_plasticity(JsonFields& f)
{
    PlasticFlow flow;
    flow.yield = f.number("yield", JsonFields::not_negative());
    flow.creep = f.number("creep", JsonFields::not_negative());
    flow.most = f.number("most", JsonFields::not_negative(), 1);
    return PlasticitySpec{flow};
}

What read_viscosity(JsonFields& f) { return ViscositySpec{f.number("viscosity", JsonFields::not_negative())}; }
What read_damping(JsonFields& f) { return DampingSpec{f.number("rate", JsonFields::not_negative())}; }

What read_ground(JsonFields& f)
{
    Ground ground;
    ground.point = f.vector("point", Vec3::Zero());
    ground.normal = f.has("normal") ? f.direction("normal") : Vec3::UnitZ();
    ground.stiffness = f.number("stiffness", JsonFields::not_negative());
    ground.friction = f.number("friction", JsonFields::not_negative(), 0);
    const std::string at = f.text("at", "surface");
    if (at != "surface" && at != "nodes")
        f.complain("at", "'" + at + "' is unknown; known are surface, nodes");
    ground.at_nodes = at == "nodes";
    return GroundSpec{ground};
}

What read_contact(JsonFields& f) { return ContactSpec{f.number("stiffness", JsonFields::positive())}; }

What read_pinned(JsonFields& f) { return PinnedSpec{read_nodes(f, "nodes")}; }

What read_scripted(JsonFields& f)
{
    ScriptedSpec scripted;
    scripted.nodes = read_nodes(f, "nodes");
    scripted.clip = f.flag("clip", false);
    if (scripted.clip)
        return scripted;
    if (f.has("velocity")) {
        scripted.velocity = f.vector("velocity");
        scripted.end_s = f.number("end", JsonFields::not_negative(), infinity);
    } else {
        scripted.turning = read_turning(f);
    }
    return scripted;
}

constexpr Kind kinds[] = {
    {"gravity", read_gravity},     {"pulling", read_pulling},     {"elastic", read_elastic},
    {"volume", read_volume},       {"hourglass", read_hourglass}, {"plasticity", read_plasticity},
    {"viscosity", read_viscosity}, {"damping", read_damping},     {"ground", read_ground},
    {"contact", read_contact},     {"pinned", read_pinned},       {"scripted", read_scripted},
};

std::array<int, 3> read_cells(JsonFields& f, const std::string& key)
{
    const Json& json = f.array(key);
    if (json.size() != 3)
        f.fail(key, "an array of 3 whole numbers", json);
    std::array<int, 3> cells{};
    for (std::size_t i = 0; i < 3; ++i)
        cells[i] = static_cast<int>(f.count_of(key + "/" + std::to_string(i), json[i], 1, 1000));
    return cells;
}

SceneBody read_body(const Json& json, const std::string& file, const std::string& folder, std::size_t index)
{
    SceneBody body;
    body.path = "/bodies/" + std::to_string(index);
    JsonFields f(json, file, body.path);
    body.name = f.text("name", "body-" + std::to_string(index));
    if (body.name.empty() || body.name.size() > 64 || body.name[0] == '.' ||
        body.name.find_first_not_of(name_characters) != std::string::npos)
        f.complain("name", "must be 1 to 64 letters, digits, '-', '_' or '.', not beginning with '.'");
    body.surface = f.text("surface");
    if (std::filesystem::path(body.surface).has_extension() && std::filesystem::path(body.surface).is_relative())
        body.surface = (std::filesystem::path(folder) / body.surface).string();
    if (body.surface == "box" || body.surface == "sheet") {
        body.box_m = f.vector("box");
        for (int r = 0; r < 3; ++r)
            if (!(r == 2 && body.surface == "sheet" && body.box_m[r] == 0))
                f.number_of("box/" + std::to_string(r), f.need("box")[static_cast<std::size_t>(r)], length);
        body.cells = read_cells(f, "cells");
        if (double(body.cells[0]) * body.cells[1] + double(body.cells[1]) * body.cells[2] +
                double(body.cells[2]) * body.cells[0] >
            1e6)
            f.complain("cells", "makes more than four million triangles");
        if (body.surface == "sheet")
            body.thickness_m = f.number("thickness", length);
    } else {
        body.size_m = f.number("size", length, 0);
    }
    const int ways = f.has("nodes") + f.has("lattice") + f.has("places");
    if (ways != 1)
        f.complain("", "needs one of nodes (how many), lattice (cells of a box) and places (positions)");
    if (f.has("lattice")) {
        if (body.surface != "box" && body.surface != "sheet")
            f.complain("lattice", "needs the surface box or sheet");
        body.lattice = read_cells(f, "lattice");
        if (double(body.lattice[0]) * body.lattice[1] * body.lattice[2] > most_nodes)
            f.complain("lattice", "makes more than 20,000 simulation nodes");
    } else if (f.has("places")) {
        const Json& places = f.array("places");
        if (places.empty() || places.size() > most_nodes)
            f.complain("places", "must have 1 to 20,000 of them");
        for (std::size_t i = 0; i < places.size(); ++i)
            body.places.push_back(f.vector_of("places/" + std::to_string(i), places[i]));
    } else {
        body.nodes = f.count("nodes", 1, most_nodes);
    }
    body.seed = f.count("seed", 0, std::size_t(1) << 53, 0);
    body.meshless.density = f.number("density", JsonFields::positive(), 1000);
    body.meshless.support_factor = f.number("support", JsonFields::positive(), MeshlessOptions().support_factor);
    body.meshless.support_radius = f.number("support_radius", JsonFields::positive(), 0);
    body.meshless.nearest = static_cast<int>(f.count("nearest", 1, 1000, 10));
    const std::string volumes = f.text("volumes", "cells");
    if (volumes != "cells" && volumes != "density")
        f.complain("volumes", "'" + volumes + "' is unknown; known are cells, density");
    body.volume_by_density = volumes == "density";
    body.position = f.vector("position", Vec3::Zero());
    body.velocity = f.vector("velocity", Vec3::Zero());
    body.spin = f.vector("spin", Vec3::Zero());
    if (const Json* rotation = f.find("rotation")) {
        JsonFields r(*rotation, file, f.place("rotation"));
        body.axis = r.direction("axis");
        body.angle_deg = r.number("degrees", JsonFields::any());
        r.finish();
    }
    body.clip = f.text("clip", "");
    f.finish();
    return body;
}

Integration read_integration(JsonFields& scene, double frame_s)
{
    Integration integration;
    integration.step_s = frame_s;
    const Json* json = scene.find("integrator");
    if (!json)
        return integration;
    JsonFields f(*json, scene.file(), scene.place("integrator"));
    const std::string method = f.text("method", "implicit");
    if (method != "implicit" && method != "explicit")
        f.complain("method", "'" + method + "' is unknown; known are implicit, explicit");
    integration.method =
        method == "explicit" ? Integration::Method::explicit_euler : Integration::Method::implicit_euler;
    integration.step_s = f.number("step", interval, integration.step_s);
    if (method == "explicit") {
        integration.safety = f.number("safety", {0, 1, true, "a number above 0 and at most 1"}, integration.safety);
    } else {
        integration.tolerance = f.number("tolerance", JsonFields::positive(), integration.tolerance);
        integration.most_iterations =
            static_cast<int>(f.count("iterations", 1, 100000, static_cast<std::size_t>(integration.most_iterations)));
    }
    f.finish();
    return integration;
}

} // namespace

std::vector<std::string> effect_names()
{
    std::vector<std::string> names;
    for (const Kind& kind : kinds)
        names.emplace_back(kind.name);
    return names;
}

namespace {

// Keeps hostile nesting off the stack, and says which key stands twice: the parser would take the last one.
class Strict {
public:
    explicit Strict(std::string file) : file_(std::move(file)) {}

    bool operator()(int depth, Json::parse_event_t event, Json& parsed)
    {
        if (depth > 32)
            throw InputError::in_file(file_, "is nested more than 32 deep");
        if (event == Json::parse_event_t::object_start)
            keys_.emplace_back();
        else if (event == Json::parse_event_t::object_end)
            keys_.pop_back();
        else if (event == Json::parse_event_t::key && !keys_.back().insert(parsed.get<std::string>()).second)
            throw InputError::in_file(
                file_, JsonFields::printable("the key '" + parsed.get<std::string>() + "' stands twice in one object"));
        return true;
    }

private:
    std::string file_;
    std::vector<std::set<std::string>> keys_;
};

} // namespace

Scene parse_scene(std::string_view text, const std::string& file, const std::string& folder)
{
    Json json;
    try {
        json = Json::parse(text, Strict(file));
    } catch (const Json::parse_error& error) {
        std::size_t line = 1;
        for (std::size_t i = 0; i + 1 < error.byte && i < text.size(); ++i)
            line += text[i] == '\n';
        throw InputError::at_line(file, line, "is no JSON from here on");
    } catch (const Json::out_of_range&) {
        throw InputError::in_file(file, "has a number that no double can hold");
    }
    JsonFields f(json, file, "");
    Scene scene;
    f.text("$schema", "");
    scene.name = f.text("name", std::filesystem::path(file).stem().string());
    scene.about = f.text("about", "");
    scene.duration_s = f.number("duration", JsonFields::not_negative());
    scene.frame_s = f.number("frame", interval, 1.0 / 60);
    if (scene.duration_s / scene.frame_s > 1e6)
        f.complain("duration", "makes more than a million frames");
    scene.integration = read_integration(f, scene.frame_s);

    const Json& bodies = f.array("bodies");
    if (bodies.empty())
        f.complain("bodies", "is empty");
    std::set<std::string> names;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        scene.bodies.push_back(read_body(bodies[i], file, folder, i));
        if (!names.insert(scene.bodies.back().name).second)
            f.complain("bodies/" + std::to_string(i) + "/name", "'" + scene.bodies.back().name + "' stands twice");
    }
    const Json& effects = f.array("effects");
    for (std::size_t i = 0; i < effects.size(); ++i) {
        SceneEffect effect;
        effect.path = "/effects/" + std::to_string(i);
        JsonFields e(effects[i], file, effect.path);
        const std::string name = e.text("effect");
        const Json* chosen = e.find("bodies");
        const Kind* kind = nullptr;
        for (const Kind& k : kinds)
            if (name == k.name)
                kind = &k;
        if (!kind) {
            std::string known;
            for (const Kind& k : kinds)
                known += (known.empty() ? "" : ", ") + std::string(k.name);
            e.complain("effect", "'" + name + "' is unknown; known are " + known);
        }
        effect.what = kind->read(e);
        if (chosen && (!chosen->is_array() || chosen->empty()))
            e.fail("bodies", "names of bodies", *chosen);
        for (std::size_t b = 0; chosen && b < chosen->size(); ++b) {
            const std::string place = "bodies/" + std::to_string(b);
            if (!(*chosen)[b].is_string())
                e.fail(place, "the name of a body", (*chosen)[b]);
            effect.bodies.push_back((*chosen)[b].get<std::string>());
            if (!names.count(effect.bodies.back()))
                e.complain(place, "there is no body '" + effect.bodies.back() + "'");
        }
        e.finish();
        scene.effects.push_back(std::move(effect));
    }
    f.finish();
    return scene;
}

} // namespace cinch
