// SPDX-License-Identifier: Apache-2.0
#include "toolkit/deform/motion.hpp"

#include "cinch/environment.hpp"

#include <cmath>
#include <memory>

#include <Eigen/Geometry>

namespace cinch {
namespace {

using Mat3 = Eigen::Matrix3d;

struct Jet { // a point and how it depends on the rest point
    Vec3 value;
    Mat3 jacobian = Mat3::Identity();

    void then(const Vec3& to, const Mat3& derivative)
    {
        value = to;
        jacobian = derivative * jacobian;
    }
};

void twist(Jet& p, double amount)
{
    const double rate = 1.2 * amount, c = std::cos(rate * p.value.z()), s = std::sin(rate * p.value.z());
    const Vec3 to(c * p.value.x() - s * p.value.y(), s * p.value.x() + c * p.value.y(), p.value.z());
    Mat3 d;
    d << c, -s, -rate * to.y(), //
        s, c, rate * to.x(),    //
        0, 0, 1;
    p.then(to, d);
}

double sinc(double x) { return x == 0 ? 1 : std::sin(x) / x; }

void bend(Jet& p, double amount)
{
    // ((R + z) sin φ, y, (R + z) cos φ − R) with R = 1/rate, written without R so that no bend is no special case.
    const double rate = 0.9 * amount, x = p.value.x(), z = p.value.z(), phi = rate * x;
    const double s = std::sin(phi), c = std::cos(phi);
    const Vec3 to(x * sinc(phi) + z * s, p.value.y(), z * c - x * std::sin(phi / 2) * sinc(phi / 2));
    Mat3 d;
    d << c + rate * z * c, 0, s, //
        0, 1, 0,                 //
        -s - rate * z * s, 0, c;
    p.then(to, d);
}

void pull(Jet& p, double amount)
{
    const Vec3 direction(0.6, 0.8, 0.3), from_centre = p.value - Vec3(1.2, 0, 0);
    const double strength = 0.8 * amount * std::exp(-4 * from_centre.squaredNorm());
    const Mat3 d = Mat3::Identity() - 8 * strength * direction * from_centre.transpose();
    p.then(p.value + strength * direction, d);
}

void rotate(Jet& p, double angle)
{
    const Mat3 r = Eigen::AngleAxisd(angle, Vec3(1, 1, 0.5).normalized()).toRotationMatrix();
    p.then(r * p.value, r);
}

} // namespace

std::optional<Motion> named_motion(std::string_view name)
{
    if (name == "strong")
        return Motion{1, 1, 1, 0};
    if (name == "mild")
        return Motion{0.3, 0.3, 0.3, 0.7};
    if (name == "twist")
        return Motion{1, 0, 0, 0};
    if (name == "bend")
        return Motion{0, 1, 0, 0};
    if (name == "pull")
        return Motion{0, 0, 1, 0};
    if (name == "rotate")
        return Motion{0, 0, 0, 1};
    return std::nullopt;
}

AffineMap linearise(const Motion& motion, const Vec3& p)
{
    Jet jet{p};
    twist(jet, motion.twist);
    bend(jet, motion.bend);
    pull(jet, motion.pull);
    rotate(jet, motion.rotate);
    const Vec3 t = jet.value - jet.jacobian * p;
    AffineMap map;
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c)
            map.m[r][c] = jet.jacobian(r, c);
        map.m[r][3] = t[r];
    }
    return map;
}

Clip scripted_clip(const Motion& motion, std::span<const Vec3> nodes, std::size_t frames)
{
    require_default_arithmetic();
    auto share = [frames](std::size_t f) {
        return frames == 1 ? 1.0 : static_cast<double>(f) / static_cast<double>(frames - 1);
    };
    auto frame = [motion, share,
                  places = std::make_shared<const std::vector<Vec3>>(nodes.begin(), nodes.end())](std::size_t f) {
        const double s = share(f);
        const Motion now{s * motion.twist, s * motion.bend, s * motion.pull, s * motion.rotate};
        Clip::Frame maps;
        maps.reserve(places->size());
        for (const Vec3& p : *places)
            maps.push_back(linearise(now, p));
        return maps;
    };
    return {"scripted", frames, share, frame};
}

} // namespace cinch
