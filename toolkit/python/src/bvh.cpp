// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl.h>

#include "toolkit/python/src/calls.hpp"
#include "toolkit/python/src/module.hpp"
#include "toolkit/python/src/objects.hpp"
#include "toolkit/python/src/options.hpp"

namespace cinch::python {
namespace {

TreePtr build(const Needed<Surface>& surface, std::size_t leaf_triangles, py::handle leaf, const std::string& detail)
{
    surface->require_unchanged();
    const RestDetail rest = detail_of(detail);
    std::optional<ClusterSize> cluster;
    if (!leaf.is_none()) {
        if (!py::isinstance<py::tuple>(leaf) || py::len(leaf) != 2)
            throw py::value_error("cluster: (triangles, vertices) are needed");
        const auto size = py::reinterpret_borrow<py::tuple>(leaf);
        cluster = ClusterSize{py::cast<std::size_t>(size[0]), py::cast<std::size_t>(size[1])};
    }
    return apart([surface, leaf_triangles, cluster, rest] {
        const DeformableSurface& s = surface->get();
        return std::make_shared<Tree>(
            Tree{cluster ? build_bvh(s, *cluster, rest) : build_bvh(s, leaf_triangles, rest), surface});
    });
}

py::ssize_t size_of(const TreePtr& tree) { return static_cast<py::ssize_t>(tree->bvh.bvs.size()); }

// A member of every BV, without a copy: (BVs, columns) or (BVs,).
template <class T, class Member>
py::array column(const TreePtr& tree, Member member, std::vector<py::ssize_t> more = {})
{
    static const Bv none{};
    const Bv& first = tree->bvh.bvs.empty() ? none : tree->bvh.bvs[0];
    std::vector<py::ssize_t> shape{size_of(tree)}, strides{sizeof(Bv)};
    for (std::size_t i = 0; i < more.size(); ++i) {
        shape.push_back(more[i]);
        py::ssize_t stride = sizeof(T);
        for (std::size_t inner = i + 1; inner < more.size(); ++inner)
            stride *= more[inner];
        strides.push_back(stride);
    }
    return seen<T>(member(first), std::move(shape), py::cast(tree), std::move(strides));
}

// The rows of one entry per simulation node of every BV, as doubles.
template <class T> py::array entries(const TreePtr& tree, const std::vector<T>& values)
{
    constexpr auto columns = static_cast<py::ssize_t>(sizeof(T) / sizeof(double));
    return seen<double>(reinterpret_cast<const double*>(values.data()),
                        {static_cast<py::ssize_t>(values.size()), columns}, py::cast(tree));
}
static_assert(sizeof(RestBox) == 6 * sizeof(double) && sizeof(WeightModel) == 8 * sizeof(double), "rows of doubles");

template <class T> py::array whole(const TreePtr& tree, const std::vector<T>& values)
{
    return seen<T>(values.data(), {static_cast<py::ssize_t>(values.size())}, py::cast(tree));
}

std::size_t place(const TreePtr& tree, py::ssize_t bv)
{
    if (bv < 0 || bv >= size_of(tree))
        throw py::index_error("bv: " + std::to_string(bv) + " is out of range; there are " +
                              std::to_string(size_of(tree)) + " BVs");
    return static_cast<std::size_t>(bv);
}

} // namespace

void add_bvh(py::module_& module)
{
    py::class_<Tree, TreePtr> bvh(module, "Bvh", R"(A binary tree of BVs over a surface at rest, made by `build_bvh`.

BVs stand level by level, the root first, children after parents. Arrays are its own memory and cannot be written.
)");
    bvh.def_property_readonly(
           "surface", [](const Needed<Tree>& self) { return self->surface; }, "The surface that it was built over.")
        .def("__len__", [](const Needed<Tree>& self) { return size_of(self); })
        .def_property_readonly(
            "detail",
            [](const Needed<Tree>& self) {
                constexpr const char* names[] = {"boxes", "inner", "all"};
                return names[static_cast<std::size_t>(self->bvh.detail)];
            },
            "How much of the rest data was prepared: 'boxes', 'inner' or 'all'.")
        .def_property_readonly(
            "nbytes", [](const Needed<Tree>& self) { return self->bvh.bytes(); }, "Of all arrays.")
        .def_property_readonly(
            "level", [](const Needed<Tree>& self) { return whole(self, self->bvh.level); },
            "Level i is BVs ``level[i]`` to before ``level[i + 1]``, uint32.")
        .def_property_readonly(
            "triangle", [](const Needed<Tree>& self) { return whole(self, self->bvh.triangle); },
            "A permutation of the triangles, uint32, shape (T,).")
        .def_property_readonly(
            "node", [](const Needed<Tree>& self) { return whole(self, self->bvh.node); },
            "Per BV, ascending, every simulation node that influences any of its vertices, uint32.")
        .def_property_readonly(
            "l", [](const Needed<Tree>& self) { return whole(self, self->bvh.l); },
            "Per entry of `node` the least weight over the BV's vertices.")
        .def_property_readonly(
            "h", [](const Needed<Tree>& self) { return whole(self, self->bvh.h); }, "And the greatest one.")
        .def_property_readonly(
            "local", [](const Needed<Tree>& self) { return entries(self, self->bvh.local); },
            "Per entry of `node` the box of the BV's vertices that it influences: centre and half extents, shape (n, "
            "6).")
        .def_property_readonly(
            "radius", [](const Needed<Tree>& self) { return whole(self, self->bvh.radius); },
            "Per entry of `node` the radius of a ball about that box's centre around these vertices.")
        .def_property_readonly(
            "model", [](const Needed<Tree>& self) { return entries(self, self->bvh.model); },
            "Per entry of `node` the model of its weight, shape (n, 8): mean, gradient, residual, moment.")
        .def_property_readonly(
            "point", [](const Needed<Tree>& self) { return whole(self, self->bvh.point); },
            "Extreme vertices of the BVs, uint32.")
        .def_property_readonly(
            "centre",
            [](const Needed<Tree>& self) {
                return column<double>(self, [](const Bv& bv) { return bv.box.centre.data(); }, {3});
            },
            "Centres of the rest boxes, shape (BVs, 3).")
        .def_property_readonly(
            "half",
            [](const Needed<Tree>& self) {
                return column<double>(self, [](const Bv& bv) { return bv.box.half.data(); }, {3});
            },
            "Half extents of the rest boxes, shape (BVs, 3).")
        .def_property_readonly(
            "oriented_centre",
            [](const Needed<Tree>& self) {
                return column<double>(self, [](const Bv& bv) { return bv.oriented.centre.data(); }, {3});
            },
            "Centres of the oriented rest boxes, shape (BVs, 3).")
        .def_property_readonly(
            "oriented_axes",
            [](const Needed<Tree>& self) {
                return column<double>(self, [](const Bv& bv) { return bv.oriented.axis[0].data(); }, {3, 3});
            },
            "Their axes, half extents with direction, shape (BVs, 3 axes, 3).");
    using Number = std::uint32_t Bv::*;
    const std::pair<const char*, std::pair<Number, const char*>> numbers[] = {
        {"first_triangle", {&Bv::first_triangle, "Where each BV's triangles begin in `triangle`."}},
        {"triangle_count", {&Bv::triangle_count, "How many triangles it has."}},
        {"first_child", {&Bv::first_child, "The other child is the next BV; 0 for a leaf."}},
        {"first_influence", {&Bv::first_influence, "Where its simulation nodes begin in `node`, `l` and `h`."}},
        {"influence_count", {&Bv::influence_count, "How many simulation nodes influence it."}},
        {"first_point", {&Bv::first_point, "Where its extreme vertices begin in `point`."}},
        {"point_count", {&Bv::point_count, "How many it has."}},
        {"vertex_influences", {&Bv::vertex_influences, "The most simulation nodes of any one of its vertices."}},
    };
    for (const auto& [name, what] : numbers) {
        const Number member = what.first;
        bvh.def_property_readonly(
            name,
            [member](const Needed<Tree>& self) {
                return column<std::uint32_t>(self, [member](const Bv& bv) { return &(bv.*member); });
            },
            what.second);
    }
    bvh.def(
           "vertices_of",
           [](const Needed<Tree>& self, py::ssize_t bv) {
               const auto vertices = vertices_of(self->surface->get(), self->bvh, self->bvh.bvs[place(self, bv)]);
               return copied<std::uint32_t>(vertices, {static_cast<py::ssize_t>(vertices.size())});
           },
           py::arg("bv"), R"(The vertices of one BV's triangles, each once, in order of first use.

Parameters
----------
bv : int

Returns
-------
numpy.ndarray of uint32
)")
        .def("__repr__", [](const Needed<Tree>& self) {
            return "<cinch.Bvh: " + std::to_string(self->bvh.bvs.size()) + " BVs in " +
                   std::to_string(self->bvh.level.empty() ? 0 : self->bvh.level.size() - 1) + " levels>";
        });

    module.def("build_bvh", &build, py::arg("surface"), py::arg("leaf_triangles") = 4, py::kw_only(),
               py::arg("cluster") = py::none(), py::arg("detail") = "all", R"(A tree of BVs over a surface.

Median split along the longest axis of the covariance of the triangles' centroids. Deterministic.

Parameters
----------
surface : Surface
leaf_triangles : int, optional
    The most triangles of a leaf.
cluster : (int, int), optional
    The most triangles and vertices of a leaf, which then is a patch of the surface; in place of `leaf_triangles`.
detail : {'all', 'inner', 'boxes'}, optional
    How much rest data is prepared, which takes most of the time. 'boxes' is enough for the methods convex,
    corners, eq12, limited and vertices; 'inner' for local, and for queries.

Returns
-------
Bvh
)");
}

} // namespace cinch::python
