// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/polytope.hpp"

#include <set>
#include <stdexcept>

#include <CGAL/Convex_hull_3/dual/halfspace_intersection_3.h>
#include <CGAL/Convex_hull_3/dual/halfspace_intersection_interior_point_3.h>
#include <CGAL/Gmpq.h>
#include <CGAL/Polyhedron_3.h>
#include <CGAL/Simple_cartesian.h>

#include "cinch/bounds.hpp"
#include "exact/formulas.hpp"
#include "exact/rest_data.hpp"

namespace cinch::exact {
namespace {

using Kernel = CGAL::Simple_cartesian<CGAL::Gmpq>;
using Plane = Kernel::Plane_3;
using Corner3 = Kernel::Point_3;

CGAL::Gmpq rational(const Exact& x)
{
    CGAL::Gmpq q;
    mpz_set(mpq_numref(q.mpq()), x.man());
    if (x.exp() >= 0)
        mpz_mul_2exp(mpq_numref(q.mpq()), mpq_numref(q.mpq()), static_cast<mp_bitcnt_t>(x.exp()));
    else
        mpz_mul_2exp(mpq_denref(q.mpq()), mpq_denref(q.mpq()), static_cast<mp_bitcnt_t>(-x.exp()));
    mpq_canonicalize(q.mpq());
    return q;
}

// Six times the signed volume of the tetrahedra from `apex` to the fans of the facets; degenerate facets add 0.
CGAL::Gmpq six_volumes(const CGAL::Polyhedron_3<Kernel>& hull, const Corner3& apex)
{
    CGAL::Gmpq sum(0);
    for (auto facet = hull.facets_begin(); facet != hull.facets_end(); ++facet) {
        const auto first = facet->facet_begin();
        auto second = std::next(first), third = std::next(second);
        for (; third != first; second = third, ++third)
            sum += CGAL::determinant(first->vertex()->point() - apex, second->vertex()->point() - apex,
                                     third->vertex()->point() - apex);
    }
    return sum;
}

Polytope of_supports(int kdop, const std::vector<Exact>& supports)
{
    Polytope out;
    const auto axes = axes_of(kdop);
    // CGAL looks for an interior point of planes in doubles, and GMP ends the process at one that is infinite.
    for (const Exact& s : supports)
        if (absolute(s) > Exact(0x1p1000))
            throw std::length_error("polytope: supports up to 2^1000 are needed");
    std::vector<Plane> planes; // a x + b y + c z + d ≤ 0
    for (std::size_t i = 0; i < supports.size(); ++i) {
        const Axis& axis = axes[i / 2];
        const int sign = i % 2 ? -1 : 1;
        planes.emplace_back(sign * axis[0], sign * axis[1], sign * axis[2], -rational(supports[i]));
        if (i % 2 && supports[i - 1] + supports[i] <= Exact(0))
            return out; // flat across this axis, or empty
    }
    const auto interior = CGAL::halfspace_intersection_interior_point_3(planes.begin(), planes.end());
    if (!interior)
        return out; // flat across no axis, but flat
    CGAL::Polyhedron_3<Kernel> hull;
    CGAL::halfspace_intersection_3(planes.begin(), planes.end(), hull, boost::make_optional(*interior));

    const CGAL::Gmpq volume = CGAL::abs(six_volumes(hull, *interior)) / CGAL::Gmpq(6);
    out.volume = volume.numerator() == 0 ? "0/1"
                                         : mpz_class(volume.numerator().mpz()).get_str() + "/" +
                                               mpz_class(volume.denominator().mpz()).get_str();
    out.approximate_volume = CGAL::to_double(volume);
    const std::set<Corner3> corners(hull.points_begin(), hull.points_end()); // degenerate vertices come several times
    out.vertices = corners.size();
    for (std::size_t i = 0; i < planes.size(); ++i) {
        // Vertices are extreme points, so three of them on a plane span a facet.
        const auto touching =
            std::count_if(corners.begin(), corners.end(), [&](const Corner3& p) { return planes[i].has_on(p); });
        if (touching < 3)
            out.redundant.push_back(static_cast<int>(i));
    }
    return out;
}

} // namespace

Polytope polytope(int kdop, std::span<const double> supports)
{
    return of_supports(kdop, {supports.begin(), supports.end()});
}

Polytope true_polytope(const DeformableSurface& surface, const Bvh& bvh, std::size_t bv,
                       std::span<const AffineMap> maps, int kdop)
{
    std::vector<Point<Exact>> deformed_vertices;
    for (std::uint32_t k : vertices_of(surface, bvh, bv))
        deformed_vertices.push_back(deformed<Exact>(surface.mesh.vertices[k], surface.weights.of(k), maps));
    std::vector<Exact> supports;
    for (const Axis& axis : axes_of(kdop))
        for (const bool against : {false, true}) {
            Exact most = along(deformed_vertices[0], axis, against);
            for (const auto& v : deformed_vertices)
                most = maximum(most, along(v, axis, against));
            supports.push_back(most);
        }
    return of_supports(kdop, supports);
}

} // namespace cinch::exact
