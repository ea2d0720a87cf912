// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "toolkit/simulate/field.hpp"

namespace cinch {

struct MeshlessOptions {
    double support_factor = 1.75; ///< support radius h_i over r̄_i, the mean distance to the nearest nodes
    int nearest = 10;             ///< so many of them
    double support_radius = 0;    ///< m, for every node, instead; 0: not given
    double density = 1000;        ///< kg/m³
    double total_volume = 0;      ///< m³, to which volumes that are not given are scaled; 0: they are not
};

/// The discretisation of one elastic body at rest after Müller et al. 2004: nodes, what they weigh, and how a moving
/// least-squares fit at node i takes the displacement's gradient from its neighbours j:
/// G_i = Σ_j (X_j − X_i) d_ijᵀ, which is I at rest and R under a rotation by R, as far as the rank of the neighbours
/// reaches.
struct MeshlessBody {
    std::vector<Vec3> rest;               ///< x_i, m
    std::vector<double> mass, volume;     ///< kg, m³; > 0
    std::vector<double> support;          ///< h_i, m
    std::vector<std::uint32_t> row = {0}; ///< node i owns entries [row[i], row[i+1])
    std::vector<std::uint32_t> neighbour;
    AlignedVector<double> record;         ///< per entry 4 values: d_ij, 1/m, and the kernel w_ij = (1 − r²/h_i²)³
    std::vector<std::uint8_t> rank;       ///< of the neighbours of i: 3, or 2 in a plane, 1 on a line, 0 for none
    std::vector<std::uint32_t> deficient; ///< nodes of rank < 3
    std::vector<Mat3>
        frame;          ///< of those: an orthonormal basis, determinant 1, that begins with the directions they span
    double spacing = 0; ///< m, least mean distance r̄_i; 0 for a single node
    std::vector<std::string> notes; ///< what a user should know: coincident nodes, missing volumes

    std::size_t size() const { return rest.size(); }
    Eigen::Map<const Vec3> d(std::size_t entry) const { return Eigen::Map<const Vec3>(record.data() + 4 * entry); }
    double kernel(std::size_t entry) const { return record[4 * entry + 3]; }
};

/// `volume` (m³) of every node; empty: by the density of the nodes, as in the paper. Neighbourhoods that span less than
/// space grow until they do or reach across the body (4 h); at most the 400 nearest. Throws std::invalid_argument for
/// no nodes, values not finite or not positive.
MeshlessBody discretise(std::span<const Vec3> nodes, std::span<const double> volume, const MeshlessOptions& options);

/// Shares of the closed mesh's volume: that of the points of space that are nearest to each node. Empty if the mesh
/// encloses none.
std::vector<double> cell_volumes(const TriangleMesh& mesh, std::span<const Vec3> nodes);

/// Least-squares coefficients of one node: column j is d_ij such that Σ_j y_j d_ijᵀ is the gradient that fits the
/// values y at `offsets` with `weights` best. Directions in which the offsets extend less than `threshold` times their
/// greatest extent are left out. `frame` as above.
struct Fit {
    Eigen::Matrix3Xd d;
    int rank = 0;
    Mat3 frame = Mat3::Identity();
};
Fit fit_gradient(const Eigen::Matrix3Xd& offsets, const Eigen::VectorXd& weights, double threshold);

} // namespace cinch
