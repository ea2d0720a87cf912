// SPDX-License-Identifier: Apache-2.0
#include "toolkit/bounds/pack_moments.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "toolkit/bounds/pack_value.hpp"

namespace cinch {
namespace {

// Greatest |component| of all points and of the slack, as it is packed.
template <class T> Lifted put_points(const RestMoments& moments, AlignedVector<T>& value, std::span<T> slack)
{
    const std::size_t count = moments.point.size(), first = value.size();
    value.resize(first + (count + 1) / 2 * 2 * moment_point, T(0));
    Lifted reach;
    for (std::size_t c = 0; c < lifted_size; ++c) {
        const double middle = 0.5 * moments.least[c] + 0.5 * moments.greatest[c];
        const double about = std::max(moments.greatest[c] - middle, middle - moments.least[c]);
        double moved = 0, most = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const double exactly = moments.point[i][c] + middle;
            const T packed = static_cast<T>(exactly);
            for (std::size_t p = i; p < (i + 1 == count ? (count + 1) / 2 * 2 : i + 1); ++p)
                value[first + p * moment_point + moment_place[c]] = packed;
            const double off = std::abs(exactly - static_cast<double>(packed)), // exact: 0, or of neighbours
                rounding = middle == 0 ? 0 : succ(unit_roundoff * std::abs(exactly));
            moved = std::max(moved, sum_up(off, rounding));
            most = std::max(most, std::abs(static_cast<double>(packed)));
        }
        slack[moment_place[c]] = round_up<T>(sum_up(about == 0 ? 0 : succ(about), moved));
        reach[c] = most + static_cast<double>(slack[moment_place[c]]);
    }
    return reach;
}

// Greatest of |x_s| / of_s; 0 / 0 is 0.
template <class Values> double greatest_share(const Values& x, const Vec3& of)
{
    double most = 0;
    for (int s = 0; s < 3; ++s)
        if (const double own = std::abs(static_cast<double>(x[s])); own > 0)
            most = std::max(most, own / of[s]);
    return most;
}

} // namespace

template <class T> void pack_moments(const RestBv& rest, const RestMoments& moments, std::span<const double> means,
                                     const RestExtent& extent, PackedBv<T>& bv, AlignedVector<T>& value)
{
    const Vec3& reach = extent.about_origin;
    bool exact = true;
    const auto put_exactly = [&](double x, T& to) {
        to = static_cast<T>(x);
        exact &= static_cast<double>(to) == x;
    };
    for (int s = 0; s < 3; ++s) {
        put_exactly(moments.centre[s] - extent.origin[s], bv.pivot[s]);
        exact &= extent.origin[s] + static_cast<double>(bv.pivot[s]) == moments.centre[s];
    }
    bv.points = static_cast<std::uint32_t>(moments.point.size());
    T slack[moment_point] = {};
    const Lifted lifted = put_points<T>(moments, value, slack);
    const std::size_t head = value.size();
    value.resize(head + moment_head, T(0));
    std::copy_n(slack, moment_point, &value[head + moment_head_slack]);

    Vec3 gradients = Vec3::Zero(), places = Vec3::Zero(), levers = Vec3::Zero(), halves = Vec3::Zero();
    Eigen::Matrix3d second[4] = {Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Zero(),
                                 Eigen::Matrix3d::Zero()};
    for (std::size_t j = 0; j < rest.node.size(); ++j) {
        const MomentInfluence& influence = moments.influence[j];
        T own[moment_values] = {};
        own[moment_mean] = static_cast<T>(means[j]);
        put_interval(rest.space.l[j], rest.space.h[j], own[moment_l], own[moment_r], bv.sum_l, bv.sum_r);
        T box[6];
        put_box(rest.local[j], extent.origin, box, box + 3);
        for (std::size_t s = 0; s < 3; ++s) {
            const auto i = static_cast<int>(s);
            own[s] = static_cast<T>(influence.gradient[i]);
            put_exactly(influence.place[i], own[moment_z + s]);
            own[moment_box + s] = box[s];
            own[moment_box + 4 + s] = box[3 + s];
            gradients[i] += std::abs(static_cast<double>(own[s]));
            places[i] = std::max(places[i], std::abs(influence.place[i]));
            levers[i] =
                std::max(levers[i], 0.5 * moments.unit * std::abs(influence.place[i]) +
                                        std::abs(static_cast<double>(bv.pivot[s]) - static_cast<double>(box[s])));
            halves[i] = std::max(halves[i], static_cast<double>(box[3 + s]));
        }
        const Eigen::Matrix3d own_second = 0.5 * moments.unit * influence.place * influence.place.transpose();
        for (int s = 0; s < 3; ++s)
            second[s] += influence.gradient[s] * own_second;
        second[3] += means[j] * own_second;
        value.insert(value.end(), own, own + moment_values);
    }
    put_exactly(1 / moments.unit, value[head + moment_head_reach + 3]);
    MomentReach of;
    for (std::size_t s = 0; s < 4; ++s)
        for (std::size_t a = 0; a < 3; ++a) {
            T* const row = &value[head + (s < 3 ? moment_head_g + 12 * s : moment_head_phi) + 4 * a];
            for (std::size_t b = 0; b < 3; ++b)
                row[b] = static_cast<T>(second[s](static_cast<int>(a), static_cast<int>(b)) +
                                        (a == s ? static_cast<double>(bv.pivot[b]) : 0));
            row[3] = a == s ? T(1) : T(0);
            of.row[s][a] = greatest_share(row, reach) + static_cast<double>(row[3]);
        }
    for (std::size_t s = 0; s < 3; ++s) {
        const auto i = static_cast<int>(s);
        value[head + moment_head_reach + s] = round_up<T>(places[i]);
        of.gradient[s] = gradients[i];
        of.place[s] = places[i];
        of.first[s] = lifted[s] / moments.unit + lifted[3 + s];
        of.second[s] = greatest_share(&lifted[6 + 3 * s], reach);
    }
    of.centre = greatest_share(bv.pivot, reach);
    of.d = greatest_share(&lifted[0], reach);
    of.lever = greatest_share(levers, reach);
    of.half = greatest_share(halves, reach);
    bv.error_factor = exact ? round_up<T>(moment_error_factor(of)) : std::numeric_limits<T>::infinity();
}

template void pack_moments(const RestBv&, const RestMoments&, std::span<const double>, const RestExtent&,
                           PackedBv<float>&, AlignedVector<float>&);
template void pack_moments(const RestBv&, const RestMoments&, std::span<const double>, const RestExtent&,
                           PackedBv<double>&, AlignedVector<double>&);

} // namespace cinch
