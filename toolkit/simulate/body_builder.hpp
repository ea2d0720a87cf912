// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "toolkit/simulate/body_simulation.hpp"
#include "toolkit/simulate/node_selection.hpp"
#include "toolkit/simulate/scene.hpp"

namespace cinch {

/// Where a point of a body is at a time.
using BodyPath = std::function<Vec3(std::size_t point, double time_s)>;

/// A body of a scene as its effects find it while it is built. Complaints are InputErrors with file and path of the
/// effect.
class BodyBuilder {
public:
    /// `clip`: where a character's clip takes nodes, in the world; empty where there is none. `start`: where the nodes
    /// begin, seen from `origin`. All must outlive the builder.
    BodyBuilder(const Scene& scene, const SceneBody& spec, const std::string& file, const BodyPath& clip,
                const Field& start, const Vec3& origin, BodySimulation& out)
        : scene_(scene), spec_(spec), file_(file), clip_(clip), start_(start), origin_(origin), out_(out)
    {
    }
    /// Adds all effects of the scene that act on the body, in their order.
    void build();

    const MeshlessBody& body() const { return out_.body(); }
    /// Its name must be that of the effect in the scene.
    void add(std::unique_ptr<const Effect> effect);
    /// A node can be pinned once.
    void add(Pin pin);

    /// Indices, ascending; there is at least one.
    std::vector<std::uint32_t> select(const NodeSelection& nodes) const;
    /// Where nodes begin, m, seen from origin().
    std::vector<Vec3> starts(const std::vector<std::uint32_t>& nodes) const;
    const Vec3& origin() const { return origin_; } ///< m
    /// Where the clip takes them, in the world; complains where there is none.
    BodyPath clip(const std::vector<std::uint32_t>& nodes) const;
    double young() const; ///< Pa, of the first elastic material on the body; 0: it has none
    [[noreturn]] void complain(const std::string& what) const;

private:
    const Scene& scene_;
    const SceneBody& spec_;
    const std::string& file_;
    const BodyPath& clip_;
    const Field& start_;
    const Vec3& origin_;
    BodySimulation& out_;
    const SceneEffect* effect_ = nullptr; ///< that is being added
    std::vector<std::uint32_t> pinned_;
};

/// The bodies of a scene on which an effect acts, as it finds them when they are built.
class CouplingBuilder {
public:
    struct Member {
        const std::string& name;
        BodySimulation& simulation; ///< that stays where it is as long as the coupling lives
    };

    CouplingBuilder(std::vector<Member> members, const SceneEffect& effect, const std::string& file)
        : members_(std::move(members)), effect_(effect), file_(file)
    {
    }
    std::span<const Member> members() const { return members_; }
    [[noreturn]] void complain(const std::string& what) const;

private:
    std::vector<Member> members_;
    const SceneEffect& effect_;
    const std::string& file_;
};

} // namespace cinch
