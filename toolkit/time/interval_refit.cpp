// SPDX-License-Identifier: Apache-2.0
#include "toolkit/time/interval_refit.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "toolkit/bounds/greatest_mean.hpp"
#include "toolkit/bounds/rounding.hpp"
#include "toolkit/deform/parallel.hpp"

namespace cinch {
namespace {

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

bool is_near(std::span<const double> supports, std::span<const double> instants, double share)
{
    double squares = 0, excess = 0;
    for (std::size_t a = 0; a < 3; ++a) {
        const double half = (instants[2 * a] + instants[2 * a + 1]) / 2,
                     over =
                         std::max({0.0, supports[2 * a] - instants[2 * a], supports[2 * a + 1] - instants[2 * a + 1]});
        squares += half * half;
        excess += over * over;
    }
    const double room = share > 0 ? share * std::sqrt(squares) : 0;
    for (std::size_t d = 6; d < instants.size(); ++d) // unit axes are the shortest
        if (supports[d] > instants[d] + room)
            return false;
    return std::isinf(room) || std::sqrt(excess) <= room;
}

IntervalRefitter::IntervalRefitter(const Bvh& bvh, const DeformableSurface& surface, const RefitOptions& options,
                                   std::span<const MorphTarget> targets)
    : bvh_(bvh), kdop_(options.kdop), bounder_(bvh, surface, options, Bounder::Leaves::included),
      morphs_(bvh, surface, targets), all_(bvh.bvs.size()), place_(bvh.bvs.size())
{
    std::iota(all_.begin(), all_.end(), 0u);
    for (const Axis& axis : axes_of(kdop_)) // the first three are those of the coordinates, of length 1
        norm_.push_back(
            succ(std::sqrt(static_cast<double>(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]))));
}

void IntervalRefitter::refit(BvList bvs, std::span<const AffineMap> maps, std::span<double> supports)
{
    bounder_.begin(maps);
    parallel_blocks(bvs.size(), 64, [&](std::size_t first, std::size_t last) {
        while (first < last) { // neighbours together
            std::size_t end = first + 1;
            while (end < last && bvs[end] == bvs[end - 1] + 1)
                ++end;
            bounder_.bound(bvs[first], bvs[end - 1] + 1, supports.subspan(first * kdop(), (end - first) * kdop()));
            first = end;
        }
    });
}

void IntervalRefitter::merge_children(BvList bvs, std::span<double> supports)
{
    const std::size_t k = kdop();
    for (std::size_t n = bvs.size(); n-- > 0;) { // children come after parents
        place_[bvs[n]] = static_cast<std::uint32_t>(n);
        const Bv& bv = bvh_.bvs[bvs[n]];
        if (bv.is_leaf())
            continue;
        const double* one = &supports[place_[bv.first_child] * k];
        const double* other = &supports[place_[bv.first_child + 1] * k];
        for (std::size_t d = 0; d < k; ++d)
            supports[n * k + d] = std::min(supports[n * k + d], std::max(one[d], other[d]));
    }
}

InstantBounds IntervalRefitter::at(BvList bvs, std::vector<AffineMap> maps, std::vector<double> weights)
{
    InstantBounds out{std::move(maps), std::move(weights), std::vector<double>(bvs.size() * kdop())};
    refit(bvs, out.maps, out.supports);
    if (const MorphBoxes::Term term{out.weights, out.maps}; !out.weights.empty())
        morphs_.add({&term, 1}, kdop_, bvs, out.supports);
    merge_children(bvs, out.supports);
    return out;
}

// Evaluation of a vertex of n influences rounds by (n + 8)u of what an interval's `error`, at least 2⁻⁴² of it, stands
// for. So do displacements by (m + n + 16)u of four times it, m the targets; see MorphBoxes.
double IntervalRefitter::evaluation(std::uint32_t bv, bool morphs) const
{
    const Bv& of = bvh_.bvs[bv];
    return 1 + of.vertex_influences / 256.0 +
           (morphs ? static_cast<double>(morphs_.count(bv) + of.influence_count) / 256 : 0);
}

void IntervalRefitter::require(BvList bvs, const InstantBounds& first, const InstantBounds& last,
                               std::span<double> supports) const
{
    if (supports.size() != bvs.size() * kdop() || first.supports.size() != supports.size() ||
        last.supports.size() != supports.size())
        throw std::invalid_argument("an interval needs " + std::to_string(kdop()) + " supports per BV");
}

void IntervalRefitter::operator()(BvList bvs, const MotionSpan& motion, const InstantBounds& first,
                                  const InstantBounds& last, std::span<double> supports)
{
    const std::size_t k = kdop();
    require(bvs, first, last, supports);
    for (std::size_t n = 0; n < bvs.size(); ++n) {
        const RestBv bv = bvh_.rest(bvs[n]);
        double error = 0;
        for (const std::uint32_t j : bv.node)
            error = std::max(error, motion.error[j]);
        error *= evaluation(bvs[n], false);
        for (std::size_t d = 0; d < k; ++d) {
            const std::size_t at = n * k + d;
            const double wider = d < 6 ? error : succ(norm_[d / 2] * error);
            auto mean = [&](const std::vector<double>& of) {
                return greatest_mean(bv, [&](std::size_t j) { return of[bv.node[j] * k + d]; });
            };
            supports[at] =
                succ(greatest_between(succ(first.supports[at] + wider), succ(last.supports[at] + wider),
                                      mean(motion.rise), infinite) + // where a curve jumps no path is long enough
                     mean(motion.bump));
        }
    }
    merge_children(bvs, supports);
}

void IntervalRefitter::operator()(BvList bvs, const MotionInterval& motion, const InstantBounds& first,
                                  const InstantBounds& last, double enough, std::span<double> supports)
{
    const std::size_t k = kdop();
    require(bvs, first, last, supports);
    // The bound of the n-th BV, of its bump along axis a.
    auto bound = [&](std::size_t n, const MotionInterval::Limits& most, auto&& bump) {
        for (std::size_t d = 0; d < k; ++d) {
            const std::size_t at = n * k + d;
            auto scaled = [&](double x) { return d < 6 ? x : succ(norm_[d / 2] * x); };
            supports[at] =
                greatest_between(succ(first.supports[at] + scaled(most.error)),
                                 succ(last.supports[at] + scaled(most.error)), bump(d, scaled), scaled(most.path));
        }
    };
    // Whether by its bump alone it is near enough to both ends.
    auto is_settled = [&](std::size_t n, double bump) {
        const double* a = &first.supports[n * k];
        const double* b = &last.supports[n * k];
        double squares = 0;
        for (std::size_t d = 0; d < 6; d += 2) {
            const double width = std::max(a[d], b[d]) + std::max(a[d + 1], b[d + 1]);
            squares += width * width;
        }
        // (4s − |F_b − F_a|)²/(16 s) above the greater end, along three axes; others are about as long.
        const double room = enough * std::sqrt(squares / 12) * 16 * bump;
        for (std::size_t d = 0; d < k; ++d) {
            const double more = 4 * bump - std::abs(b[d] - a[d]);
            if (!(more <= 0 || (more * more <= room && bump < infinite)))
                return false;
        }
        return true;
    };
    std::vector<MotionInterval::Limits> limits; // of those that are not
    std::vector<std::uint32_t> loose, place;    // BVs, and where they are listed
    for (std::size_t n = 0; n < bvs.size(); ++n) {
        MotionInterval::Limits most; // the greatest of each, which alone decide where all is well
        for (const std::uint32_t j : bvh_.rest(bvs[n]).node) {
            const MotionInterval::Limits& of = motion.limits[j];
            most.bump = std::max(most.bump, of.bump);
            most.path = std::max(most.path, of.path);
            most.error = std::max(most.error, of.error);
            most.bend_error = std::max(most.bend_error, of.bend_error);
        }
        const double evaluation = this->evaluation(bvs[n], !motion.morph.empty());
        most.error *= evaluation;
        most.bend_error *= evaluation;
        if (is_settled(n, most.bump)) {
            bound(n, most, [&](std::size_t, auto&& scaled) { return scaled(most.bump); });
        } else {
            limits.push_back(most);
            loose.push_back(bvs[n]);
            place.push_back(static_cast<std::uint32_t>(n));
        }
    }
    std::vector<double> bend(loose.size() * k, 0.0);
    if (!loose.empty() &&
        !std::all_of(motion.bend.begin(), motion.bend.end(), is_zero)) // else places move along straight lines
        refit(loose, motion.bend, bend);
    if (const MotionInterval::Morph& morph = motion.morph; !morph.empty()) {
        // (T e)″ = T″e + 2T′e′ + T e″, e the displacements
        const MorphBoxes::Term terms[3] = {
            {morph.at[0], motion.bend}, {morph.at[1], morph.slope}, {morph.at[2], morph.still}};
        morphs_.add(terms, kdop_, loose, bend);
    }
    for (std::size_t i = 0; i < loose.size(); ++i) {
        const RestBv bv = bvh_.rest(loose[i]);
        const MotionInterval::Limits& most = limits[i];
        const double remainder =
            greatest_mean(bv, [&](std::size_t j) { return motion.limits[bv.node[j]].remainder; }) + most.bend_error;
        bound(place[i], most, [&](std::size_t d, auto&& scaled) {
            const double s = std::min(succ(bend[i * k + d] + scaled(remainder)), scaled(most.bump));
            return std::isnan(s) ? scaled(most.bump) : s;
        });
    }
    merge_children(bvs, supports);
}

} // namespace cinch
