// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "cinch/collider.hpp"
#include "toolkit/simulate/body_simulation.hpp"
#include "toolkit/simulate/coupling.hpp"
#include "toolkit/simulate/effects/contact.hpp"
#include "toolkit/simulate/find_inside.hpp"

namespace cinch {

/// Finds where several bodies run into each other, by Collider, and how they are to part: every vertex of one inside
/// another (find_inside) goes half of the way to the closest point of that one's surface, and that point goes the other
/// half. So forces are opposite and equal when a frame begins. The stiffness of a vertex is pressure per depth times
/// its share of the surface at rest, half of it for either body. O(pairs) plus O(vertices) of the bodies that touch. A
/// body wholly inside another, or a crossing of edges alone, is not seen.
class ContactSearch final : public Coupling {
public:
    /// `stiffness` in Pa/m.
    explicit ContactSearch(double stiffness) : stiffness_(stiffness), collider_(LazyOptions{}) {}
    ContactSearch(const ContactSearch&) = delete;
    ContactSearch& operator=(const ContactSearch&) = delete;

    /// Gives the body an effect that pushes. It must stay where it is, and alive, and have a closed surface; its
    /// outside is where that makes its volume at rest positive.
    void add(BodySimulation& body);

    void find() override;
    std::size_t pairs() const { return pairs_; } ///< of triangles that intersected in the last search

private:
    struct Member {
        BodySimulation* body;
        std::size_t effect; ///< that pushes it
        TrianglesAround around;
        double outside;           ///< 1, or −1 where the surface is inside out
        std::vector<double> area; ///< of each vertex, at rest, m²
        std::vector<AffineMap> maps;
        std::vector<Vec3> position; ///< of the vertices, while it touches others

        PosedSurface posed() const { return {body->surface()->mesh, around, position, outside}; }
    };
    using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
    void part(std::uint32_t a, std::uint32_t b, const Pairs& pairs, std::vector<std::vector<Contact>>& out) const;

    double stiffness_;
    Vec3 origin_ = Vec3::Zero(); ///< from where the last search saw the bodies
    Collider collider_;
    std::vector<Member> members_;
    std::size_t pairs_ = 0;
};

} // namespace cinch
