// SPDX-License-Identifier: Apache-2.0
#include "toolkit/surface/shapes.hpp"

#include "cinch/environment.hpp"
#include "toolkit/surface/triangle_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace cinch {
namespace {

// Isotropic band-limited noise: plane waves of one wavelength in golden-angle directions. Its zero set is a labyrinth.
double labyrinth(const Vec3& p, double frequency)
{
    constexpr int waves = 24;
    const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
    double sum = 0;
    for (int i = 0; i < waves; ++i) {
        const double z = 1 - (2 * i + 1.0) / waves, r = std::sqrt(1 - z * z), phi = golden * i;
        const Vec3 direction(r * std::cos(phi), r * std::sin(phi), z);
        sum += std::sin(frequency * direction.dot(p) + 2.399 * i * i);
    }
    return sum / std::sqrt(waves / 2.0); // unit variance
}

double bump(double x, double width) { return std::exp(-(x / width) * (x / width)); }

struct Capsule {
    Vec3 from, to;
    double from_radius, to_radius;
};

double distance(const Capsule& c, const Vec3& p)
{
    const Vec3 axis = c.to - c.from;
    const double s = std::clamp((p - c.from).dot(axis) / axis.squaredNorm(), 0.0, 1.0);
    return (p - c.from - s * axis).norm() - (c.from_radius + s * (c.to_radius - c.from_radius));
}

// Union with a fillet of radius about `blend`.
double smooth_union(double a, double b, double blend)
{
    const double h = std::max(blend - std::abs(a - b), 0.0) / blend;
    return std::min(a, b) - 0.25 * h * h * blend;
}

double ellipsoid(const Vec3& p, const Vec3& centre, const Vec3& radii)
{
    const Vec3 q = (p - centre).cwiseQuotient(radii);
    const double k = q.norm(), g = q.cwiseQuotient(radii).norm();
    return g > 0 ? k * (k - 1) / g : -radii.minCoeff();
}

} // namespace

TriangleMesh brain(std::size_t vertices)
{
    TriangleMesh mesh = ring_sphere(vertices);
    for (Vec3& v : mesh.vertices) {
        const Vec3 d = v;
        const double sulcus = bump(labyrinth(d, 13), 0.38);              // narrow winding grooves
        const double swelling = 0.035 * labyrinth(d + Vec3(3, 1, 2), 4); // lobes
        const double fissure = bump(d.y(), 0.07) * std::clamp(0.6 + d.z(), 0.0, 1.0);
        const double temporal = 0.16 * bump((d - Vec3(0.35, 0.75, -0.55)).norm(), 0.45) +
                                0.16 * bump((d - Vec3(0.35, -0.75, -0.55)).norm(), 0.45);
        const double radius = 1 + swelling + temporal - 0.17 * sulcus * (1 - fissure) - 0.30 * fissure;
        v = radius * d.cwiseProduct(Vec3(1.0, 0.82, 0.72));
    }
    return mesh;
}

TriangleMesh santa(std::size_t vertices)
{
    const Capsule limbs[] = {
        {{0, 0, 0.25}, {0, 0, 0.78}, 0.18, 0.20},           // neck and head
        {{0.02, 0, 0.85}, {-0.12, 0, 1.25}, 0.17, 0.05},    // cap
        {{0, 0.25, 0.25}, {0.12, 0.78, -0.10}, 0.15, 0.12}, // arms
        {{0, -0.25, 0.25}, {0.12, -0.78, -0.10}, 0.15, 0.12},
        {{0, 0.18, -0.35}, {0.03, 0.36, -0.98}, 0.19, 0.14}, // legs
        {{0, -0.18, -0.35}, {0.03, -0.36, -0.98}, 0.19, 0.14},
        {{0.03, 0.36, -1.0}, {0.24, 0.38, -1.04}, 0.13, 0.10}, // feet
        {{0.03, -0.36, -1.0}, {0.24, -0.38, -1.04}, 0.13, 0.10},
    };
    TriangleMesh mesh = ring_sphere(vertices);
    wrap(mesh, [&](const Vec3& p) {
        double d = ellipsoid(p, Vec3(0.02, 0, -0.05), Vec3(0.40, 0.42, 0.48));
        for (const Capsule& limb : limbs)
            d = smooth_union(d, distance(limb, p), 0.15);
        return d;
    });
    return mesh;
}

TriangleMesh fish(std::size_t vertices)
{
    TriangleMesh mesh = ring_sphere(vertices);
    wrap(mesh, [](const Vec3& p) {
        double d = ellipsoid(p, Vec3(0.10, 0, 0), Vec3(0.85, 0.24, 0.36));
        d = smooth_union(d, distance(Capsule{{-0.4, 0, 0}, {-0.85, 0, 0}, 0.16, 0.10}, p), 0.15);
        d = smooth_union(d, ellipsoid(p, Vec3(-0.98, 0, 0), Vec3(0.22, 0.06, 0.38)), 0.12);       // tail
        d = smooth_union(d, ellipsoid(p, Vec3(0.05, 0, 0.38), Vec3(0.30, 0.06, 0.20)), 0.10);     // back fin
        d = smooth_union(d, ellipsoid(p, Vec3(0.35, 0.28, -0.12), Vec3(0.16, 0.22, 0.06)), 0.10); // side fins
        d = smooth_union(d, ellipsoid(p, Vec3(0.35, -0.28, -0.12), Vec3(0.16, 0.22, 0.06)), 0.10);
        return d;
    });
    return mesh;
}

namespace {

struct Shape {
    const char* name;
    TriangleMesh (*make)();
};

TriangleMesh santa_fine() { return subdivide(subdivide(santa(2857))); }

constexpr Shape shapes[] = {
    {"brain", [] { return brain(30000); }},
    {"brain-3500", [] { return brain(3500); }},
    {"brain-30000", [] { return brain(30000); }},
    {"brain-145000", [] { return brain(145000); }},
    {"santa", [] { return santa(2857); }},
    {"santa-2857", [] { return santa(2857); }},
    {"santa-45682", santa_fine},
    {"fish", [] { return fish(8000); }},
    {"fish-8000", [] { return fish(8000); }},
};

} // namespace

std::vector<std::string> shape_names()
{
    std::vector<std::string> names;
    for (const Shape& shape : shapes)
        names.emplace_back(shape.name);
    return names;
}

std::optional<TriangleMesh> named_shape(std::string_view name)
{
    require_default_arithmetic();
    for (const Shape& shape : shapes)
        if (name == shape.name)
            return shape.make();
    return {};
}

TriangleMesh box(const Vec3& size, const std::array<int, 3>& cells)
{
    TriangleMesh mesh;
    std::map<std::array<int, 3>, std::uint32_t> known;
    auto vertex = [&](const std::array<int, 3>& at) {
        const auto [place, fresh] = known.emplace(at, static_cast<std::uint32_t>(mesh.vertices.size()));
        if (fresh)
            mesh.vertices.emplace_back(size[0] * (double(at[0]) / cells[0] - 0.5),
                                       size[1] * (double(at[1]) / cells[1] - 0.5),
                                       size[2] * (double(at[2]) / cells[2] - 0.5));
        return place->second;
    };
    const bool flat = size[2] == 0;
    for (std::size_t axis = flat ? 2 : 0; axis < 3; ++axis)
        for (const int side : {0, 1}) {
            if (flat && side == 0)
                continue;
            const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
            for (int i = 0; i < cells[u]; ++i)
                for (int j = 0; j < cells[v]; ++j) {
                    auto corner = [&](int a, int b) {
                        std::array<int, 3> at{};
                        at[axis] = side * cells[axis];
                        at[u] = i + a;
                        at[v] = j + b;
                        return vertex(at);
                    };
                    const std::uint32_t a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
                    if (side == 1) {
                        mesh.triangles.push_back({a, b, c});
                        mesh.triangles.push_back({a, c, d});
                    } else {
                        mesh.triangles.push_back({a, c, b});
                        mesh.triangles.push_back({a, d, c});
                    }
                }
        }
    return mesh;
}

} // namespace cinch
