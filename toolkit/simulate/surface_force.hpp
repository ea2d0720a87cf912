// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "toolkit/simulate/effect.hpp"

namespace cinch {

/// The points by which a body touches things: the vertices of its surface, v_k = Σ_j w_kj (X_j + J_j (v⁰_k − x_j)) (Eq.
/// 1), or its nodes where it has no surface. Forces on them go to the nodes by the transpose of that map, which is
/// linear in X.
std::size_t points_of(const Configuration& c);
Vec3 point(const Configuration& c, std::size_t k);
/// Its change under dx, with dj = dG.
Vec3 point_change(const Configuration& c, std::size_t k, const Field& dx, const MatrixField& dj);
/// Power is conserved: force·velocity of the point = Σ over nodes of what is added, by theirs.
void add_point_force(const Configuration& c, std::size_t k, const Vec3& force, Forces out);

} // namespace cinch
