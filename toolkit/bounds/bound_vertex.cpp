// SPDX-License-Identifier: Apache-2.0
#include "toolkit/bounds/bound_vertex.hpp"

#include "cinch/deform.hpp"
#include "toolkit/bounds/rounding.hpp"

namespace cinch {

void bound_vertex(const Vec3& rest, Weights::Row row, std::span<const AffineMap> maps, Rounding rounding,
                  std::span<const Axis> axes, std::span<double> supports) noexcept
{
    const Vec3 v = evaluate_vertex(rest, row, maps);
    Vec3 magnitude = Vec3::Zero(); // Σ_j w_j (Σ_s |A_rs x_s| + |t_r|), at most max_j M_j and with the same leaves
    for (std::size_t i = 0; i < row.node.size(); ++i) {
        const auto& m = maps[row.node[i]].m;
        for (int r = 0; r < 3; ++r)
            magnitude[r] +=
                row.weight[i] *
                (((std::abs(m[r][0] * rest[0]) + std::abs(m[r][1] * rest[1])) + std::abs(m[r][2] * rest[2])) +
                 std::abs(m[r][3]));
    }
    Vec3 error = Vec3::Zero();
    bool finite = true;
    for (int r = 0; r < 3; ++r) {
        if (rounding == Rounding::proven)
            error[r] = evaluation_error(static_cast<double>(row.node.size()), magnitude[r]);
        finite &= magnitude[r] < infinite && error[r] < infinite;
    }
    for (std::size_t a = 0; a < axes.size(); ++a)
        for (std::size_t side = 0; side < 2; ++side) {
            double sum = 0;
            for (std::size_t r = 0; r < 3; ++r) {
                const int sign = side == 0 ? axes[a][r] : -axes[a][r];
                if (sign == 0)
                    continue;
                const double coordinate = sign * v[static_cast<int>(r)];
                // Adding to 0 is exact; every other sum is rounded up.
                const double upper =
                    rounding == Rounding::proven ? succ(coordinate + error[static_cast<int>(r)]) : coordinate;
                sum = sum == 0 ? upper : rounding == Rounding::proven ? succ(sum + upper) : sum + upper;
            }
            supports[2 * a + side] = finite && sum < infinite ? sum : infinite;
        }
}

} // namespace cinch
