// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/contact_search.hpp"

#include <map>

#include <Eigen/Geometry>

#include "cinch/deform.hpp"
#include "toolkit/surface/triangle_mesh.hpp"

namespace cinch {

void ContactSearch::add(BodySimulation& body)
{
    const DeformableSurface& surface = *body.surface();
    const double outside = signed_volume(surface.mesh) < 0 ? -1.0 : 1.0;
    Member member{&body, body.effects().size(), TrianglesAround(surface.mesh), outside, {}, {}, {}};
    member.area.resize(surface.mesh.vertices.size(), 0);
    const auto& x = surface.mesh.vertices;
    for (const Triangle& t : surface.mesh.triangles)
        for (const std::uint32_t k : t)
            member.area[k] += (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]).norm() / 6;
    collider_.add(build_bvh(surface, ClusterSize{16, 16}, RestDetail::inner),
                  surface); // it keeps what it needs of the BVH
    body.add(std::make_unique<BodyContact>());
    members_.push_back(std::move(member));
}

void ContactSearch::find()
{
    // All that is compared is seen from near the bodies, so that it is as fine far away as anywhere.
    origin_ = members_.empty() ? Vec3::Zero() : Vec3(members_.front().body->reference().origin);
    std::vector<BodyFrame> frames;
    for (Member& member : members_) {
        member.maps = member.body->frame(origin_);
        frames.push_back({member.maps});
    }
    collider_.update(frames);
    const std::vector<TrianglePair> pairs = collider_.pairs();
    pairs_ = pairs.size();
    std::map<std::pair<std::uint32_t, std::uint32_t>, Pairs> of_bodies;
    for (const TrianglePair& pair : pairs) {
        of_bodies[{pair.body_a, pair.body_b}].emplace_back(pair.triangle_a, pair.triangle_b);
        of_bodies[{pair.body_b, pair.body_a}].emplace_back(pair.triangle_b, pair.triangle_a);
    }
    for (Member& member : members_)
        member.position.clear();
    for (const auto& [bodies, unused] : of_bodies)
        if (Member& member = members_[bodies.first]; member.position.empty()) {
            member.position.resize(member.area.size());
            evaluate(member.body->surface()->mesh.vertices, member.body->surface()->weights, member.maps,
                     member.position);
        }
    std::vector<std::vector<Contact>> contacts(members_.size());
    for (const auto& [bodies, meeting] : of_bodies)
        part(bodies.first, bodies.second, meeting, contacts);
    for (std::size_t b = 0; b < members_.size(); ++b)
        members_[b].body->set_memory(members_[b].effect, BodyContact::remembering(contacts[b], origin_));
}

void ContactSearch::part(std::uint32_t a, std::uint32_t b, const Pairs& pairs,
                         std::vector<std::vector<Contact>>& out) const
{
    const Member &own = members_[a], &other = members_[b];
    for (const InsideVertex& v : find_inside(own.posed(), other.posed(), pairs)) {
        const Triangle& t = other.body->surface()->mesh.triangles[v.triangle];
        const Vec3& p = own.position[v.vertex];
        const Vec3 q =
            v.share[0] * other.position[t[0]] + v.share[1] * other.position[t[1]] + v.share[2] * other.position[t[2]];
        const Vec3 n = (q - p).stableNormalized();
        const double stiffness = 0.5 * stiffness_ * own.area[v.vertex], middle = 0.5 * (n.dot(p) + n.dot(q));
        if (!(n.squaredNorm() > 0.5) || !(stiffness > 0)) // on the surface
            continue;
        out[a].push_back({{v.vertex, v.vertex, v.vertex}, {1, 0, 0}, {n[0], n[1], n[2]}, middle, stiffness});
        out[b].push_back({t, v.share, {-n[0], -n[1], -n[2]}, -middle, stiffness});
    }
}

} // namespace cinch
