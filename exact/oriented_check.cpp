// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/oriented_check.hpp"

#include <cmath>

namespace cinch::exact {

template <class N> Point<N> OrientedCheck::cross(const Point<N>& a, const Point<N>& b)
{
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

template <class N> N OrientedCheck::dot(const Point<N>& a, const Point<N>& b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <class N> OrientedCheck::Face<N> OrientedCheck::face(const Point<N>& normal, const Point<N> (&axis)[3])
{
    return {normal, absolute(dot(normal, axis[0])) + absolute(dot(normal, axis[1])) + absolute(dot(normal, axis[2]))};
}

OrientedCheck::OrientedCheck(const OrientedBox& box) : centre_(box.centre)
{
    for (int s = 0; s < 3; ++s) {
        valid_ &= std::isfinite(centre_[s]);
        for (const Vec3& axis : box.axis) {
            valid_ &= !std::isnan(axis[s]);
            infinite_ |= std::isinf(axis[s]);
        }
    }
    if (!valid_ || infinite_)
        return;
    const Point<Interval> rough[3] = {as_point<Interval>(box.axis[0]), as_point<Interval>(box.axis[1]),
                                      as_point<Interval>(box.axis[2])};
    const Point<Exact> axis[3] = {as_point<Exact>(box.axis[0]), as_point<Exact>(box.axis[1]),
                                  as_point<Exact>(box.axis[2])};
    for (std::size_t i = 0; i < 3; ++i) {
        filter_.push_back(face(cross(rough[i], rough[(i + 1) % 3]), rough));
        exact_.push_back(face(cross(axis[i], axis[(i + 1) % 3]), axis));
    }
    if (!certainly(absolute(dot(filter_[0].normal, rough[2])) > Interval(0)))
        filter_.clear();
    if (dot(exact_[0].normal, axis[2]) != Exact(0))
        return;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k)
            exact_.push_back(face(cross(exact_[i].normal, axis[k]), axis));
    for (std::size_t s = 0; s < 3; ++s) {
        Point<Exact> e{Exact(0), Exact(0), Exact(0)};
        e[s] = Exact(1);
        exact_.push_back(face(e, axis));
        exact_.push_back(face(axis[s], axis));
        for (std::size_t i = 0; i < 3; ++i)
            exact_.push_back(face(cross(axis[i], e), axis));
    }
}

template <class N> bool OrientedCheck::within(const std::vector<Face<N>>& faces, const Vec3& x) const
{
    const Point<N> y{N(x[0]) - N(centre_[0]), N(x[1]) - N(centre_[1]), N(x[2]) - N(centre_[2])};
    return std::all_of(faces.begin(), faces.end(),
                       [&](const Face<N>& f) { return certainly(absolute(dot(f.normal, y)) <= f.reach); });
}

bool OrientedCheck::contains(const Vec3& x) const
{
    if (!valid_)
        return false;
    return infinite_ || (!filter_.empty() && within(filter_, x)) || within(exact_, x);
}

} // namespace cinch::exact
