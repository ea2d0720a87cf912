// SPDX-License-Identifier: Apache-2.0
#include "toolkit/surface/gltf_scene.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Geometry>

#include "toolkit/surface/gltf_accessor.hpp"

namespace cinch {
namespace {

std::vector<std::size_t> children_of(const GltfValue& node)
{
    std::vector<std::size_t> out;
    if (const auto children = node.find("children"))
        for (std::size_t i = 0; i < children->size(); ++i)
            out.push_back((*children)[i].index());
    return out;
}

std::vector<std::int64_t> parents(const GltfDocument& document)
{
    const std::size_t count = document.count("nodes");
    std::vector<std::int64_t> parent(count, -1);
    for (std::size_t i = 0; i < count; ++i)
        for (const std::size_t child : children_of(document.at("nodes", i))) {
            const GltfValue node = document.at("nodes", child);
            if (parent[child] != -1)
                node.fail("has two parents");
            parent[child] = static_cast<std::int64_t>(i);
        }
    std::vector<char> rooted(count, 0); // no cycle above it
    std::vector<std::size_t> path;
    for (std::size_t i = 0; i < count; ++i) {
        path.clear();
        auto at = static_cast<std::int64_t>(i);
        for (; at >= 0 && !rooted[static_cast<std::size_t>(at)] && path.size() <= count;
             at = parent[static_cast<std::size_t>(at)])
            path.push_back(static_cast<std::size_t>(at));
        if (path.size() > count)
            document.at("nodes", i).fail("is its own ancestor, or has one that is");
        for (const std::size_t node : path)
            rooted[node] = 1;
    }
    return parent;
}

bool is_hidden(const GltfValue& node)
{
    if (const auto extensions = node.find("extensions"))
        if (const auto visibility = extensions->find("KHR_node_visibility"))
            return !visibility->truth_or("visible", true);
    return false;
}

// The last row of an affine map, (0, 0, 0, 1), as programs that multiply in binary32 write it.
bool is_affine(const double* row3, std::size_t stride)
{
    constexpr double rounding = 1e-5;
    return std::abs(row3[0]) <= rounding && std::abs(row3[stride]) <= rounding &&
           std::abs(row3[2 * stride]) <= rounding && std::abs(row3[3 * stride] - 1) <= rounding;
}

// Translation, rotation and scale of a matrix; false where it has a mirror, a shear, or a scale of 0, where they are
// not unique. Angles between columns are right to the rounding of programs that multiply a few matrices in binary32.
bool take_apart(Bone& bone)
{
    constexpr double rounding = 1e-5;
    const Eigen::Map<const Eigen::Matrix4d> m(bone.matrix.data());
    Eigen::Matrix3d axes = m.topLeftCorner<3, 3>();
    for (int c = 0; c < 3; ++c) {
        const double length = axes.col(c).stableNorm();
        if (!(length > 0 && std::isfinite(length)))
            return false;
        bone.scale[static_cast<std::size_t>(c)] = length;
        axes.col(c) /= length;
    }
    if (std::abs(axes.col(0).dot(axes.col(1))) > rounding || std::abs(axes.col(1).dot(axes.col(2))) > rounding ||
        std::abs(axes.col(2).dot(axes.col(0))) > rounding || axes.determinant() < 0)
        return false;
    const Eigen::Quaterniond q(axes);
    bone.rotation = {q.x(), q.y(), q.z(), q.w()};
    bone.translation = {m(0, 3), m(1, 3), m(2, 3)};
    return true;
}

} // namespace

GltfScene read_scene(const GltfDocument& document, Missing& missing, std::vector<std::string>& notes)
{
    GltfScene out;
    out.parent = parents(document);
    std::vector<std::size_t> open;
    const auto wanted = document.root().index_of("scene");
    if (wanted || document.count("scenes") > 0) {
        const GltfValue scene = document.at("scenes", wanted.value_or(0));
        note_extensions(scene, missing);
        if (const auto roots = scene.find("nodes"))
            for (std::size_t i = 0; i < roots->size(); ++i) {
                open.push_back((*roots)[i].index());
                const GltfValue node = document.at("nodes", open.back());
                if (out.parent[open.back()] >= 0)
                    node.fail("is named by " + scene.named() + ", but it is a child of another node");
            }
        if (const std::size_t scenes = document.count("scenes"); scenes > 1)
            notes.push_back(std::to_string(scenes) + " scenes; " +
                            (wanted ? "the default one, " : "no default, so the first one, ") + scene.named() +
                            ", is read");
    } else {
        for (std::size_t i = 0; i < out.parent.size(); ++i)
            if (out.parent[i] < 0)
                open.push_back(i);
    }
    std::reverse(open.begin(), open.end());
    std::vector<char> seen(out.parent.size(), 0), visible(out.parent.size(), 0);
    while (!open.empty()) {
        const std::size_t i = open.back();
        open.pop_back();
        if (seen[i])
            continue; // the scene names it twice
        seen[i] = 1;
        const GltfValue node = document.at("nodes", i);
        visible[i] = !is_hidden(node) && (out.parent[i] < 0 || visible[static_cast<std::size_t>(out.parent[i])]);
        note_extensions(node, missing, {"KHR_node_visibility", instancing});
        out.nodes.push_back(i);
        out.visible.push_back(visible[i]);
        const std::vector<std::size_t> children = children_of(node);
        open.insert(open.end(), children.rbegin(), children.rend());
    }
    return out;
}

GltfSkeleton::GltfSkeleton(GltfDocument& document, const GltfScene& scene, Missing& missing, Character& out)
    : document_(document), scene_(scene), missing_(missing), out_(out), bone_of_node_(document.count("nodes"), none),
      first_joint_(document.count("skins"), none), joint_count_(first_joint_.size(), 0)
{
}

std::uint32_t GltfSkeleton::add_bone(std::size_t node)
{
    std::vector<std::size_t> path; // up to what is there already
    for (auto at = static_cast<std::int64_t>(node); at >= 0 && bone_of_node_[static_cast<std::size_t>(at)] == none;
         at = scene_.parent[static_cast<std::size_t>(at)])
        path.push_back(static_cast<std::size_t>(at));
    for (; !path.empty(); path.pop_back()) {
        const std::size_t i = path.back();
        const GltfValue value = document_.at("nodes", i);
        note_extensions(value, missing_, {"KHR_node_visibility", instancing});
        Bone bone;
        bone.name = one_line(value.text_or("name", ""));
        if (bone.name.empty())
            bone.name = value.place();
        if (scene_.parent[i] >= 0)
            bone.parent = bone_of_node_[static_cast<std::size_t>(scene_.parent[i])];
        auto copy = [&](const char* key, auto& to) {
            if (const auto given = value.find(key)) {
                const std::vector<double> numbers = given->numbers(to.size());
                std::copy(numbers.begin(), numbers.end(), to.begin());
            }
        };
        copy("translation", bone.translation);
        copy("rotation", bone.rotation);
        copy("scale", bone.scale);
        bool can_animate = true;
        if (value.has("matrix")) {
            copy("matrix", bone.matrix);
            if (!is_affine(&bone.matrix[3], 4))
                value.fail("has a matrix whose last row is not (0, 0, 0, 1)");
            for (const std::size_t c : {3u, 7u, 11u, 15u})
                bone.matrix[c] = c == 15;
            bone.is_matrix = true;
            can_animate = take_apart(bone);
        }
        bone_of_node_[i] = static_cast<std::uint32_t>(out_.bones.size());
        out_.bones.push_back(bone);
        can_animate_.push_back(can_animate);
    }
    return bone_of_node_[node];
}

std::uint32_t GltfSkeleton::carrier(std::size_t node)
{
    out_.joints.push_back({add_bone(node), identity_map});
    out_.influences.node_count = static_cast<std::uint32_t>(out_.joints.size());
    return out_.influences.node_count - 1;
}

std::vector<std::uint32_t> GltfSkeleton::instances(std::size_t node)
{
    const GltfValue value = document_.at("nodes", node), attributes = value["extensions"][instancing]["attributes"];
    // Each is a bone of its own below the node's, so that nothing is rounded.
    struct Given {
        const char* name;
        std::size_t components;
        std::vector<double> numbers;
    } given[] = {{"TRANSLATION", 3, {}}, {"ROTATION", 4, {}}, {"SCALE", 3, {}}};
    std::optional<std::size_t> count;
    for (Given& g : given) {
        const auto index = attributes.index_of(g.name);
        if (!index)
            continue;
        g.numbers = read_accessor(document_, *index, g.components, missing_);
        const std::size_t elements = g.numbers.size() / g.components;
        if (count.value_or(elements) != elements)
            attributes.fail("has another number of " + std::string(g.name) + " than of the others");
        count = elements;
        for (std::size_t i = 0; i < g.numbers.size(); ++i)
            if (!std::isfinite(g.numbers[i]))
                attributes.fail("has " + std::string(g.name) + " of instance " + std::to_string(i / g.components) +
                                " that is not finite");
    }
    if (!count)
        attributes.fail("has none of TRANSLATION, ROTATION and SCALE");
    const std::uint32_t parent = add_bone(node);
    std::vector<std::uint32_t> joints;
    for (std::size_t i = 0; i < *count; ++i) {
        Bone bone;
        bone.name = value.place() + ", instance " + std::to_string(i);
        bone.parent = parent;
        auto copy = [&](const Given& g, auto& to) {
            if (!g.numbers.empty())
                std::copy_n(g.numbers.begin() + static_cast<std::ptrdiff_t>(i * g.components), to.size(), to.begin());
        };
        copy(given[0], bone.translation);
        copy(given[1], bone.rotation);
        copy(given[2], bone.scale);
        out_.joints.push_back({static_cast<std::uint32_t>(out_.bones.size()), identity_map});
        joints.push_back(static_cast<std::uint32_t>(out_.joints.size() - 1));
        out_.bones.push_back(bone);
        can_animate_.push_back(true);
    }
    out_.influences.node_count = static_cast<std::uint32_t>(out_.joints.size());
    return joints;
}

std::uint32_t GltfSkeleton::first_joint(std::size_t skin)
{
    const GltfValue value = document_.at("skins", skin);
    if (first_joint_[skin] != none)
        return first_joint_[skin];
    note_extensions(value, missing_);
    const GltfValue joints = value["joints"];
    const std::size_t count = joints.size();
    if (count == 0)
        value.fail("has no joints");
    std::vector<double> bind;
    if (const auto given = value.index_of("inverseBindMatrices")) {
        bind = read_accessor(document_, *given, 16, missing_);
        if (bind.size() < 16 * count)
            value.fail("has fewer inverse bind matrices than joints");
    }
    first_joint_[skin] = static_cast<std::uint32_t>(out_.joints.size());
    joint_count_[skin] = static_cast<std::uint32_t>(count);
    for (std::size_t j = 0; j < count; ++j) {
        const std::size_t node = joints[j].index();
        document_.at("nodes", node);
        Joint joint{add_bone(node), identity_map};
        if (!bind.empty()) {
            if (!is_affine(&bind[16 * j + 3], 4))
                value.fail("has an inverse bind matrix, of joint " + std::to_string(j) +
                           ", whose last row is not (0, 0, 0, 1)");
            for (std::size_t r = 0; r < 3; ++r)
                for (std::size_t c = 0; c < 4; ++c)
                    joint.inverse_bind.m[r][c] = bind[16 * j + 4 * c + r]; // column-major
        }
        out_.joints.push_back(joint);
    }
    out_.influences.node_count = static_cast<std::uint32_t>(out_.joints.size());
    return first_joint_[skin];
}

} // namespace cinch
