// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "toolkit/simulate/effect.hpp"

namespace cinch {

/// The points by which a body touches things: the vertices of its surface, v_k = Σ_j w_kj (X_j + J_j (v⁰_k − x_j)) (Eq.
/// 1), or its nodes where it has no surface, or its surface is not to be seen. Forces on them go to the nodes by the
/// transpose of that map, which is linear in X.
class ContactPoints {
public:
    enum class Of { surface, nodes };
    explicit ContactPoints(Of of = Of::surface) : of_(of) {}

    std::size_t count(const Configuration& c) const
    {
        return surface(c) ? surface(c)->mesh.vertices.size() : c.body.size();
    }
    Vec3 place(const Configuration& c, std::size_t k) const { return blend(c, k, c.x, c.deformation); }
    /// Its change under dx, with dj = dG.
    Vec3 change(const Configuration& c, std::size_t k, const Field& dx, const MatrixField& dj) const
    {
        return blend(c, k, dx, dj);
    }
    /// Power is conserved: force·velocity of the point = Σ over nodes of what is added, by theirs.
    void add_force(const Configuration& c, std::size_t k, const Vec3& force, Forces out) const;
    /// The nodes that the point follows, each with its weight; they sum to 1.
    template <class Visit> void each_weight(const Configuration& c, std::size_t k, const Visit& visit) const
    {
        if (!surface(c))
            return visit(static_cast<std::uint32_t>(k), 1.0);
        const Weights::Row row = surface(c)->weights.of(k);
        for (std::size_t e = 0; e < row.node.size(); ++e)
            visit(row.node[e], row.weight[e]);
    }
    /// A bound, about, of what a force by the point's velocity does to its nodes beside their weights: what acts
    /// through J comes on top.
    double share_of_stresses(const Configuration& c) const { return surface(c) ? 4 : 1; }

private:
    const DeformableSurface* surface(const Configuration& c) const { return of_ == Of::nodes ? nullptr : c.surface; }
    Vec3 blend(const Configuration& c, std::size_t k, const Field& x, const MatrixField& j) const;

    Of of_;
};

} // namespace cinch
