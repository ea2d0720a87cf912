// SPDX-License-Identifier: GPL-3.0-or-later
// Prints inputs and what the compiled functions make of them, as bits, for tie/compare.ml. Arguments: a seed, and how
// many cases of each function.
#include <bit>
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <vector>

#include "cinch/deform.hpp"
#include "toolkit/bounds/bound_box.hpp"
#include "toolkit/bounds/bound_vertex.hpp"
#include "toolkit/bounds/greatest_mean.hpp"
#include "toolkit/bounds/rounding.hpp"
#include "toolkit/bounds/weight_space.hpp"
#include "toolkit/collide/orientation.hpp"
#include "toolkit/time/interval_refit.hpp"

namespace {

using namespace cinch;

std::mt19937_64 random_bits;

std::uint64_t below(std::uint64_t n) { return random_bits() % n; }
double unit() { return static_cast<double>(random_bits() >> 11) * 0x1p-53; }
double sign() { return below(2) ? 1 : -1; }

enum Kind { ordinary, patterns, subnormal, huge, ties, near_zero, kinds };

/// A number of that kind; now and then of another, or one of those that are special.
double number(Kind kind)
{
    if (below(16) == 0)
        kind = static_cast<Kind>(below(kinds));
    if (below(64) == 0) {
        const double special[] = {0.0,
                                  -0.0,
                                  infinite,
                                  -infinite,
                                  std::numeric_limits<double>::quiet_NaN(),
                                  std::numeric_limits<double>::max(),
                                  0x1p-1022,
                                  0x1p-1074};
        return special[below(kind == patterns ? 8 : 2)];
    }
    switch (kind) {
    case patterns:
        return std::bit_cast<double>(random_bits());
    case subnormal:
        return sign() * std::bit_cast<double>(random_bits() >> (11 + below(50)));
    case huge:
        return sign() * std::ldexp(1 + unit(), 1015 + static_cast<int>(below(9)));
    case ties: // few bits: sums and products that lie half way
        return sign() * std::ldexp(static_cast<double>(below(16)) + 1, static_cast<int>(below(120)) - 60);
    case near_zero:
        return sign() * std::ldexp(1 + unit(), -1060 + static_cast<int>(below(600)));
    default:
        return sign() * std::ldexp(unit(), static_cast<int>(below(8)) - 4);
    }
}
Kind any_kind() { return static_cast<Kind>(below(kinds)); }

void put(double x) { std::printf(" %016" PRIx64, std::bit_cast<std::uint64_t>(x)); }
void put(float x) { std::printf(" %08" PRIx32, std::bit_cast<std::uint32_t>(x)); }
template <class... T> void line(const char* name, T... x)
{
    std::printf("%s", name);
    (put(x), ...);
    std::puts("");
}

/// Weight intervals in units of 2^-53, as a BV has them; sometimes any numbers.
void intervals(std::vector<double>& l, std::vector<double>& h, std::size_t n)
{
    l.resize(n);
    h.resize(n);
    const bool any = below(8) == 0;
    for (std::size_t j = 0; j < n; ++j) {
        const double a = any ? number(any_kind()) : unit() / static_cast<double>(1 + below(n));
        const double b = any ? number(any_kind()) : unit();
        l[j] = below(4) ? std::min(a, b) : 0;
        h[j] = below(8) ? std::max(a, b) : l[j];
    }
}

void errors(std::size_t count)
{
    for (std::size_t i = 0; i < count; ++i) {
        const double x = number(any_kind());
        line("succ", x, succ(x));
        const float f = below(2) ? std::bit_cast<float>(static_cast<std::uint32_t>(random_bits()))
                                 : static_cast<float>(number(ordinary));
        line("succ32", f, succ(f));
        const std::size_t n = below(std::size_t(1) << (1 + below(22)));
        const double magnitude = std::abs(number(any_kind()));
        line("extremum_error", magnitude, extremum_error(magnitude));
        line("evaluation_error", static_cast<double>(n), magnitude,
             evaluation_error(static_cast<double>(n), magnitude));
        line("sum_error", static_cast<double>(n), magnitude, sum_error(static_cast<double>(n), magnitude));
        line("smallest_times32", static_cast<float>(n), smallest_times<float>(n));
    }
}

void duals(std::size_t count)
{
    std::vector<double> l, h, b;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t n = 1 + below(below(16) ? 6 : 40);
        intervals(l, h, n);
        b.resize(n);
        const Kind kind = any_kind();
        for (double& x : b)
            x = number(kind);
        const double second = second_largest(b);
        std::printf("second_largest %zu", n);
        for (double x : b)
            put(x);
        put(second);
        std::puts("");
        const double lambda = below(2) ? second : below(2) ? b[below(n)] : number(kind);
        std::printf("dual_bound %zu", n);
        put(lambda);
        for (std::size_t j = 0; j < n; ++j) {
            put(l[j]);
            put(h[j]);
            put(b[j]);
        }
        put(dual_bound({l, h}, b, lambda, Rounding::proven));
        std::puts("");
    }
}

/// Means of limits that are at least 0; now and then of any numbers. Often two are about as large, or all are
/// subnormal.
void means(std::size_t count)
{
    std::vector<double> l, h, c;
    std::vector<std::uint32_t> node;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t n = 1 + below(below(16) ? 6 : 40);
        intervals(l, h, n);
        c.resize(n);
        node.resize(n);
        const Kind kind = any_kind();
        const bool any = below(16) == 0;
        for (std::size_t j = 0; j < n; ++j) {
            c[j] = any ? number(kind) : std::abs(number(kind));
            if (below(8) == 0)
                c[j] = std::ldexp(static_cast<double>(below(8)), -1074);
            node[j] = static_cast<std::uint32_t>(j);
        }
        if (below(4) == 0) // sums in the order of nodes are of few bits
            std::fill(c.begin(), c.begin() + static_cast<std::ptrdiff_t>(below(n)), c[0]);
        RestBv bv;
        bv.node = node;
        bv.space = {l, h};
        std::printf("greatest_mean %zu", n);
        for (std::size_t j = 0; j < n; ++j) {
            put(l[j]);
            put(h[j]);
            put(c[j]);
        }
        put(greatest_mean(bv, [&](std::size_t j) { return c[j]; }));
        std::puts("");
    }
}

/// Ends, bumps and paths of one size, or of four; about 4 bump = last - first, and about 2^1020.
void intervals_of_time(std::size_t count)
{
    for (std::size_t i = 0; i < count; ++i) {
        const Kind kind = any_kind();
        const bool mixed = below(8) == 0;
        auto some = [&] { return number(mixed ? any_kind() : kind); };
        const double first = some(), last = below(8) ? some() : first;
        double bump = below(4) ? std::abs(some()) : some(), path = below(4) ? std::abs(some()) : some();
        if (below(4) == 0) { // where the parabola's top is at an end
            bump = std::abs(last - first) / 4;
            if (below(2))
                bump *= 1 + (static_cast<double>(below(9)) - 4) * unit_roundoff;
        }
        if (below(4) == 0)
            path = infinite;
        else if (below(4) == 0)
            bump = infinite;
        line("greatest_between", first, last, bump, path, greatest_between(first, last, bump, path));
    }
}

std::vector<AffineMap> some_maps(std::size_t n, Kind kind)
{
    std::vector<AffineMap> maps(n);
    for (AffineMap& map : maps)
        for (auto& row : map.m)
            for (double& x : row)
                x = number(kind);
    return maps;
}
void put(const AffineMap& map)
{
    for (const auto& row : map.m)
        for (const double x : row)
            put(x);
}

void boxes(std::size_t count)
{
    BoundScratch scratch;
    std::vector<double> l, h;
    std::vector<std::uint32_t> node;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t n = 1 + below(4);
        // Where everything is ordinary nothing is lost early: three in four.
        const Kind kind = below(4) ? (below(2) ? ordinary : ties) : any_kind();
        std::vector<AffineMap> maps = some_maps(n, kind);
        intervals(l, h, n);
        node.resize(n);
        for (std::size_t j = 0; j < n; ++j)
            node[j] = static_cast<std::uint32_t>(j);
        RestBv bv;
        for (int s = 0; s < 3; ++s) {
            bv.box.centre[s] = number(kind);
            bv.box.half[s] = std::abs(number(kind));
        }
        if (below(16) == 0) { // 0 times infinity in the magnitude alone
            const int s = static_cast<int>(below(3));
            bv.box.centre[s] = bv.box.half[s] = std::numeric_limits<double>::max();
            for (AffineMap& map : maps)
                for (auto& row : map.m)
                    row[s] = 0;
        }
        if (below(32) == 0) // where corners no longer answers
            for (AffineMap& map : maps)
                for (auto& row : map.m) {
                    row[0] = row[1] = row[2] = 0;
                    row[3] = std::ldexp(sign(), 1020 - static_cast<int>(below(2)));
                }
        bv.node = node;
        bv.space = {l, h};
        bv.vertex_influences = static_cast<std::uint32_t>(1 + below(12));
        const Axis axis = all_axes[below(all_axes.size())];
        const Method methods[] = {Method::convex, Method::eq12, Method::limited, Method::corners};
        const std::size_t method = below(4);
        double supports[2];
        bound_box(bv, maps, methods[method], Rounding::proven, std::span(&axis, 1), scratch, supports);
        const double lambda[] = {best_lambda(bv.space, scratch.plus, scratch.select),
                                 best_lambda(bv.space, scratch.minus, scratch.select)};
        for (std::size_t side = 0; side < 2; ++side) {
            std::printf("bound_box %zu %zu %d %d %d %u %zu", method, side, axis[0], axis[1], axis[2],
                        bv.vertex_influences, n);
            put(lambda[side]);
            for (int s = 0; s < 3; ++s)
                put(bv.box.centre[s]);
            for (int s = 0; s < 3; ++s)
                put(bv.box.half[s]);
            for (std::size_t j = 0; j < n; ++j) {
                put(l[j]);
                put(h[j]);
                put(maps[j]);
            }
            // Where a map is not finite the extrema are not computed.
            const std::vector<double>& b = side == 0 ? scratch.plus : scratch.minus;
            const bool computed = std::all_of(maps.begin(), maps.end(), [](const auto& m) { return is_finite(m); });
            for (std::size_t j = 0; j < n; ++j)
                put(computed ? b[j] : std::numeric_limits<double>::quiet_NaN());
            std::printf(" %d", computed);
            put(supports[side]);
            std::puts("");
        }
    }
}

void vertices(std::size_t count)
{
    std::vector<std::uint32_t> node;
    std::vector<double> weight;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t n = below(6);
        const Kind kind = any_kind();
        std::vector<AffineMap> maps = some_maps(n, kind);
        node.resize(n);
        weight.resize(n);
        for (std::size_t j = 0; j < n; ++j) {
            node[j] = static_cast<std::uint32_t>(j);
            weight[j] = below(8) ? unit() : number(kind);
        }
        if (n == 2 && below(2)) { // the vertex is 0, so that every bit of the error terms shows
            weight[1] = weight[0];
            for (int r = 0; r < 3; ++r)
                for (int c = 0; c < 4; ++c)
                    maps[1].m[r][c] = -maps[0].m[r][c];
        }
        const Vec3 rest{number(kind), number(kind), number(kind)};
        const Vec3 v = evaluate_vertex(rest, {node, weight}, maps);
        std::printf("evaluate_vertex %zu", n);
        for (int s = 0; s < 3; ++s)
            put(rest[s]);
        for (std::size_t j = 0; j < n; ++j) {
            put(weight[j]);
            put(maps[j]);
        }
        for (int s = 0; s < 3; ++s)
            put(v[s]);
        std::puts("");
        const Axis axis = all_axes[below(all_axes.size())];
        double supports[2];
        bound_vertex(rest, {node, weight}, maps, Rounding::proven, std::span(&axis, 1), supports);
        const std::size_t side = below(2);
        std::printf("bound_vertex %zu %d %d %d %zu", side, axis[0], axis[1], axis[2], n);
        for (int s = 0; s < 3; ++s)
            put(rest[s]);
        for (std::size_t j = 0; j < n; ++j) {
            put(weight[j]);
            put(maps[j]);
        }
        put(supports[side]);
        std::puts("");
    }
}

/// Signs of determinants, and whether the filter decided them. Often nearly 0: the last point lies near the plane.
void signs(std::size_t count)
{
    for (std::size_t i = 0; i < count; ++i) {
        const Kind kind = below(4) ? (below(2) ? ordinary : ties) : any_kind();
        Vec3 point[4];
        for (Vec3& p : point)
            for (int s = 0; s < 3; ++s)
                do
                    p[s] = number(kind);
                while (!std::isfinite(p[s]));
        if (kind == ordinary && below(2)) // of one size, so that leaves are about as large as the filter takes them
            for (Vec3& p : point)
                p = {sign() * unit(), sign() * unit(), sign() * unit()};
        if (below(2)) {
            const double a = unit(), b = unit();
            const Vec3 flat = point[0] + a * (point[1] - point[0]) + b * (point[2] - point[0]);
            if (flat.allFinite())
                point[3] = flat;
            if (below(2)) { // off it by some u of what the determinant's leaves are, about where the filter decides
                const double off = (static_cast<double>(below(1025)) - 512) * unit_roundoff;
                point[3] += off * (point[3] - point[0]).cwiseAbs().cwiseProduct(Vec3(sign(), sign(), sign()));
            }
        }
        if (kind == ordinary && below(4) == 0) { // about the filter's least and greatest differences
            const int e = (below(2) ? -320 : 320) + static_cast<int>(below(9)) - 4;
            for (Vec3& p : point)
                for (int s = 0; s < 3; ++s)
                    p[s] = std::ldexp(p[s], e);
        }
        OrientationCounts counts;
        const int sign3 = orientation(point[0], point[1], point[2], point[3], &counts);
        std::printf("filter3");
        for (const Vec3& p : point)
            for (int s = 0; s < 3; ++s)
                put(p[s]);
        std::printf(" %d\n", counts.in_double ? sign3 : 2);
        Vec2 q[3];
        for (int k = 0; k < 3; ++k)
            q[k] = point[k].head<2>();
        if (below(2)) {
            const Vec2 flat = q[0] + unit() * (q[1] - q[0]);
            if (flat.allFinite())
                q[2] = flat;
        }
        OrientationCounts counts2;
        const int sign2 = orientation(q[0], q[1], q[2], &counts2);
        std::printf("filter2");
        for (const Vec2& p : q)
            for (int s = 0; s < 2; ++s)
                put(p[s]);
        std::printf(" %d\n", counts2.in_double ? sign2 : 2);
    }
}

} // namespace

int main(int argc, char** argv)
{
    if (argc != 3)
        return 2;
    random_bits.seed(std::strtoull(argv[1], nullptr, 10));
    const std::size_t count = std::strtoull(argv[2], nullptr, 10);
    errors(count);
    duals(count);
    means(count);
    intervals_of_time(count);
    boxes((count + 1) / 2); // two sides each
    vertices(count);
    signs(4 * count); // each is soon done, and those near the filter's limits are few
}
