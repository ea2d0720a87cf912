// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/read_scene.hpp"

#include <filesystem>

#include <nlohmann/json.hpp>

namespace cinch {

std::vector<std::string> effect_names()
{
    std::vector<std::string> names;
    for (const EffectKind* kind : effect_kinds())
        names.emplace_back(kind->name);
    return names;
}

namespace {

using Json = JsonFields::Json;

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

const EffectKind& kind_of(const JsonFields& fields, const std::string& name)
{
    std::string known;
    for (const EffectKind* kind : effect_kinds()) {
        if (name == kind->name)
            return *kind;
        known += (known.empty() ? "" : ", ") + std::string(kind->name);
    }
    fields.complain("effect", "'" + name + "' is unknown; known are " + known);
}

SceneEffect read_effect(const Json& json, const std::string& file, const std::string& path,
                        const std::set<std::string>& bodies)
{
    JsonFields f(json, file, path);
    const std::string name = f.text("effect");
    const Json* chosen = f.find("bodies");
    SceneEffect effect;
    effect.path = path;
    effect.kind = &kind_of(f, name);
    effect.plan = effect.kind->read(f);
    if (chosen && (!chosen->is_array() || chosen->empty()))
        f.fail("bodies", "names of bodies", *chosen);
    for (std::size_t b = 0; chosen && b < chosen->size(); ++b) {
        const std::string place = "bodies/" + std::to_string(b);
        if (!(*chosen)[b].is_string())
            f.fail(place, "the name of a body", (*chosen)[b]);
        effect.bodies.push_back((*chosen)[b].get<std::string>());
        if (!bodies.count(effect.bodies.back()))
            f.complain(place, "there is no body '" + effect.bodies.back() + "'");
    }
    f.finish();
    return effect;
}

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
    scene.frame_s = f.number("frame", JsonFields::interval(), 1.0 / 60);
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
    for (std::size_t i = 0; i < effects.size(); ++i)
        scene.effects.push_back(read_effect(effects[i], file, "/effects/" + std::to_string(i), names));
    f.finish();
    return scene;
}

} // namespace cinch
