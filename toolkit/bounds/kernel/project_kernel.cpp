// SPDX-License-Identifier: Apache-2.0
#include "toolkit/bounds/kernel/project_kernel.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "toolkit/bounds/rounding.hpp"

#include "toolkit/deform/kernel/disabled_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "toolkit/bounds/kernel/project_kernel.cpp"
#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "toolkit/bounds/kernel/lanes-inl.hpp"
#include "toolkit/bounds/kernel/next-inl.hpp"
#include "toolkit/deform/kernel/quad-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

// A row of A, and d = A·o + t − O. The compensated sum [Ogita, Rump, Oishi 2005, Dot2] is within u|d| + 2^-98·(Σ|A o| +
// |t| + |O|); for o = 0 so is fl(t − O), without the second term.
struct Row {
    Quad a[3], t, d, lost;
};

HWY_INLINE void shift(Row& row, const Vec3& rest_origin, double origin)
{
    row.lost = Quad::all(0);
    row.d = row.t - Quad::all(origin);
    if (rest_origin[0] == 0 && rest_origin[1] == 0 && rest_origin[2] == 0)
        return;
    Quad sum = row.t, compensation = Quad::all(0), size = magnitude(row.t) + Quad::all(std::abs(origin));
    auto add = [&](const Quad& x) HWY_ATTR { // TwoSum
        const Quad after = sum + x, part = after - sum;
        compensation = compensation + ((sum - (after - part)) + (x - part));
        sum = after;
    };
    add(Quad::all(-origin));
    for (int s = 0; s < 3; ++s) {
        const Quad o = Quad::all(rest_origin[s]), product = row.a[s] * o;
        add(product);
        compensation = compensation + fma(row.a[s], o, Quad::all(0) - product);
        size = size + magnitude(product);
    }
    row.d = sum + compensation;
    row.lost = times(size, 0x1p-98);
}

/// To T, and, rounded up, to at least x ≥ 0.
template <class T> HWY_INLINE void store_as(const Quad& x, T* p)
{
    for (std::size_t i = 0; i < Quad::vectors; ++i) {
        if constexpr (sizeof(T) == 8)
            hn::StoreU(x.v[i], Quad::D(), p + i * Quad::width);
        else
            hn::StoreU(hn::DemoteTo(hn::Rebind<float, Quad::D>(), x.v[i]), hn::Rebind<float, Quad::D>(),
                       p + i * Quad::width);
    }
}
template <class T> HWY_INLINE void store_up(const Quad& x, T* p)
{
    if constexpr (sizeof(T) == 8) {
        store_as(x, p);
    } else {
        const hn::Rebind<float, Quad::D> d;
        for (std::size_t i = 0; i < Quad::vectors; ++i) { // fl(x) ≥ x(1 − u), and succ goes past x
            const auto f = hn::DemoteTo(d, x.v[i]);
            constexpr float phi = unit_roundoff_of<float> * (1 + 2 * unit_roundoff_of<float>);
            hn::StoreU(
                hn::Add(f, hn::Add(hn::Mul(hn::Abs(f), hn::Set(d, phi)), hn::Set(d, smallest_subnormal_of<float>))), d,
                p + i * Quad::width);
        }
    }
}

// At least ‖(x, y, z)‖ of these numbers and of what becomes of them in T: squares neither overflow nor vanish.
template <class T> HWY_INLINE Quad norm(const Quad& x, const Quad& y, const Quad& z)
{
    const Quad most = greater(greater(magnitude(x), magnitude(y)), magnitude(z));
    const Quad length = root((x * x + y * y) + z * z), sum = (magnitude(x) + magnitude(y)) + magnitude(z);
    Quad out;
    for (std::size_t i = 0; i < Quad::vectors; ++i) {
        const typename Quad::D d;
        const auto safe = hn::And(hn::Gt(most.v[i], hn::Set(d, 0x1p-500)), hn::Lt(most.v[i], hn::Set(d, 0x1p500)));
        out.v[i] = hn::IfThenElse(safe, length.v[i], sum.v[i]);
    }
    // 3 products, 2 sums and a root: 4 roundings and half of one; then each number by u in T, or by underflow.
    return times(out, 1 + 8 * unit_roundoff + 2 * static_cast<double>(unit_roundoff_of<T>)) +
           Quad::all(4 * static_cast<double>(smallest_subnormal_of<T>));
}

template <class T> ProjectionReport project(std::span<const AffineMap> maps, const RestExtent& rest,
                                            std::span<const Axis> axes, bool proven, const Vec3& origin, T* records)
{
    const std::size_t record = 4 * projected_rows(axes.size());
    const double extent = rest.about_origin.sum();
    const double limit =
        rest.about_origin.maxCoeff() <= magnitude_limit<T> ? magnitude_limit<T> : -1; // rest data may overflow T
    const Quad underflow = Quad::all(node_underflow<T> * (1 + extent)),
               evaluation_underflow = Quad::all(smallest_times<double>(8 * static_cast<std::size_t>(rest.influences)));
    const double evaluation = (rest.influences + 8) * unit_roundoff;
    Quad greatest_vertex_error = Quad::all(0);
    ProjectionReport report;
    for (std::size_t first = 0; first < maps.size(); first += 4) {
        const std::size_t count = std::min<std::size_t>(4, maps.size() - first);
        const AffineMap* own[4]; // the last one again where there are fewer
        T *out[4], spare[4 * projected_rows(13)];
        for (std::size_t i = 0; i < 4; ++i) {
            own[i] = &maps[first + std::min(i, count - 1)];
            out[i] = i < count ? records + (first + i) * record : spare;
        }
        Row row[3];
        for (std::size_t r = 0; r < 3; ++r) {
            Quad columns[4] = {Quad::load(own[0]->m[r]), Quad::load(own[1]->m[r]), Quad::load(own[2]->m[r]),
                               Quad::load(own[3]->m[r])};
            transpose(columns);
            for (std::size_t s = 0; s < 3; ++s)
                row[r].a[s] = columns[s];
            row[r].t = columns[3];
            shift(row[r], rest.origin, origin[static_cast<int>(r)]);
        }
        Quad error = Quad::all(0), vertex_error = Quad::all(0), everything = Quad::all(0);
        for (std::size_t a = 0; a < axes.size(); ++a) {
            Quad along[4], size[4], lost = Quad::all(0), world = Quad::all(0);
            for (std::size_t s = 0; s < 4; ++s)
                along[s] = size[s] = Quad::all(0);
            for (std::size_t r = 0; r < 3; ++r) {
                if (axes[a][r] == 0)
                    continue;
                for (std::size_t s = 0; s < 4; ++s) {
                    const Quad& x = s < 3 ? row[r].a[s] : row[r].d;
                    along[s] = axes[a][r] > 0 ? along[s] + x : along[s] - x;
                    size[s] = size[s] + magnitude(x);
                }
                lost = lost + row[r].lost;
                world = world + magnitude(row[r].t);
            }
            Quad about = size[3];
            for (std::size_t s = 0; s < 3; ++s) {
                about = about + times(size[s], rest.about_origin[static_cast<int>(s)]);
                world = world + times(size[s], rest.absolute[static_cast<int>(s)]);
            }
            // What it meets may be 0, which would hide a component from `about`.
            everything = everything + (about + ((size[0] + size[1]) + size[2]));
            HWY_ALIGN T length[4];
            store_up<T>(norm<T>(along[0], along[1], along[2]), length);
            const Quad computed = next(times(world, evaluation) + evaluation_underflow); // evaluation_error
            const Quad lost_4 = times(lost, 4);
            error = greater(next((times(about, node_rounding<T>) + underflow) + lost_4) + computed,
                            error); // of the node, and evaluation_error
            vertex_error = greater(next(lost_4 + computed), vertex_error);
            transpose(along);
            for (std::size_t i = 0; i < 4; ++i) {
                store_as<T>(along[i], out[i] + 4 * a);
                out[i][4 * axes.size() + a] = length[i];
            }
        }
        HWY_ALIGN T charge[4];
        store_up<T>(next(error), charge);
        for (std::size_t i = 0; i < 4; ++i) {
            std::fill(out[i] + 5 * axes.size(), out[i] + record - 1, T(0));
            out[i][record - 1] = proven ? charge[i] : T(0);
        }
        bool good = true;
        HWY_ALIGN double all[4];
        everything.store(all);
        for (std::size_t i = 0; i < 4; ++i) // false for what is not a number
            good &= all[i] <= limit && charge[i] < std::numeric_limits<T>::infinity();
        if (good) {
            greatest_vertex_error = greater(vertex_error, greatest_vertex_error);
            continue;
        }
        HWY_ALIGN double vertex_errors[4];
        vertex_error.store(vertex_errors);
        for (std::size_t i = 0; i < count; ++i) {
            if (all[i] <= limit && charge[i] < std::numeric_limits<T>::infinity()) {
                report.vertex_error = std::max(report.vertex_error, vertex_errors[i]);
                continue;
            }
            std::fill_n(out[i], record, T(0));
            out[i][record - 1] = std::numeric_limits<T>::infinity();
            ++report.unbounded;
        }
    }
    HWY_ALIGN double greatest[4];
    greatest_vertex_error.store(greatest);
    for (const double error : greatest)
        report.vertex_error = std::max(report.vertex_error, error);
    return report;
}

ProjectionReport project_float(std::span<const AffineMap> maps, const RestExtent& rest, std::span<const Axis> axes,
                               bool proven, const Vec3& origin, float* records)
{
    return project(maps, rest, axes, proven, origin, records);
}
ProjectionReport project_double(std::span<const AffineMap> maps, const RestExtent& rest, std::span<const Axis> axes,
                                bool proven, const Vec3& origin, double* records)
{
    return project(maps, rest, axes, proven, origin, records);
}

// `records` of a whole octet.
template <class T> void to_octet(const T* records, std::size_t length, T* octet)
{
    const T* record[block_lanes];
    for (std::size_t i = 0; i < block_lanes; ++i)
        record[i] = records + i * length;
    for (std::size_t p = 0; p < length; p += 4) {
        Lanes<T> row[4];
        transpose(record, p, row);
        for (std::size_t s = 0; s < 4; ++s)
            row[s].store(octet + (p + s) * block_lanes);
    }
}

template <class T> void to_octets(const T* records, std::size_t nodes, std::size_t length, T* octets)
{
    for (; nodes >= block_lanes; nodes -= block_lanes, records += block_lanes * length, octets += block_lanes * length)
        to_octet(records, length, octets);
    if (nodes == 0)
        return;
    T filled[block_lanes * 4 * projected_rows(13)];
    std::fill_n(std::copy_n(records, nodes * length, filled), (block_lanes - nodes) * length, T(0));
    to_octet(filled, length, octets);
}

void to_octets_float(const float* records, std::size_t nodes, std::size_t length, float* octets)
{
    to_octets(records, nodes, length, octets);
}
void to_octets_double(const double* records, std::size_t nodes, std::size_t length, double* octets)
{
    to_octets(records, nodes, length, octets);
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cinch {
HWY_EXPORT(project_float);
HWY_EXPORT(project_double);
HWY_EXPORT(to_octets_float);
HWY_EXPORT(to_octets_double);

template <> ProjectionReport project_nodes(std::span<const AffineMap> maps, const RestExtent& rest,
                                           std::span<const Axis> axes, bool proven, const Vec3& origin, float* records)
{
    return HWY_DYNAMIC_DISPATCH(project_float)(maps, rest, axes, proven, origin, records);
}
template <> ProjectionReport project_nodes(std::span<const AffineMap> maps, const RestExtent& rest,
                                           std::span<const Axis> axes, bool proven, const Vec3& origin, double* records)
{
    return HWY_DYNAMIC_DISPATCH(project_double)(maps, rest, axes, proven, origin, records);
}

template <class T> void to_octets(std::span<const T> records, std::size_t length, AlignedVector<T>& octets)
{
    const std::size_t nodes = records.size() / length;
    octets.resize(blocks_of(nodes) * block_lanes * length);
    if constexpr (sizeof(T) == 4)
        HWY_DYNAMIC_DISPATCH(to_octets_float)(records.data(), nodes, length, octets.data());
    else
        HWY_DYNAMIC_DISPATCH(to_octets_double)(records.data(), nodes, length, octets.data());
}

template void to_octets(std::span<const float>, std::size_t, AlignedVector<float>&);
template void to_octets(std::span<const double>, std::size_t, AlignedVector<double>&);

} // namespace cinch
#endif
