// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/load_body.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>
#include <optional>

#include "toolkit/deform/sample_nodes.hpp"
#include "toolkit/surface/character.hpp"
#include "toolkit/surface/shapes.hpp"
#include "toolkit/surface/triangle_mesh.hpp"

namespace cinch {
namespace {

std::size_t nearest(std::span<const Vec3> places, const Vec3& p)
{
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < places.size(); ++i)
        if (const double squared = (places[i] - p).squaredNorm(); squared < least) {
            least = squared;
            best = i;
        }
    return best;
}

// A point moves as the surface's nearest vertex does: by that vertex's blend of joint maps, between two frames of the
// clip. The places in the two frames around the time asked for last are kept.
class SkinPath {
public:
    SkinPath(Clip clip, Weights skin, std::vector<Vec3> points, std::vector<std::uint32_t> vertices)
        : clip_(std::move(clip)), skin_(std::move(skin)), point_(std::move(points)), vertex_(std::move(vertices))
    {
    }

    Vec3 operator()(std::size_t node, double time_s)
    {
        const std::scoped_lock lock(mutex_);
        const double now = clip_.time_s(0) + time_s;
        std::size_t above = 0; // the first frame after now
        for (std::size_t last = clip_.frame_count(); above < last;) {
            const std::size_t middle = above + (last - above) / 2;
            if (clip_.time_s(middle) > now)
                last = middle;
            else
                above = middle + 1;
        }
        if (above == 0 || above >= clip_.frame_count())
            return in_frame(above == 0 ? 0 : clip_.frame_count() - 1)[node];
        const double before = clip_.time_s(above - 1), s = (now - before) / (clip_.time_s(above) - before);
        return (1 - s) * in_frame(above - 1)[node] + s * in_frame(above)[node];
    }

private:
    const std::vector<Vec3>& in_frame(std::size_t frame)
    {
        Kept& kept = kept_[frame % 2];
        if (kept.frame == frame)
            return kept.place;
        const Clip::Frame maps = clip_.frame(frame);
        kept.place.assign(point_.size(), Vec3::Zero());
        for (std::size_t i = 0; i < point_.size(); ++i) {
            const Weights::Row row = skin_.of(vertex_[i]);
            for (std::size_t e = 0; e < row.node.size(); ++e) {
                const auto& m = maps[row.node[e]].m;
                for (int r = 0; r < 3; ++r)
                    kept.place[i][r] += row.weight[e] * (m[r][0] * point_[i][0] + m[r][1] * point_[i][1] +
                                                         m[r][2] * point_[i][2] + m[r][3]);
            }
        }
        kept.frame = frame;
        return kept.place;
    }

    struct Kept {
        std::optional<std::size_t> frame;
        std::vector<Vec3> place;
    };
    Clip clip_;
    Weights skin_;
    std::vector<Vec3> point_;
    std::vector<std::uint32_t> vertex_;
    Kept kept_[2];
    std::mutex mutex_;
};

[[noreturn]] void complain(const std::string& file, const SceneBody& body, const std::string& field,
                           const std::string& what)
{
    throw InputError::in_file(file, body.path + "/" + field + ": " + what);
}

MeshFile load_mesh(const SceneBody& body, const std::string& file, MeshCache& meshes)
{
    if (body.surface == "box" || body.surface == "sheet")
        return {box(body.surface == "box" ? body.box_m : Vec3(body.box_m[0], body.box_m[1], 0), body.cells), {}};
    if (const auto known = meshes.find(body.surface); known != meshes.end())
        return known->second;
    if (auto shape = named_shape(body.surface))
        return meshes[body.surface] = {std::move(*shape), {}};
    if (!is_mesh_file(body.surface)) {
        std::string known;
        for (const std::string& name : shape_names())
            known += name + ", ";
        complain(file, body, "surface",
                 "'" + body.surface + "' is no shape (" + known + "box, sheet) and no mesh or character file");
    }
    MeshFile read = [&] {
        try {
            return read_mesh(body.surface);
        } catch (const InputError& error) {
            complain(file, body, "surface", error.what());
        }
    }();
    if (read.mesh.vertices.empty() || read.mesh.triangles.empty())
        complain(file, body, "surface", body.surface + " has no triangles");
    return meshes[body.surface] = std::move(read);
}

std::vector<Vec3> lattice(const SceneBody& body)
{
    std::vector<Vec3> nodes;
    const auto& n = body.lattice;
    for (int i = 0; i < n[0]; ++i)
        for (int j = 0; j < n[1]; ++j)
            for (int k = 0; k < n[2]; ++k)
                nodes.emplace_back(body.box_m[0] * ((i + 0.5) / n[0] - 0.5), body.box_m[1] * ((j + 0.5) / n[1] - 0.5),
                                   body.surface == "sheet" ? 0 : body.box_m[2] * ((k + 0.5) / n[2] - 0.5));
    return nodes;
}

} // namespace

LoadedBody load_body(const SceneBody& body, const std::string& file, const Decompression* decoders, MeshCache& meshes)
{
    LoadedBody loaded;
    TriangleMesh& mesh = loaded.surface.mesh;
    std::optional<Character> character;
    if (is_character_file(body.surface)) {
        if (body.size_m > 0)
            complain(file, body, "size", "a character keeps its own size");
        try {
            character = read_gltf(body.surface, Coverage::whole, Morphs::missing, decoders);
            if (character->animations.empty())
                rest_pose(*character); // says what is missing in it
        } catch (const InputError& error) {
            complain(file, body, "surface", error.what());
        }
        if (character->carried > 0)
            complain(file, body, "surface",
                     body.surface + " has parts that are carried by nodes, which are at rest each by itself; only "
                                    "skinned characters can be simulated");
        mesh = character->mesh;
        if (mesh.triangles.empty())
            complain(file, body, "surface", body.surface + " has no triangles");
    } else {
        MeshFile read = load_mesh(body, file, meshes);
        mesh = std::move(read.mesh);
        for (const std::string& note : read.notes)
            loaded.notes.push_back(std::filesystem::path(body.surface).filename().string() + ": " + note);
        if (body.size_m > 0)
            centre_and_scale(mesh, body.size_m);
    }

    if (!(extent(mesh).longest_half <= 1e30) || !extent(mesh).centre.allFinite())
        complain(file, body, "surface", "is larger than 1e30 m");

    double fill = 0;
    if (body.nodes > 0) {
        const SimulationNodes sampled = sample_nodes(mesh, body.nodes, body.seed);
        loaded.nodes = sampled.position;
        fill = sampled.fill_distance;
        if (sampled.position.size() < body.nodes)
            loaded.notes.push_back("only " + std::to_string(sampled.position.size()) +
                                   " distinct places for simulation nodes");
    } else {
        loaded.nodes = body.places.empty() ? lattice(body) : body.places;
        for (const Vec3& v : mesh.vertices)
            fill = std::max(fill, (v - loaded.nodes[nearest(loaded.nodes, v)]).norm());
    }
    std::size_t alone = 0;
    loaded.surface.weights = kernel_weights(mesh, {loaded.nodes, fill}, 2, &alone);
    if (alone)
        loaded.notes.push_back(std::to_string(alone) +
                               " vertices lie beyond the reach of every simulation node; each follows its nearest one");

    if (body.surface == "box" || body.surface == "sheet") {
        const double volume =
            body.box_m[0] * body.box_m[1] * (body.surface == "sheet" ? body.thickness_m : body.box_m[2]);
        if (body.lattice[0] > 0)
            loaded.volume.assign(loaded.nodes.size(), volume / static_cast<double>(loaded.nodes.size()));
        loaded.total_volume = volume;
    } else {
        loaded.total_volume = std::abs(signed_volume(mesh));
    }
    if (loaded.volume.empty() && !body.volume_by_density) {
        loaded.volume = cell_volumes(mesh, loaded.nodes);
        if (loaded.volume.empty())
            loaded.notes.push_back("the surface encloses no volume; the nodes' volumes follow from their density");
    }

    if (character && !character->animations.empty()) {
        const Character::Animation* chosen = nullptr;
        std::string known;
        for (const Character::Animation& animation : character->animations) {
            known += (known.empty() ? "" : ", ") + animation.name;
            if (!chosen && (body.clip.empty() || animation.name == body.clip))
                chosen = &animation;
        }
        if (!chosen)
            complain(file, body, "clip", body.surface + " has no clip '" + body.clip + "'; it has " + known);
        std::vector<std::uint32_t> followed;
        for (const Vec3& p : loaded.nodes)
            followed.push_back(static_cast<std::uint32_t>(nearest(mesh.vertices, p)));
        std::optional<Clip> clip;
        try {
            clip = sample(*character, *chosen, 60);
        } catch (const InputError& error) {
            complain(file, body, "clip", error.what());
        }
        auto path = std::make_shared<SkinPath>(std::move(*clip), to_dyadic(character->influences), loaded.nodes,
                                               std::move(followed));
        loaded.clip = [path](std::size_t node, double time_s) { return (*path)(node, time_s); };
    } else if (!body.clip.empty()) {
        complain(file, body, "clip", "only an animated character has clips");
    }
    return loaded;
}

} // namespace cinch
