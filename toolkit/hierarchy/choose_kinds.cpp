// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <random>

#include <Eigen/Geometry>

#include "toolkit/bounds/rounding.hpp"
#include "toolkit/deform/parallel.hpp"
#include "toolkit/deform/per_thread.hpp"
#include "toolkit/hierarchy/packed_bvh.hpp"
#include "toolkit/hierarchy/spheres.hpp"

namespace cinch {
namespace {

constexpr int kdop = 6;
constexpr double cubic = 1;

// p → R (p + S p + Q(p, p) + C(p, p, p)) in units of the surface, R a rotation, S and Q small and random; value and
// Jacobian at each node. Without C, which is a share of Q times lengths, moments would be exact.
std::vector<AffineMap> synthetic_frame(std::span<const Vec3> node, const RestBox& box, double strength, double cubic,
                                       std::mt19937_64& random)
{
    const double unit = box.half.maxCoeff() > 0 ? box.half.maxCoeff() : 1;
    auto uniform = [&](double most) {
        return most * (static_cast<double>(random() >> 11) * 0x1p-52 - 1);
    }; // the same everywhere
    Eigen::Matrix3d strain, quadratic[3];
    for (int i = 0; i < 9; ++i)
        strain(i) = uniform(0.2);
    for (auto& q : quadratic)
        for (int i = 0; i < 9; ++i)
            q(i) = uniform(strength);
    const double z = uniform(1), y = uniform(1), x = uniform(1), w = uniform(1); // arguments have no order
    Eigen::Quaterniond rotation(w, x, y, z);
    rotation.normalize();
    Vec3 slope[3] = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
    for (Vec3& own : slope)
        for (int i = 0; i < 3 && cubic > 0; ++i)
            own[i] = uniform(cubic);
    const Eigen::Matrix3d r = rotation.toRotationMatrix();
    std::vector<AffineMap> maps;
    for (const Vec3& at : node) {
        const Vec3 p = (at - box.centre) / unit;
        Vec3 value = p + strain * p;
        Eigen::Matrix3d jacobian = Eigen::Matrix3d::Identity() + strain;
        for (int i = 0; i < 3; ++i) {
            const double square = p.dot(quadratic[i] * p), more = 1 + slope[i].dot(p);
            value[i] += more * square;
            jacobian.row(i) += (more * (quadratic[i] + quadratic[i].transpose()) * p + square * slope[i]).transpose();
        }
        value = r * value * unit;
        jacobian = r * jacobian;
        const Vec3 t = value - jacobian * at;
        AffineMap map;
        for (int i = 0; i < 3; ++i) {
            for (int s = 0; s < 3; ++s)
                map.m[i][s] = jacobian(i, s);
            map.m[i][3] = t[i];
        }
        maps.push_back(map);
    }
    return maps;
}

// Supports of every BV in every frame, and each BV's sum of them: a measure of width.
struct Trial {
    std::vector<double> supports, width; // [frame][bv][direction], [bv]
};

Trial attempt(const PackedBvh<double>& packed, std::span<const ProjectedMaps<double>> frames)
{
    const std::size_t all = packed.bvs.size() * kdop;
    Trial trial{std::vector<double>(frames.size() * all), std::vector<double>(packed.bvs.size(), 0.0)};
    PerThread<KernelScratch<double>> scratch;
    parallel_blocks(packed.bvs.size(), 64, [&](std::size_t first, std::size_t last) {
        for (std::size_t f = 0; f < frames.size(); ++f) {
            const auto supports = std::span(trial.supports).subspan(f * all + first * kdop, (last - first) * kdop);
            bound_packed<double>({packed.bvs, packed.node, packed.value, &frames[f], Rounding::proven, 1}, first, last,
                                 scratch.local(), supports);
            for (std::size_t i = 0; i < supports.size(); ++i)
                trial.width[first + i / kdop] += supports[i];
        }
    });
    return trial;
}

// About how many nanoseconds a bound of six sides takes in float; what it takes elsewhere is near a multiple of that.
double time_of(Method kind, const Bv& bv)
{
    const double n = bv.influence_count;
    return kind == Method::local     ? 100 + 3 * n
           : kind == Method::linear  ? 60 + 5 * n
           : kind == Method::support ? 80 + 8.5 * n
                                     : 250 + 13 * n;
}

// From the order of a packed tree without leaves to that of the BVs; leaves have nothing.
template <class T>
void spread(std::span<const std::uint32_t> place, const Bvh& bvh, std::size_t each, std::vector<T>& all)
{
    const std::size_t packed = all.size() / each;
    std::vector<T> out(bvh.bvs.size() * each, T(0));
    for (std::size_t i = 0; i < bvh.bvs.size(); ++i)
        if (!bvh.bvs[i].is_leaf() && place[i] < packed)
            std::copy_n(all.begin() + static_cast<std::ptrdiff_t>(place[i] * each), each,
                        out.begin() + static_cast<std::ptrdiff_t>(i * each));
    all = std::move(out);
}

// The start of λ that suits each BV best, for one kind, and what comes of it.
// BVs of the kind moments that have no rest data for it get nothing.
Trial calibrate(const Bvh& bvh, const DeformableSurface& surface, Method kind, MomentData& moments,
                std::span<const ProjectedMaps<double>> frames, std::vector<double>& start)
{
    ChosenKinds kinds{std::vector<ChosenKind>(bvh.bvs.size(), {kind, {}, 0, 0, false}), std::move(moments)};
    for (std::size_t i = 0; i < bvh.bvs.size() && kind == Method::moments; ++i)
        if (!kinds.moments.has(i))
            kinds.of[i].kind = Method::linear;
    PackedBvh<double> packed = pack<double>(bvh, surface, kinds, bvh.detail == RestDetail::all);
    moments = std::move(kinds.moments);
    const std::size_t bvs = packed.bvs.size();
    start.assign(bvs, 0.0);
    Trial best = attempt(packed, frames);
    for (const double candidate : {0.3, 0.5, 0.7, 0.8, 0.85, 0.9, 0.95, 1.0}) {
        if (kind == Method::linear)
            break; // no λ to start
        for (PackedBv<double>& bv : packed.bvs)
            bv.start = candidate;
        const Trial trial = attempt(packed, frames);
        for (std::size_t i = 0; i < bvs; ++i) {
            if (!(trial.width[i] < best.width[i]))
                continue;
            start[i] = candidate;
            best.width[i] = trial.width[i];
            for (std::size_t f = 0; f < frames.size(); ++f)
                std::copy_n(&trial.supports[(f * bvs + i) * kdop], kdop, &best.supports[(f * bvs + i) * kdop]);
        }
    }
    for (std::size_t i = 0; i < bvs && kind == Method::moments; ++i)
        if (packed.bvs[i].kind != kind) {
            best.width[i] = infinite;
            for (std::size_t f = 0; f < frames.size(); ++f)
                std::fill_n(&best.supports[(f * bvs + i) * kdop], kdop, infinite);
        }
    if (packed.place.empty())
        return best;
    spread<double>(packed.place, bvh, 1, start);
    spread<double>(packed.place, bvh, 1, best.width);
    std::vector<double> all;
    for (std::size_t f = 0; f < frames.size(); ++f) {
        const auto first = best.supports.begin() + static_cast<std::ptrdiff_t>(f * bvs * kdop);
        std::vector<double> frame(first, first + static_cast<std::ptrdiff_t>(bvs * kdop));
        spread<double>(packed.place, bvh, kdop, frame);
        all.insert(all.end(), frame.begin(), frame.end());
    }
    best.supports = std::move(all);
    return best;
}

} // namespace

ChosenKinds choose_kinds(const Bvh& bvh, const DeformableSurface& surface, Method method, RestShape shape,
                         KindPolicy policy)
{
    const bool box_only = box_methods.contains(method);
    ChosenKinds out{std::vector<ChosenKind>(bvh.bvs.size(), {method, {}, 0, 0, box_only && shape == RestShape::obb})};
    std::vector<ChosenKind>& chosen = out.of;
    if (bvh.bvs.empty() || box_only || method == Method::linear)
        return out;
    std::mt19937_64 random(20080101);
    const RestBox& root = bvh.bvs[0].box;
    const std::vector<Vec3> place = node_places(surface);
    std::vector<ProjectedMaps<double>> frames;
    for (const double strength : {0.3, 0.3, 0.9, 0.9})
        project<double>(synthetic_frame(place, root, strength, policy.most_moments > 0 ? cubic : 0, random),
                        rest_extent(bvh, surface), kdop, Rounding::proven, frames.emplace_back());

    const bool leaves = bvh.detail == RestDetail::all;
    if (method == Method::moments || method == Method::best)
        out.moments = rest_moments(bvh, surface, [&](const Bv& bv) {
            return (leaves || !bv.is_leaf()) &&
                   (method == Method::moments || bv.influence_count <= policy.most_moments);
        });
    if (method != Method::best) {
        std::vector<double> start;
        calibrate(bvh, surface, method, out.moments, frames, start);
        for (std::size_t i = 0; i < chosen.size(); ++i)
            chosen[i].start = start[i];
        return out;
    }
    const std::vector<Method> kinds = tightest_first(chosen_methods);
    std::vector<Trial> trial(kinds.size());
    std::vector<std::vector<double>> start(kinds.size());
    for (std::size_t k = 0; k < kinds.size(); ++k)
        trial[k] = calibrate(bvh, surface, kinds[k], out.moments, frames, start[k]);
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        auto both = [&](std::size_t a, std::size_t b) { // width of the intersection
            double width = 0;
            for (std::size_t f = 0; f < frames.size(); ++f)
                for (std::size_t d = 0; d < kdop; ++d) {
                    const std::size_t place_of = (f * bvh.bvs.size() + i) * kdop + d;
                    width += std::min(trial[a].supports[place_of], trial[b].supports[place_of]);
                }
            return width;
        };
        double least = infinite; // where no kind has a number, any does
        chosen[i] = {kinds.back(), {}, start.back()[i], 0, false, policy.guarded};
        const auto propose = [&](double width, double time, const ChosenKind& kind) {
            if (const double all = width * std::pow(time, -std::log2(policy.worth_twice)); all < least) {
                least = all;
                chosen[i] = kind;
            }
        };
        const auto time = [&](std::size_t k) { return policy.weighs_times ? time_of(kinds[k], bvh.bvs[i]) : 1; };
        for (std::size_t a = 0; a < kinds.size(); ++a)
            propose(trial[a].width[i], time(a), {kinds[a], {}, start[a][i], 0, false, policy.guarded});
        for (std::size_t a = 0; a < kinds.size(); ++a)
            for (std::size_t b = a + 1; b < kinds.size(); ++b)
                propose(both(a, b), time(a) + time(b),
                        {kinds[a], kinds[b], start[a][i], start[b][i], false, policy.guarded});
    }
    return out;
}

} // namespace cinch
