// SPDX-License-Identifier: Apache-2.0
// A glTF 2.0 file as a character. The order of the work: what the file requires, the scene, skins, meshes,
// animations.
#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "cinch/environment.hpp"
#include "toolkit/surface/character.hpp"
#include "toolkit/surface/gltf_accessor.hpp"
#include "toolkit/surface/gltf_animation.hpp"
#include "toolkit/surface/gltf_compression.hpp"
#include "toolkit/surface/gltf_morph.hpp"
#include "toolkit/surface/gltf_scene.hpp"
#include "toolkit/surface/read_mesh.hpp"
#include "toolkit/surface/text_scan.hpp"

namespace cinch {
namespace {

enum Mode : std::size_t { points, lines, line_loop, line_strip, triangles, triangle_strip, triangle_fan };

std::vector<Triangle> triangles_of(const std::vector<std::uint32_t>& order, std::size_t mode)
{
    std::vector<Triangle> out;
    if (mode == triangles)
        for (std::size_t i = 0; i + 2 < order.size(); i += 3)
            out.push_back({order[i], order[i + 1], order[i + 2]});
    else if (mode == triangle_strip)
        for (std::size_t i = 2; i < order.size(); ++i)
            out.push_back({order[i - 2 + i % 2], order[i - 1 - i % 2], order[i]});
    else
        for (std::size_t i = 2; i < order.size(); ++i)
            out.push_back({order[0], order[i - 1], order[i]});
    return out;
}

bool is_drawn(const GltfValue& primitive)
{
    return primitive["attributes"].has("POSITION");
} // the specification: else there is nothing to draw

// Of all that a scene draws: a few bytes of instances make millions of them.
constexpr std::size_t most_triangles = 100'000'000;

class SurfaceReader {
public:
    SurfaceReader(GltfDocument& document, GltfSkeleton& skeleton, Morphs with_morphs, Missing& missing, Character& out)
        : document_(document), skeleton_(skeleton), with_morphs_(with_morphs), missing_(missing), out_(out)
    {
    }

    std::vector<GltfMorph> morphs;
    // The mesh that a node draws; its skin's joints are there already.
    void add(std::size_t node_index)
    {
        const GltfValue node = document_.at("nodes", node_index), mesh = document_.at("meshes", node["mesh"].index()),
                        primitives = mesh["primitives"];
        const auto skin = node.index_of("skin");
        note_extensions(mesh, missing_);
        bool drawn = false;
        for (std::size_t p = 0; p < primitives.size(); ++p) {
            note_compressed(document_, primitives[p], missing_);
            for (const std::string& name : primitives[p]["attributes"].keys())
                if (!is_known_attribute(name))
                    missing_.add("the attribute '" + printable(name) + "'", primitives[p].place());
            drawn |= is_drawn(primitives[p]);
            without_position_ += !is_drawn(primitives[p]);
        }
        if (!drawn)
            return;
        const auto extensions = node.find("extensions");
        const bool is_instanced = extensions && extensions->has(instancing);
        if (is_instanced && (skin || !(*extensions)[instancing].has("attributes"))) { // a skin knows no such places
            missing_.add(std::string("the extension ") + instancing, node.named());
            return;
        }
        GltfMorph morph = read_morph(node, node_index, mesh);
        const bool morphs_apart = with_morphs_ == Morphs::read && morph.targets > 0;
        if (skin && !placed_.insert({morph.mesh, *skin, morphs_apart ? node_index : 0}).second)
            return; // at the same place again: the node's own transform does not count
        first_target_ = morph.first_target = static_cast<std::uint32_t>(out_.targets.size());
        if (morphs_apart) {
            out_.targets.resize(out_.targets.size() + morph.targets);
            morph.weights.resize(morph.targets, 0);
            out_.target_weights.insert(out_.target_weights.end(), morph.weights.begin(), morph.weights.end());
        }
        if (morph.targets > 0)
            morphs.push_back(morph);
        std::vector<Carrier> carriers;
        if (skin)
            carriers.push_back({skin, 0});
        else if (!is_instanced)
            carriers.push_back({{}, skeleton_.carrier(node_index)});
        else
            for (const std::uint32_t joint : skeleton_.instances(node_index))
                carriers.push_back({{}, joint});
        out_.carried += skin ? 0 : carriers.size();
        for (const Carrier& carrier : carriers)
            for (std::size_t p = 0; p < primitives.size(); ++p)
                if (is_drawn(primitives[p]))
                    add_primitive(primitives[p], carrier);
    }

    void finish()
    {
        if (out_.carried && !out_.joints.empty() && out_.carried < out_.joints.size())
            out_.notes.push_back(std::to_string(out_.carried) + (out_.carried == 1 ? " part" : " parts") +
                                 " without a skin, carried by " + (out_.carried == 1 ? "a node" : "nodes"));
        if (without_position_)
            out_.notes.push_back(std::to_string(without_position_) +
                                 (without_position_ == 1 ? " primitive" : " primitives") +
                                 " without positions left out: nothing to draw");
    }

private:
    using Row = std::vector<std::pair<std::uint32_t, double>>; // simulation nodes with weights
    // What moves a mesh: a skin, or a joint of its own.
    struct Carrier {
        std::optional<std::size_t> skin;
        std::uint32_t joint;
    };

    [[noreturn]] void fail(const std::string& reason) const { throw InputError::in_file(document_.file(), reason); }

    std::vector<std::uint32_t> vertex_order(const GltfValue& primitive, std::size_t vertices)
    {
        std::vector<std::uint32_t> order;
        const auto indices = primitive.index_of("indices");
        if (!indices) {
            for (std::size_t i = 0; i < vertices; ++i)
                order.push_back(static_cast<std::uint32_t>(i));
            return order;
        }
        for (const double index : read_accessor(document_, *indices, 1, missing_)) {
            if (!(index >= 0 && index < static_cast<double>(vertices)))
                fail("vertex index " + std::to_string(static_cast<std::int64_t>(index)) + " is out of range; " +
                     primitive.place() + " has " + std::to_string(vertices) + " vertices");
            order.push_back(static_cast<std::uint32_t>(index));
        }
        return order;
    }

    void add_primitive(const GltfValue& primitive, const Carrier& carrier)
    {
        const std::size_t mode = primitive.index_or("mode", triangles);
        if (mode > triangle_fan)
            primitive.fail("has the unknown mode " + std::to_string(mode));
        if (mode < triangles) { // drawn and deformed, but no surface
            missing_.add(mode == points ? "points" : "lines", primitive.place());
            return;
        }
        const GltfValue attributes = primitive["attributes"];
        std::vector<std::vector<double>> joints, weights;
        const std::optional<DecodedPrimitive> unpacked = decoded_primitive(document_, primitive);
        auto numbers = [&](const std::string& name, std::size_t components) {
            if (unpacked)
                if (const auto found = unpacked->attribute.find(name); found != unpacked->attribute.end())
                    return found->second;
            return read_accessor(document_, attributes[name.c_str()].index(), components, missing_);
        };
        const std::vector<double> positions = numbers("POSITION", 3);
        const std::size_t vertices = positions.size() / 3;
        std::size_t sets = 0;
        if (carrier.skin)
            for (const std::string& name : attributes.keys())
                sets += name.starts_with("JOINTS_") || name.starts_with("WEIGHTS_");
        if (carrier.skin && sets == 0) {
            missing_.add("a part of a skinned mesh without joints and weights", primitive.place());
            return;
        }
        for (std::size_t set = 0; 2 * set < sets; ++set) {
            const std::string w = "WEIGHTS_" + std::to_string(set);
            joints.push_back(numbers("JOINTS_" + std::to_string(set), 4));
            weights.push_back(numbers(w, 4));
            out_.influences.step =
                std::max(out_.influences.step, step_of_accessor(document_, attributes[w.c_str()].index()));
            if (joints.back().size() != 4 * vertices || weights.back().size() != 4 * vertices)
                primitive.fail("has " + std::to_string(vertices) +
                               " positions but another number of joints or weights");
        }
        std::vector<Displacements> displaced(vertices);
        if (with_morphs_ == Morphs::read)
            displaced = read_displacements(document_, primitive, vertices, first_target_, missing_);
        std::vector<std::uint32_t> vertex_of(vertices);
        for (std::size_t k = 0; k < vertices; ++k)
            vertex_of[k] = weld(&positions[3 * k],
                                carrier.skin ? influences_of(primitive, k, joints, weights, *carrier.skin)
                                             : Row{{carrier.joint, 1}},
                                displaced[k]);
        const std::vector<Triangle> triangles =
            triangles_of(unpacked ? unpacked->indices : vertex_order(primitive, vertices), mode);
        if (out_.mesh.triangles.size() + triangles.size() > most_triangles)
            primitive.fail("is drawn so often that the scene has more than " + std::to_string(most_triangles) +
                           " triangles");
        for (const Triangle& t : triangles)
            out_.mesh.triangles.push_back({vertex_of[t[0]], vertex_of[t[1]], vertex_of[t[2]]});
    }

    Row influences_of(const GltfValue& primitive, std::size_t k, const std::vector<std::vector<double>>& joints,
                      const std::vector<std::vector<double>>& weights, std::size_t skin)
    {
        const std::uint32_t first = skeleton_.first_joint(skin), count = skeleton_.joint_count(skin);
        std::map<std::uint32_t, double> sum; // a joint may be named twice; zero-weight slots are padding
        for (std::size_t set = 0; set < joints.size(); ++set)
            for (std::size_t i = 4 * k; i < 4 * k + 4; ++i) {
                const double weight = weights[set][i];
                if (weight < 0)
                    primitive.fail("has a negative weight, of vertex " + std::to_string(k));
                if (weight == 0)
                    continue;
                if (!(joints[set][i] >= 0 && joints[set][i] < count))
                    fail("vertex " + std::to_string(k) + " of " + primitive.place() + " names joint " +
                         std::to_string(static_cast<std::int64_t>(joints[set][i])) + "; skin " + std::to_string(skin) +
                         " has " + std::to_string(count));
                sum[first + static_cast<std::uint32_t>(joints[set][i])] += weight;
            }
        if (sum.empty()) // bound to nothing; the first joint named keeps it in place, and the load report counts it
            sum[first + static_cast<std::uint32_t>(std::clamp(joints[0][4 * k], 0.0, static_cast<double>(count - 1)))] =
                0;
        return {sum.begin(), sum.end()};
    }

    std::uint32_t weld(const double* point, const Row& influences, const Displacements& displaced)
    {
        const std::array<double, 3> key{point[0] + 0.0, point[1] + 0.0, point[2] + 0.0}; // -0 and 0 are one place
        const auto [it, is_new] =
            welded_.try_emplace({key, influences, displaced}, static_cast<std::uint32_t>(out_.mesh.vertices.size()));
        if (is_new) {
            out_.mesh.vertices.emplace_back(key[0], key[1], key[2]);
            for (const auto& [node, weight] : influences) {
                out_.influences.node.push_back(node);
                out_.influences.weight.push_back(weight);
            }
            out_.influences.row.push_back(static_cast<std::uint32_t>(out_.influences.node.size()));
            for (const auto& [target, d] : displaced) {
                out_.targets[target].vertex.push_back(it->second);
                out_.targets[target].displacement.emplace_back(d[0], d[1], d[2]);
            }
        }
        return it->second;
    }

    GltfDocument& document_;
    GltfSkeleton& skeleton_;
    Morphs with_morphs_;
    Missing& missing_;
    Character& out_;
    // Meshes with the skins that deform them, and where they have morph targets the nodes, whose weights may differ.
    std::set<std::tuple<std::size_t, std::size_t, std::size_t>> placed_;
    std::map<std::tuple<std::array<double, 3>, Row, Displacements>, std::uint32_t> welded_;
    std::uint32_t first_target_ = 0; // of the mesh that is being read
    std::size_t without_position_ = 0;
};

void read(GltfDocument& document, Morphs with_morphs, Missing& missing, Character& out)
{
    note_extensions_of_file(document, missing);
    const GltfScene scene = read_scene(document, missing, out.notes);
    GltfSkeleton skeleton(document, scene, missing, out);
    std::set<std::size_t> drawn, skins; // in the order of the file
    std::size_t hidden = 0;
    for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
        const GltfValue node = document.at("nodes", scene.nodes[i]);
        if (!node.has("mesh"))
            continue;
        hidden += !scene.visible[i];
        if (!scene.visible[i])
            continue;
        drawn.insert(scene.nodes[i]);
        if (const auto skin = node.index_of("skin"))
            skins.insert(*skin);
    }
    if (hidden)
        out.notes.push_back(std::to_string(hidden) + (hidden == 1 ? " hidden mesh" : " hidden meshes") + " left out");
    if (drawn.empty())
        throw InputError::in_file(out.file, "draws no mesh that a skin deforms or a node carries in its default scene");
    for (const std::size_t skin : skins)
        skeleton.first_joint(skin);
    SurfaceReader surface(document, skeleton, with_morphs, missing, out);
    for (const std::size_t node : drawn)
        surface.add(node);
    surface.finish();
    out.skins = skins.size();
    read_animations(document, skeleton, surface.morphs, with_morphs, out);
}

// What is missing makes an animation one that cannot be used.
void require_whole(Character& character)
{
    if (!character.missing.empty())
        throw InputError::in_file(character.file, "has " + not_modelled(character.missing));
    auto require = [&](Character::Animation& animation) {
        if (animation.fault.empty() && !animation.missing.empty())
            animation.fault = InputError::in_file(character.file, "clip '" + animation.name + "' has " +
                                                                      not_modelled(animation.missing))
                                  .what();
    };
    require(character.rest);
    for (Character::Animation& animation : character.animations)
        require(animation);
}

} // namespace

Character parse_gltf(std::string_view bytes, const std::string& file, Coverage coverage, Morphs morphs,
                     const Decompression* decoders)
{
    require_default_arithmetic();
    GltfDocument document(bytes, file, decoders);
    Character out;
    out.file = file;
    Missing missing;
    try {
        read(document, morphs, missing, out);
    } catch (const InputError& error) {
        if (missing.empty())
            throw;
        throw InputError(std::string(error.what()) + "; it has " + not_modelled(missing.names())); // which may be why
    }
    out.missing = missing.names();
    if (coverage == Coverage::whole)
        require_whole(out);
    return out;
}

Character read_gltf(const std::filesystem::path& path, Coverage coverage, Morphs morphs, const Decompression* decoders)
{
    return parse_gltf(read_bytes(path), path.string(), coverage, morphs, decoders);
}

} // namespace cinch
