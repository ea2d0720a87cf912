// SPDX-License-Identifier: Apache-2.0
#include "toolkit/bounds/bound_sphere.hpp"

#include <algorithm>
#include <cmath>

#include "toolkit/bounds/rounding.hpp"

namespace cinch {
namespace {

// ‖G‖₂ ≤ min(‖G‖_F, √(‖G‖₁‖G‖_∞)).
double norm(const double (&g)[3][3])
{
    double squares = 0, rows = 0, columns = 0;
    for (int i = 0; i < 3; ++i) {
        double row = 0, column = 0;
        for (int j = 0; j < 3; ++j) {
            squares += g[i][j] * g[i][j];
            row += std::abs(g[i][j]);
            column += std::abs(g[j][i]);
        }
        rows = std::max(rows, row);
        columns = std::max(columns, column);
    }
    return std::min(std::sqrt(squares), std::sqrt(rows * columns));
}

} // namespace

void bound_sphere(const RestSphere& bv, std::span<const Vec3> place, std::span<const AffineMap> maps,
                  double vertex_influences, Rounding rounding, std::span<const Axis> axes,
                  std::span<double> supports) noexcept
{
    double centre[3] = {bv.centre[0], bv.centre[1], bv.centre[2]}, radius = bv.radius;
    double magnitude = bv.centre.lpNorm<1>() + bv.radius; // of every leaf of the sums, for the rounding
    double world = 0;                                     // of a vertex as evaluated
    for (const SphereInfluence& j : bv.influence) {
        const auto& m = maps[j.node].m;
        const Vec3& x = place[j.node];
        double u[3], g[3][3], leaf = 0, reach = 0;
        for (int r = 0; r < 3; ++r) {
            u[r] = ((m[r][0] * x[0] + m[r][1] * x[1]) + m[r][2] * x[2]) + m[r][3] - x[r];
            leaf += std::abs(m[r][3]) + std::abs(x[r]);
            reach += std::abs(m[r][3]);
            for (int s = 0; s < 3; ++s) {
                g[r][s] = m[r][s] - (r == s ? 1 : 0);
                leaf += std::abs(m[r][s] * x[s]);
                reach += std::abs(m[r][s]) * (std::abs(bv.centre[s]) + bv.radius);
            }
        }
        const double stretch = norm(g);
        for (int r = 0; r < 3; ++r)
            centre[r] += j.mean * u[r] + ((g[r][0] * j.moment[0] + g[r][1] * j.moment[1]) + g[r][2] * j.moment[2]);
        radius += j.weight_spread * std::hypot(u[0], u[1], u[2]) + j.moment_spread * stretch;
        magnitude += (j.mean + j.weight_spread) * leaf + (stretch + 2) * (j.moment.lpNorm<1>() + j.moment_spread);
        world = std::max(world, reach);
    }
    // Every leaf passes fewer than n + 24 roundings (norms and square roots included), each sum of leaves is below
    // `magnitude`, and 3 coordinates and the radius meet in a support: 4(n + 32)u leaves room for the rounding of
    // `magnitude`.
    const double n = static_cast<double>(bv.influence.size());
    double error = 0;
    if (rounding == Rounding::proven)
        error = succ(succ(4 * (n + 32) * unit_roundoff * magnitude + 64 * n * smallest_subnormal) +
                     evaluation_error(vertex_influences, world));
    for (std::size_t a = 0; a < axes.size(); ++a) {
        const int components = std::abs(axes[a][0]) + std::abs(axes[a][1]) + std::abs(axes[a][2]);
        for (std::size_t side = 0; side < 2; ++side) {
            double along = 0;
            for (std::size_t r = 0; r < 3; ++r)
                along += (side == 0 ? axes[a][r] : -axes[a][r]) * centre[r];
            double support = along + std::sqrt(components) * radius;
            if (rounding == Rounding::proven)
                support = succ(support + 3 * error);
            supports[2 * a + side] =
                support < infinite && magnitude < infinite && world < infinite ? support : infinite;
        }
    }
}

} // namespace cinch
