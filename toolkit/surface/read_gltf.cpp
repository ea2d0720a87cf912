// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "toolkit/surface/character.hpp"
#include "toolkit/surface/gltf_accessor.hpp"
#include "toolkit/surface/read_mesh.hpp"
#include "toolkit/surface/text_scan.hpp"

namespace cinch {
namespace {

bool keep_no_image(tinygltf::Image*, const int, std::string*, std::string*, int, int, const unsigned char*, int, void*) { return true; }

std::string one_line(std::string text)
{
    while (!text.empty() && (text.back() == '\n' || text.back() == ' '))
        text.pop_back();
    return printable(text.substr(0, text.find('\n')));
}

tinygltf::Model load_model(std::string_view bytes, const std::string& file)
{
    tinygltf::TinyGLTF loader;
    loader.SetImageLoader(keep_no_image, nullptr);
    tinygltf::Model model;
    std::string error, warning;
    const auto length = static_cast<unsigned int>(bytes.size());
    const std::string folder = std::filesystem::path(file).parent_path().string();
    bool ok = false;
    try {
        ok = bytes.starts_with("glTF")
                 ? loader.LoadBinaryFromMemory(&model, &error, &warning, reinterpret_cast<const unsigned char*>(bytes.data()), length, folder)
                 : loader.LoadASCIIFromString(&model, &error, &warning, bytes.data(), length, folder);
    } catch (const std::exception& exception) { // the JSON library under it throws on some malformed files
        error = exception.what();
    }
    if (!ok)
        throw InputError::in_file(file, "is not a valid glTF file: " + one_line(error.empty() ? warning : error));
    for (const std::string& extension : model.extensionsRequired)
        if (extension == "KHR_draco_mesh_compression" || extension == "EXT_meshopt_compression")
            throw InputError::in_file(file, "is compressed with " + extension + ", which is not supported; export it without compression");
    return model;
}

struct Builder {
    const tinygltf::Model& model;
    const std::string& file;
    Character out;
    std::vector<std::uint32_t> bone_of_node;   // glTF node → bone
    std::vector<std::uint32_t> first_joint;    // skin → index of its first joint
    std::map<std::pair<std::array<double, 3>, std::vector<std::pair<std::uint32_t, double>>>, std::uint32_t> welded;

    [[noreturn]] void fail(const std::string& reason) const { throw InputError::in_file(file, reason); }

    std::size_t checked(int index, std::size_t size, const std::string& what) const
    {
        if (index < 0 || static_cast<std::size_t>(index) >= size)
            fail(what + " " + std::to_string(index) + " does not exist");
        return static_cast<std::size_t>(index);
    }

    template <std::size_t N> void copy_numbers(const std::vector<double>& from, std::array<double, N>& to, std::size_t node) const
    {
        if (from.empty())
            return;
        if (from.size() != N || !std::all_of(from.begin(), from.end(), [](double x) { return std::isfinite(x); }))
            fail("node " + std::to_string(node) + " has a transform of the wrong size or not finite");
        std::copy(from.begin(), from.end(), to.begin());
    }

    // Bones in an order where parents come first. A node with two parents, or in a cycle, is refused.
    void add_bones()
    {
        constexpr std::int64_t unseen = -2;
        std::vector<std::int64_t> parent(model.nodes.size(), -1);
        for (std::size_t i = 0; i < model.nodes.size(); ++i)
            for (int child : model.nodes[i].children) {
                auto& p = parent[checked(child, model.nodes.size(), "child node")];
                if (p != -1)
                    fail("node " + std::to_string(child) + " has two parents");
                p = static_cast<std::int64_t>(i);
            }
        std::vector<std::int64_t> bone(model.nodes.size(), unseen);
        std::vector<std::size_t> open;
        for (std::size_t i = 0; i < model.nodes.size(); ++i)
            if (parent[i] == -1)
                open.push_back(i);
        while (!open.empty()) {
            const std::size_t i = open.back();
            open.pop_back();
            bone[i] = static_cast<std::int64_t>(out.bones.size());
            Bone b;
            b.parent = parent[i] == -1 ? -1 : bone[static_cast<std::size_t>(parent[i])];
            b.is_matrix = !model.nodes[i].matrix.empty();
            copy_numbers(model.nodes[i].matrix, b.matrix, i);
            copy_numbers(model.nodes[i].translation, b.translation, i);
            copy_numbers(model.nodes[i].rotation, b.rotation, i);
            copy_numbers(model.nodes[i].scale, b.scale, i);
            out.bones.push_back(b);
            for (int child : model.nodes[i].children)
                open.push_back(static_cast<std::size_t>(child));
        }
        for (std::size_t i = 0; i < bone.size(); ++i) {
            if (bone[i] == unseen)
                fail("node " + std::to_string(i) + " is its own ancestor");
            bone_of_node.push_back(static_cast<std::uint32_t>(bone[i]));
        }
    }

    void add_joints()
    {
        for (std::size_t s = 0; s < model.skins.size(); ++s) {
            const tinygltf::Skin& skin = model.skins[s];
            first_joint.push_back(static_cast<std::uint32_t>(out.joints.size()));
            std::vector<double> bind;
            if (skin.inverseBindMatrices >= 0) {
                bind = read_accessor(model, skin.inverseBindMatrices, 16, file);
                if (bind.size() < 16 * skin.joints.size())
                    fail("skin " + std::to_string(s) + " has fewer inverse bind matrices than joints");
            }
            for (std::size_t j = 0; j < skin.joints.size(); ++j) {
                Joint joint{bone_of_node[checked(skin.joints[j], model.nodes.size(), "joint node")], identity_map};
                if (!bind.empty())
                    for (std::size_t r = 0; r < 3; ++r)
                        for (std::size_t c = 0; c < 4; ++c)
                            joint.inverse_bind.m[r][c] = bind[16 * j + 4 * c + r]; // column-major
                out.joints.push_back(joint);
            }
        }
        out.influences.node_count = static_cast<std::uint32_t>(out.joints.size());
    }

    std::vector<std::uint32_t> vertex_order(const tinygltf::Primitive& primitive, std::size_t vertices) const
    {
        std::vector<std::uint32_t> order;
        if (primitive.indices < 0) {
            for (std::size_t i = 0; i < vertices; ++i)
                order.push_back(static_cast<std::uint32_t>(i));
            return order;
        }
        for (double index : read_accessor(model, primitive.indices, 1, file)) {
            if (!(index >= 0 && index < static_cast<double>(vertices)))
                fail("vertex index " + std::to_string(static_cast<std::int64_t>(index)) + " is out of range; the primitive has " +
                     std::to_string(vertices) + " vertices");
            order.push_back(static_cast<std::uint32_t>(index));
        }
        return order;
    }

    static std::vector<Triangle> triangles_of(const std::vector<std::uint32_t>& order, int mode)
    {
        std::vector<Triangle> triangles;
        if (mode == TINYGLTF_MODE_TRIANGLES)
            for (std::size_t i = 0; i + 2 < order.size(); i += 3)
                triangles.push_back({order[i], order[i + 1], order[i + 2]});
        else if (mode == TINYGLTF_MODE_TRIANGLE_STRIP)
            for (std::size_t i = 2; i < order.size(); ++i)
                triangles.push_back({order[i - 2 + i % 2], order[i - 1 - i % 2], order[i]});
        else
            for (std::size_t i = 2; i < order.size(); ++i)
                triangles.push_back({order[0], order[i - 1], order[i]});
        return triangles;
    }

    void add_primitive(const tinygltf::Primitive& primitive, std::size_t skin)
    {
        const auto position = primitive.attributes.find("POSITION");
        if (position == primitive.attributes.end() || !primitive.attributes.count("JOINTS_0") || !primitive.attributes.count("WEIGHTS_0")) {
            out.notes.push_back("a primitive without POSITION, JOINTS_0 or WEIGHTS_0 was left out");
            return;
        }
        const std::vector<double> points = read_accessor(model, position->second, 3, file);
        const std::size_t vertices = points.size() / 3;
        std::vector<std::vector<double>> joints, weights;
        for (int set = 0;; ++set) {
            const auto j = primitive.attributes.find("JOINTS_" + std::to_string(set));
            const auto w = primitive.attributes.find("WEIGHTS_" + std::to_string(set));
            if (j == primitive.attributes.end() || w == primitive.attributes.end())
                break;
            joints.push_back(read_accessor(model, j->second, 4, file));
            weights.push_back(read_accessor(model, w->second, 4, file));
            if (joints.back().size() != 4 * vertices || weights.back().size() != 4 * vertices)
                fail("a primitive has " + std::to_string(vertices) + " positions but another number of joints or weights");
        }

        std::vector<std::uint32_t> vertex_of(vertices);
        for (std::size_t k = 0; k < vertices; ++k)
            vertex_of[k] = weld(&points[3 * k], influences_of(k, joints, weights, skin));
        for (const Triangle& t : triangles_of(vertex_order(primitive, vertices), primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode))
            out.mesh.triangles.push_back({vertex_of[t[0]], vertex_of[t[1]], vertex_of[t[2]]});
    }

    std::vector<std::pair<std::uint32_t, double>> influences_of(std::size_t k, const std::vector<std::vector<double>>& joints,
                                                                const std::vector<std::vector<double>>& weights, std::size_t skin) const
    {
        std::map<std::uint32_t, double> sum; // a joint may be named twice; zero-weight slots are padding
        for (std::size_t set = 0; set < joints.size(); ++set)
            for (std::size_t i = 4 * k; i < 4 * k + 4; ++i) {
                const double weight = weights[set][i];
                if (weight < 0)
                    fail("vertex " + std::to_string(k) + " has a negative weight");
                if (weight == 0)
                    continue;
                if (!(joints[set][i] >= 0 && joints[set][i] < static_cast<double>(model.skins[skin].joints.size())))
                    fail("vertex " + std::to_string(k) + " names joint " + std::to_string(static_cast<std::int64_t>(joints[set][i])) +
                         "; skin " + std::to_string(skin) + " has " + std::to_string(model.skins[skin].joints.size()));
                sum[first_joint[skin] + static_cast<std::uint32_t>(joints[set][i])] += weight;
            }
        if (sum.empty()) // bound to nothing; the first joint named keeps it in place, and the load report counts it
            sum[first_joint[skin] + static_cast<std::uint32_t>(std::clamp(joints[0][4 * k], 0.0, static_cast<double>(model.skins[skin].joints.size() - 1)))] = 0;
        return {sum.begin(), sum.end()};
    }

    std::uint32_t weld(const double* point, std::vector<std::pair<std::uint32_t, double>> influences)
    {
        const std::array<double, 3> key{point[0] + 0.0, point[1] + 0.0, point[2] + 0.0}; // -0 and 0 are one place
        const auto [it, is_new] = welded.try_emplace({key, influences}, static_cast<std::uint32_t>(out.mesh.vertices.size()));
        if (is_new) {
            out.mesh.vertices.emplace_back(key[0], key[1], key[2]);
            for (const auto& [node, weight] : influences) {
                out.influences.node.push_back(node);
                out.influences.weight.push_back(weight);
            }
            out.influences.row.push_back(static_cast<std::uint32_t>(out.influences.node.size()));
        }
        return it->second;
    }

    void add_meshes()
    {
        std::size_t unskinned = 0, not_triangles = 0;
        for (const tinygltf::Node& node : model.nodes) {
            if (node.mesh < 0)
                continue;
            if (node.skin < 0) {
                ++unskinned;
                continue;
            }
            const std::size_t skin = checked(node.skin, model.skins.size(), "skin");
            if (model.skins[skin].joints.empty())
                fail("skin " + std::to_string(skin) + " has no joints");
            for (const auto& primitive : model.meshes[checked(node.mesh, model.meshes.size(), "mesh")].primitives) {
                if (primitive.mode >= 0 && primitive.mode < TINYGLTF_MODE_TRIANGLES)
                    ++not_triangles;
                else
                    add_primitive(primitive, skin);
            }
        }
        if (unskinned)
            out.notes.push_back(std::to_string(unskinned) + " meshes without a skin were left out");
        if (not_triangles)
            out.notes.push_back(std::to_string(not_triangles) + " primitives of points or lines were left out");
    }

    void add_animations()
    {
        std::set<std::string> names;
        for (std::size_t a = 0; a < model.animations.size(); ++a) {
            Character::Animation animation;
            animation.name = model.animations[a].name.empty() ? "anim" + std::to_string(a) : model.animations[a].name;
            if (!names.insert(animation.name).second)
                names.insert(animation.name += "#" + std::to_string(a));
            for (const auto& channel : model.animations[a].channels)
                if (channel.target_node >= 0)
                    add_curve(model.animations[a], channel, animation);
            out.animations.push_back(std::move(animation));
        }
    }

    void add_curve(const tinygltf::Animation& source, const tinygltf::AnimationChannel& channel, Character::Animation& animation)
    {
        Curve curve;
        if (channel.target_path == "translation")
            curve.target = Curve::Target::translation;
        else if (channel.target_path == "rotation")
            curve.target = Curve::Target::rotation;
        else if (channel.target_path == "scale")
            curve.target = Curve::Target::scale;
        else { // morph targets: not a convex combination of affine maps
            const std::string note = "animation '" + animation.name + "': its '" + printable(channel.target_path) + "' channels were left out";
            if (std::find(out.notes.begin(), out.notes.end(), note) == out.notes.end())
                out.notes.push_back(note);
            return;
        }
        const std::string where = "animation '" + printable(animation.name) + "'";
        const auto& sampler = source.samplers[checked(channel.sampler, source.samplers.size(), where + ": sampler")];
        if (sampler.interpolation == "STEP")
            curve.interpolation = Curve::Interpolation::step;
        else if (sampler.interpolation == "CUBICSPLINE")
            curve.interpolation = Curve::Interpolation::cubic_spline;
        else if (sampler.interpolation != "LINEAR")
            fail(where + ": unknown interpolation '" + printable(sampler.interpolation) + "'");
        curve.bone = bone_of_node[checked(channel.target_node, model.nodes.size(), where + ": node")];
        curve.time_s = read_accessor(model, sampler.input, 1, file);
        const std::size_t components = curve.target == Curve::Target::rotation ? 4 : 3;
        const std::vector<double> values = read_accessor(model, sampler.output, components, file);
        for (std::size_t i = 0; i < values.size(); i += components) {
            std::array<double, 4> value{};
            std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(i), components, value.begin());
            curve.value.push_back(value);
        }
        const std::size_t per_key = curve.interpolation == Curve::Interpolation::cubic_spline ? 3 : 1;
        if (curve.time_s.empty() || curve.value.size() != per_key * curve.time_s.size())
            fail(where + ": " + std::to_string(curve.time_s.size()) + " keys but " + std::to_string(curve.value.size()) + " values");
        if (std::adjacent_find(curve.time_s.begin(), curve.time_s.end(), std::greater_equal<>()) != curve.time_s.end())
            fail(where + ": key times do not ascend");
        animation.curves.push_back(std::move(curve));
    }
};

} // namespace

Character parse_gltf(std::string_view bytes, const std::string& file)
{
    if (bytes.size() > 0xffffffffu)
        throw InputError::in_file(file, "is larger than 4 GiB");
    const tinygltf::Model model = load_model(bytes, file);
    if (model.skins.empty())
        throw InputError::in_file(file, "has no skin; for a plain mesh export OBJ, OFF, PLY or STL");
    Builder builder{model, file, {}, {}, {}, {}};
    builder.add_bones();
    builder.add_joints();
    builder.add_meshes();
    builder.add_animations();
    return std::move(builder.out);
}

Character read_gltf(const std::filesystem::path& path) { return parse_gltf(read_bytes(path), path.string()); }

} // namespace cinch
