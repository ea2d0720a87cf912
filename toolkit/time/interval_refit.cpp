// SPDX-License-Identifier: Apache-2.0
#include "toolkit/time/interval_refit.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "toolkit/bounds/greatest_mean.hpp"
#include "toolkit/bounds/rounding.hpp"

namespace cinch {
namespace {

bool same(const std::vector<AffineMap>& x, const std::vector<AffineMap>& y)
{
    return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size() * sizeof(AffineMap)) == 0;
}

bool is_zero(const AffineMap& map)
{
    for (const auto& row : map.m)
        for (const double x : row)
            if (x != 0)
                return false;
    return true;
}

double infinite_unless(double x) { return x < infinite ? x : infinite; }

} // namespace

double greatest_between(double first, double last, double bump, double path)
{
    if (std::isnan(bump))
        bump = infinite;
    if (std::isnan(path))
        path = infinite;
    const double most = std::max(first, last), least = std::min(first, last);
    constexpr double most_safe = 0x1p1020; // no sum of the values below overflows
    if (!(most < most_safe && least > -most_safe) || std::isnan(first) || std::isnan(last))
        return infinite;
    // Each value below passes at most 7 roundings of what |first| + |last| + bump are the size of: the last term is at
    // most (last − first)/4, as last − first < 4 bump where it is taken. Halves, the quotient and the product by it
    // lose at most η/2 each besides.
    if (bump <= 0 || most - least >= 4 * bump)
        return succ(most);
    const double d = most - least;
    double parabola = (first + last) / 2 + bump + d * (d / bump / 16);
    parabola =
        std::max(most, parabola + (0x1p-49 * (std::abs(first) + std::abs(last) + bump) + 4 * smallest_subnormal));
    parabola = bump < most_safe ? infinite_unless(parabola) : infinite;
    const double way = std::min((first + last + path) / 2, least + path),
                 lipschitz =
                     infinite_unless(way + (0x1p-49 * (std::abs(first) + std::abs(last) + path) + smallest_subnormal));
    return succ(std::min(parabola, std::max(most, lipschitz)));
}

void merge_children(const Bvh& bvh, std::size_t k, std::span<double> supports)
{
    for (std::size_t i = bvh.bvs.size(); i-- > 0;) { // children come after parents
        if (bvh.bvs[i].is_leaf())
            continue;
        const std::size_t first = bvh.bvs[i].first_child * k;
        for (std::size_t d = 0; d < k; ++d)
            supports[i * k + d] = std::min(supports[i * k + d], std::max(supports[first + d], supports[first + k + d]));
    }
}

IntervalRefitter::IntervalRefitter(const Bvh& bvh, const DeformableSurface& surface, const RefitOptions& options,
                                   std::span<const MorphTarget> targets)
    : bvh_(bvh), kdop_(options.kdop), refit_(bvh, surface, options), morphs_(bvh, surface, targets)
{
    const std::size_t count = bvh.bvs.size() * static_cast<std::size_t>(kdop_);
    first_.resize(count);
    last_.resize(count);
    bend_.resize(count);
}

void IntervalRefitter::at(std::span<const AffineMap> maps, std::span<const double> weights, std::span<double> supports)
{
    refit_(maps, supports);
    if (const MorphBoxes::Term term{weights, maps}; !weights.empty())
        morphs_.add({&term, 1}, kdop_, supports);
    merge_children(bvh_, kdop(), supports);
}

void IntervalRefitter::operator()(const MotionInterval& motion, std::span<double> supports)
{
    if (supports.size() != first_.size())
        throw std::invalid_argument("supports has " + std::to_string(supports.size()) + " entries; the BVs need " +
                                    std::to_string(first_.size()));
    const MotionInterval::Morph& morph = motion.morph;
    if (same(last_maps_, motion.first) && last_weights_ == morph.first)
        first_.swap(last_);
    else
        at(motion.first, morph.first, first_);
    last_maps_.clear();
    at(motion.last, morph.last, last_);
    last_maps_ = motion.last;
    last_weights_ = morph.last;
    if (std::all_of(motion.bend.begin(), motion.bend.end(), is_zero))
        std::fill(bend_.begin(), bend_.end(), 0.0); // places move along straight lines
    else
        refit_(motion.bend, bend_);
    if (!morph.empty()) { // (T e)″ = T″e + 2T′e′ + T e″, e the displacements
        const MorphBoxes::Term terms[3] = {
            {morph.at[0], motion.bend}, {morph.at[1], morph.slope}, {morph.at[2], morph.still}};
        morphs_.add(terms, kdop_, bend_);
    }
    const auto axes = axes_of(kdop_);
    const auto k = static_cast<std::size_t>(kdop_);
    std::array<double, 13> norm; // of the axes; the first three are those of the coordinates, of length 1
    for (std::size_t a = 0; a < axes.size(); ++a)
        norm[a] = succ(std::sqrt(
            static_cast<double>(axes[a][0] * axes[a][0] + axes[a][1] * axes[a][1] + axes[a][2] * axes[a][2])));
    for (std::size_t i = 0; i < bvh_.bvs.size(); ++i) {
        const RestBv bv = bvh_.rest(i);
        // The greatest of each limit, and the mean of the remainder, which alone decides where all is well.
        MotionInterval::Limits most;
        for (const std::uint32_t j : bv.node) {
            const MotionInterval::Limits& of = motion.limits[j];
            most.bump = std::max(most.bump, of.bump);
            most.path = std::max(most.path, of.path);
            most.error = std::max(most.error, of.error);
            most.bend_error = std::max(most.bend_error, of.bend_error);
        }
        // Evaluation of a vertex of n influences rounds by (n + 8)u of what `error`, at least 2⁻⁴² of it, stands for.
        // So do displacements by (m + n + 16)u of four times it, m the targets; see MorphBoxes.
        const double evaluation = 1 + bv.vertex_influences / 256.0 +
                                  (morph.empty() ? 0 : static_cast<double>(morphs_.count(i) + bv.node.size()) / 256);
        const double remainder = greatest_mean(bv, [&](std::size_t j) { return motion.limits[bv.node[j]].remainder; }) +
                                 most.bend_error * evaluation,
                     bump = most.bump, path = most.path, error = most.error * evaluation;
        for (std::size_t d = 0; d < k; ++d) {
            const std::size_t at = i * k + d;
            auto scaled = [&](double x) { return d < 6 ? x : succ(norm[d / 2] * x); };
            const double s = std::min(succ(bend_[at] + scaled(remainder)), scaled(bump));
            supports[at] = greatest_between(succ(first_[at] + scaled(error)), succ(last_[at] + scaled(error)),
                                            std::isnan(s) ? scaled(bump) : s, scaled(path));
        }
    }
    merge_children(bvh_, k, supports);
}

} // namespace cinch
