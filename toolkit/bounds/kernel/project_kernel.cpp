// SPDX-License-Identifier: Apache-2.0
#include "toolkit/bounds/kernel/project_kernel.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "toolkit/bounds/rounding.hpp"

// As the kernels of the bounds.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "toolkit/bounds/kernel/project_kernel.cpp"
#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include "toolkit/deform/kernel/quad-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cinch::HWY_NAMESPACE {

HWY_INLINE Quad absolute(const Quad& a) { return each(a, a, [](auto x, auto) { return hn::Abs(x); }); }
HWY_INLINE Quad greater(const Quad& a, const Quad& b) { return each(a, b, [](auto x, auto y) { return hn::Max(x, y); }); }
HWY_INLINE Quad square_root(const Quad& a) { return each(a, a, [](auto x, auto) { return hn::Sqrt(x); }); }
HWY_INLINE Quad next(const Quad& x) // succ of rounding.hpp
{
    return x + (times(absolute(x), unit_roundoff * (1 + 2 * unit_roundoff)) + Quad::all(smallest_subnormal));
}

// A row of A, and d = A·o + t − O. The compensated sum [Ogita, Rump, Oishi 2005, Dot2] is within u|d| + 2^-98·(Σ|A o| + |t| + |O|); for
// o = 0 so is fl(t − O), without the second term.
struct Row {
    Quad a[3], t, d, lost;
};

HWY_INLINE void shift(Row& row, const Vec3& rest_origin, double origin)
{
    row.lost = Quad::zero();
    row.d = row.t - Quad::all(origin);
    if (rest_origin[0] == 0 && rest_origin[1] == 0 && rest_origin[2] == 0)
        return;
    Quad sum = row.t, compensation = Quad::zero(), magnitude = absolute(row.t) + Quad::all(std::abs(origin));
    auto add = [&](const Quad& x) HWY_ATTR { // TwoSum
        const Quad after = sum + x, part = after - sum;
        compensation = compensation + ((sum - (after - part)) + (x - part));
        sum = after;
    };
    add(Quad::all(-origin));
    for (int s = 0; s < 3; ++s) {
        const Quad o = Quad::all(rest_origin[s]), product = row.a[s] * o;
        add(product);
        compensation = compensation + multiply_add(row.a[s], o, Quad::zero() - product);
        magnitude = magnitude + absolute(product);
    }
    row.d = sum + compensation;
    row.lost = times(magnitude, 0x1p-98);
}

// The least T that is at least x ≥ 0.
template <class T> HWY_INLINE T rounded_up(double x)
{
    const T t = static_cast<T>(x);
    using Bits = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
    return static_cast<double>(t) >= x || !(x < infinite) ? t : std::bit_cast<T>(static_cast<Bits>(std::bit_cast<Bits>(t) + 1));
}

// ‖(x, y, z)‖ rounded up; squares neither overflow nor vanish.
HWY_INLINE Quad norm(const Quad& x, const Quad& y, const Quad& z)
{
    const Quad most = greater(greater(absolute(x), absolute(y)), absolute(z));
    const Quad root = square_root((x * x + y * y) + z * z), sum = (absolute(x) + absolute(y)) + absolute(z);
    Quad out;
    for (std::size_t i = 0; i < Quad::vectors; ++i) {
        const typename Quad::D d;
        const auto safe = hn::And(hn::Gt(most.v[i], hn::Set(d, 0x1p-500)), hn::Lt(most.v[i], hn::Set(d, 0x1p500)));
        out.v[i] = hn::IfThenElse(safe, root.v[i], sum.v[i]);
    }
    // 3 products, 2 sums and a root: 4 roundings and half of one.
    return times(out, 1 + 8 * unit_roundoff);
}

// To T and back, as the records have it.
template <class T> HWY_INLINE Quad stored(const Quad& x, T (&out)[4])
{
    HWY_ALIGN double lane[4];
    x.store(lane);
    for (std::size_t i = 0; i < 4; ++i) {
        out[i] = static_cast<T>(lane[i]);
        lane[i] = static_cast<double>(out[i]);
    }
    return Quad::load(lane);
}

template <class T>
ProjectionReport project(std::span<const AffineMap> maps, const RestExtent& rest, std::span<const Axis> axes, bool proven, const Vec3& origin, T* records)
{
    const std::size_t record = 4 * projected_rows(axes.size());
    const double extent = rest.about_origin.sum();
    const bool fits = rest.about_origin.maxCoeff() <= magnitude_limit<T>; // else rest data may overflow T
    const double node_underflow = 128 * static_cast<double>(smallest_subnormal_of<T>) * (1 + extent);
    const double evaluation = (rest.influences + 8) * unit_roundoff, evaluation_underflow = 8 * rest.influences * smallest_subnormal;
    ProjectionReport report;
    for (std::size_t first = 0; first < maps.size(); first += 4) {
        const std::size_t count = std::min<std::size_t>(4, maps.size() - first);
        Row row[3];
        for (std::size_t r = 0; r < 3; ++r) {
            HWY_ALIGN double values[4][4];
            for (std::size_t i = 0; i < 4; ++i)
                std::copy_n(maps[first + std::min(i, count - 1)].m[r], 4, values[i]);
            Quad columns[4] = {Quad::load(values[0]), Quad::load(values[1]), Quad::load(values[2]), Quad::load(values[3])};
            transpose(columns);
            for (std::size_t s = 0; s < 3; ++s)
                row[r].a[s] = columns[s];
            row[r].t = columns[3];
            shift(row[r], rest.origin, origin[static_cast<int>(r)]);
        }
        Quad error = Quad::zero(), vertex_error = Quad::zero(), everything = Quad::zero();
        T* const out = records + first * record;
        for (std::size_t a = 0; a < axes.size(); ++a) {
            Quad along[4], magnitude[4], lost = Quad::zero(), world = Quad::zero();
            for (std::size_t s = 0; s < 4; ++s)
                along[s] = magnitude[s] = Quad::zero();
            for (std::size_t r = 0; r < 3; ++r) {
                if (axes[a][r] == 0)
                    continue;
                for (std::size_t s = 0; s < 4; ++s) {
                    const Quad& x = s < 3 ? row[r].a[s] : row[r].d;
                    along[s] = axes[a][r] > 0 ? along[s] + x : along[s] - x;
                    magnitude[s] = magnitude[s] + absolute(x);
                }
                lost = lost + row[r].lost;
                world = world + absolute(row[r].t);
            }
            Quad about = magnitude[3];
            for (std::size_t s = 0; s < 3; ++s) {
                about = about + times(magnitude[s], rest.about_origin[static_cast<int>(s)]);
                world = world + times(magnitude[s], rest.absolute[static_cast<int>(s)]);
            }
            Quad q[4];
            T value[4][4];
            for (std::size_t s = 0; s < 4; ++s) {
                q[s] = stored<T>(along[s], value[s]);
                everything = everything + magnitude[s];
            }
            everything = everything + about;
            HWY_ALIGN double length[4];
            norm(q[0], q[1], q[2]).store(length);
            for (std::size_t i = 0; i < count; ++i) {
                for (std::size_t s = 0; s < 4; ++s)
                    out[i * record + 4 * a + s] = value[s][i];
                out[i * record + 4 * axes.size() + a] = rounded_up<T>(length[i]);
            }
            const Quad computed = next(times(world, evaluation) + Quad::all(evaluation_underflow)); // evaluation_error
            const Quad lost_4 = times(lost, 4);
            const Quad own = next((times(about, kernel_error_constant * static_cast<double>(unit_roundoff_of<T>)) + Quad::all(node_underflow)) + lost_4); // node_error
            error = greater(own + computed, error);
            vertex_error = greater(next(lost_4 + computed), vertex_error);
        }
        HWY_ALIGN double errors[4], vertex_errors[4], all[4];
        next(error).store(errors);
        vertex_error.store(vertex_errors);
        everything.store(all);
        for (std::size_t i = 0; i < count; ++i) {
            T* const own = out + i * record;
            std::fill(own + 5 * axes.size(), own + record, T(0));
            T& charge = own[record - 1];
            charge = proven ? rounded_up<T>(errors[i]) : T(0);
            // What overflows, and what is not a number, is in `all`.
            if (fits && all[i] <= magnitude_limit<T> && charge < std::numeric_limits<T>::infinity()) {
                report.vertex_error = std::max(report.vertex_error, vertex_errors[i]);
                continue;
            }
            std::fill_n(own, record, T(0));
            charge = std::numeric_limits<T>::infinity();
            ++report.unbounded;
        }
    }
    return report;
}

ProjectionReport project_float(std::span<const AffineMap> maps, const RestExtent& rest, std::span<const Axis> axes, bool proven, const Vec3& origin, float* records)
{
    return project(maps, rest, axes, proven, origin, records);
}
ProjectionReport project_double(std::span<const AffineMap> maps, const RestExtent& rest, std::span<const Axis> axes, bool proven, const Vec3& origin, double* records)
{
    return project(maps, rest, axes, proven, origin, records);
}

} // namespace cinch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cinch {
HWY_EXPORT(project_float);
HWY_EXPORT(project_double);

template <>
ProjectionReport project_nodes(std::span<const AffineMap> maps, const RestExtent& rest, std::span<const Axis> axes, bool proven, const Vec3& origin, float* records)
{
    return HWY_DYNAMIC_DISPATCH(project_float)(maps, rest, axes, proven, origin, records);
}
template <>
ProjectionReport project_nodes(std::span<const AffineMap> maps, const RestExtent& rest, std::span<const Axis> axes, bool proven, const Vec3& origin, double* records)
{
    return HWY_DYNAMIC_DISPATCH(project_double)(maps, rest, axes, proven, origin, records);
}

} // namespace cinch
#endif
