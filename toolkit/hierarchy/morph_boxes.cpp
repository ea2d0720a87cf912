// SPDX-License-Identifier: Apache-2.0
#include "toolkit/hierarchy/morph_boxes.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "toolkit/bounds/greatest_mean.hpp"
#include "toolkit/bounds/rounding.hpp"

namespace cinch {
namespace {

struct Range {
    Vec3 low = Vec3::Constant(infinite), high = Vec3::Constant(-infinite);
    std::size_t displaced = 0; // vertices
};

// The box of a vertex's displacement, rounded outward.
Vec3 highest(const MorphTarget& target, std::size_t n)
{
    Vec3 out = target.displacement[n];
    if (!target.half.empty())
        for (int c = 0; c < 3; ++c)
            out[c] = succ(out[c] + target.half[n][c]);
    return out;
}
Vec3 lowest(const MorphTarget& target, std::size_t n)
{
    Vec3 out = target.displacement[n];
    if (!target.half.empty())
        for (int c = 0; c < 3; ++c)
            out[c] = -succ(target.half[n][c] - out[c]);
    return out;
}

} // namespace

MorphBoxes::MorphBoxes(const Bvh& bvh, const DeformableSurface& surface, std::span<const MorphTarget> targets)
    : bvh_(bvh)
{
    struct Displacement {
        std::uint32_t target;
        Vec3 low, high;
    };
    std::vector<std::vector<Displacement>> of(surface.mesh.vertices.size());
    for (std::uint32_t i = 0; i < targets.size(); ++i)
        for (std::size_t n = 0; n < targets[i].vertex.size(); ++n) {
            if (targets[i].vertex[n] >= of.size() || (n > 0 && targets[i].vertex[n] <= targets[i].vertex[n - 1]))
                throw std::invalid_argument("morph targets: vertices of the surface are needed, each once, ascending");
            of[targets[i].vertex[n]].push_back({i, lowest(targets[i], n), highest(targets[i], n)});
        }
    std::vector<Range> range(targets.size());
    std::vector<std::uint32_t> met;
    for (const Bv& bv : bvh.bvs) {
        const std::vector<std::uint32_t> vertices = vertices_of(surface, bvh, bv);
        met.clear();
        for (const std::uint32_t v : vertices)
            for (const Displacement& d : of[v]) {
                Range& r = range[d.target];
                if (r.displaced++ == 0)
                    met.push_back(d.target);
                r.low = r.low.cwiseMin(d.low);
                r.high = r.high.cwiseMax(d.high);
            }
        std::sort(met.begin(), met.end());
        for (const std::uint32_t i : met) {
            Range& r = range[i];
            if (r.displaced < vertices.size()) { // the others stay
                r.low = r.low.cwiseMin(Vec3::Zero());
                r.high = r.high.cwiseMax(Vec3::Zero());
            }
            const Vec3 centre = 0.5 * r.low + 0.5 * r.high;
            Vec3 half;
            for (int c = 0; c < 3; ++c)
                half[c] = succ(std::max(r.high[c] - centre[c], centre[c] - r.low[c]));
            target_.push_back(i);
            centre_.push_back(centre);
            half_.push_back(half);
            r = {};
        }
        row_.push_back(static_cast<std::uint32_t>(target_.size()));
    }
}

void MorphBoxes::add(std::span<const Term> terms, int kdop, std::span<double> supports) const
{
    const auto k = static_cast<std::size_t>(kdop);
    std::vector<double> scratch;
    for (std::size_t i = 0; i < bvh_.bvs.size(); ++i)
        add(terms, axes_of(kdop), i, scratch, supports.subspan(i * k, k));
}

void MorphBoxes::add(std::span<const Term> terms, int kdop, std::span<const std::uint32_t> bvs,
                     std::span<double> supports) const
{
    const auto k = static_cast<std::size_t>(kdop);
    std::vector<double> scratch;
    for (std::size_t n = 0; n < bvs.size(); ++n)
        add(terms, axes_of(kdop), bvs[n], scratch, supports.subspan(n * k, k));
}

// `reach`: of each simulation node of the BV along each direction.
void MorphBoxes::add(std::span<const Term> terms, std::span<const Axis> axes, std::size_t i, std::vector<double>& reach,
                     std::span<double> supports) const
{
    if (row_[i] == row_[i + 1])
        return;
    const std::size_t k = 2 * axes.size();
    const RestBv bv = bvh_.rest(i);
    reach.assign(bv.node.size() * k, 0.0);
    bool any = false;
    for (const Term& term : terms) {
        Vec3 centre = Vec3::Zero(), half = Vec3::Zero();
        for (std::uint32_t n = row_[i]; n < row_[i + 1]; ++n) {
            const double a = term.weight[target_[n]];
            if (a == 0)
                continue;
            centre += a * centre_[n];
            half += std::abs(a) * half_[n];
            any = true;
        }
        if (half.isZero(0) && centre.isZero(0))
            continue;
        for (std::size_t j = 0; j < bv.node.size(); ++j) {
            const auto& m = term.maps[bv.node[j]].m;
            for (std::size_t a = 0; a < k / 2; ++a) {
                double along = 0, around = 0;
                for (int c = 0; c < 3; ++c) {
                    const double g = axes[a][0] * m[0][c] + axes[a][1] * m[1][c] + axes[a][2] * m[2][c];
                    along += g * centre[c];
                    around += std::abs(g) * half[c];
                }
                reach[j * k + 2 * a] += around + along;
                reach[j * k + 2 * a + 1] += around - along;
            }
        }
    }
    for (std::size_t d = 0; any && d < k; ++d) {
        double least = infinite;
        bool finite = true;
        for (std::size_t j = 0; j < bv.node.size(); ++j) {
            const double c = reach[j * k + d];
            finite = finite && std::isfinite(c);
            least = std::min(least, c);
        }
        const double mean = // weights sum to 1
            finite ? least + greatest_mean(bv, [&](std::size_t j) { return reach[j * k + d] - least; }) : infinite;
        const double sum = succ(supports[d] + mean);
        supports[d] = std::abs(sum) < infinite ? sum : infinite; // what is no number hides nothing
    }
}

void MorphBoxes::add_error(const Term& term, double farthest, int kdop, std::span<double> supports) const
{
    const auto k = static_cast<std::size_t>(kdop);
    const auto axes = axes_of(kdop);
    std::vector<double> row_sum, shift; // ‖A_j‖∞, ‖t_j‖∞
    row_sum.reserve(term.maps.size());
    shift.reserve(term.maps.size());
    for (const AffineMap& map : term.maps) {
        double most = 0;
        for (const auto& row : map.m)
            most = std::max(most, (std::abs(row[0]) + std::abs(row[1])) + std::abs(row[2]));
        row_sum.push_back(most);
        shift.push_back(std::max({std::abs(map.m[0][3]), std::abs(map.m[1][3]), std::abs(map.m[2][3])}));
    }
    constexpr double least = 0x1p-1022; // products that underflow are off by less
    for (std::size_t i = 0; i < bvh_.bvs.size(); ++i) {
        double displaced = 0;
        bool any = false;
        for (std::uint32_t n = row_[i]; n < row_[i + 1]; ++n)
            if (const double a = std::abs(term.weight[target_[n]]); a != 0) {
                displaced += a * (centre_[n].cwiseAbs() + half_[n]).maxCoeff();
                any = true;
            }
        if (!any)
            continue;
        const RestBv bv = bvh_.rest(i);
        double size = 0, away = 0;
        for (const std::uint32_t j : bv.node) {
            size = std::max(size, row_sum[j]);
            away = std::max(away, shift[j]);
        }
        // What is computed of displaced vertices may overflow on its way where nothing of the sum does.
        const bool in_range = farthest + displaced < 0x1p1020 && size * (farthest + displaced) + away < 0x1p1020;
        const double factor =
            8 * (static_cast<double>(count(i)) + static_cast<double>(bv.node.size()) + 16) * unit_roundoff;
        const double coordinate = factor * (size * (farthest + displaced + least) + least);
        for (std::size_t d = 0; d < k; ++d) {
            const Axis& axis = axes[d / 2];
            const double own = (std::abs(axis[0]) + std::abs(axis[1]) + std::abs(axis[2])) * coordinate;
            double& support = supports[i * k + d];
            support = succ(support + own);
            if (!in_range || !(support < infinite))
                support = infinite;
        }
    }
}

} // namespace cinch
