// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/pin.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace cinch {
namespace {

double no_turn(double, double) { return 0; }

} // namespace

double Turning::angle(double t) const
{
    if (period_s > 0)
        return most * std::sin(2 * std::numbers::pi * t / period_s);
    const double a = t < ramp_s ? 0.5 * rate * t * t / ramp_s : rate * (t - 0.5 * ramp_s);
    return most > 0 ? std::clamp(a, -most, most) : a;
}

Vec3 Turning::apply(const Vec3& p, double t) const
{
    return centre + Eigen::AngleAxisd(angle(t), axis.normalized()) * (p - centre);
}

Pin fixed_pin(std::vector<std::uint32_t> nodes, std::vector<Vec3> start)
{
    return {std::move(nodes), [start = std::move(start)](std::size_t k, double) { return start[k]; }, no_turn};
}

Pin turning_pin(std::vector<std::uint32_t> nodes, std::vector<Vec3> start, const Turning& turning)
{
    return {std::move(nodes),
            [start = std::move(start), turning](std::size_t k, double t) { return turning.apply(start[k], t); },
            [turning](double from, double to) { return std::abs(turning.angle(to) - turning.angle(from)); }};
}

Pin sliding_pin(std::vector<std::uint32_t> nodes, std::vector<Vec3> start, const Vec3& velocity, double end_s)
{
    return {std::move(nodes),
            [start = std::move(start), velocity, end_s](std::size_t k, double t) {
                return Vec3(start[k] + std::min(t, end_s) * velocity);
            },
            no_turn};
}

} // namespace cinch
