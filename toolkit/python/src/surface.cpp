// SPDX-License-Identifier: Apache-2.0
#include <numeric>

#include <pybind11/stl.h>

#include "toolkit/python/src/module.hpp"
#include "toolkit/python/src/objects.hpp"
#include "toolkit/python/src/stands_in.hpp"
#include "toolkit/python/src/weights.hpp"

namespace cinch::python {
namespace {

// Arrays below which the memory lies, from the given one to the one that owns it; empty if it must not be shared: where
// an array that is more than this one, or no array, could change it.
std::vector<py::array> owners(const py::array& array)
{
    std::vector<py::array> chain{array};
    for (;;) {
        const py::array& last = chain.back();
        if (last.owndata())
            return chain;
        const py::object base = last.base();
        if (!base || !py::isinstance<py::array>(base)) {
            if (!last.writeable())
                return chain; // of a buffer that nobody can write through NumPy
            return {};
        }
        const auto next = py::reinterpret_borrow<py::array>(base);
        if (next.nbytes() != array.nbytes())
            return {};
        chain.push_back(next);
    }
}

std::vector<Triangle> triangles_from(py::handle from, std::size_t vertices)
{
    const py::array array = as_array(from, "triangles");
    require_shape(array, "triangles", {any, 3});
    const std::vector<std::uint32_t> flat = indices(array, "triangles", vertices);
    std::vector<Triangle> out(flat.size() / 3);
    for (std::size_t t = 0; t < out.size(); ++t)
        out[t] = {flat[3 * t], flat[3 * t + 1], flat[3 * t + 2]};
    return out;
}

SurfacePtr make_surface(py::handle vertices, py::handle triangles, py::handle weights, bool copy, bool normalise,
                        py::handle layout)
{
    Doubles points(vertices, "vertices");
    require_shape(points.array(), "vertices", {any, 3});
    if (points.shape(0) >= std::numeric_limits<std::uint32_t>::max())
        throw py::value_error("vertices: over 2^32 of them");
    require_finite(points.values(), "vertices", 3);
    std::vector<Triangle> corners = triangles_from(triangles, points.shape(0));
    Weights bound = py::isinstance<WeightsObject>(weights) ? py::cast<const WeightsObject&>(weights).weights
                                                           : weights_from(weights, py::none(), normalise).weights;
    if (bound.vertex_count() != points.shape(0))
        throw py::value_error("weights: " + std::to_string(bound.vertex_count()) + " rows for " +
                              std::to_string(points.shape(0)) + " vertices");
    DeformableSurface made{{{}, std::move(corners)}, std::move(bound)};
    if (!layout.is_none()) {
        const Doubles places(layout, "layout");
        require_shape(places.array(), "layout", {points.array().shape(0), 3});
        require_finite(places.values(), "layout", 3);
        made.layout.assign(places.rows<Vec3>().begin(), places.rows<Vec3>().end());
    }
    if (!copy)
        return std::make_shared<Surface>(std::move(points), std::move(made));
    made.mesh.vertices.assign(points.rows<Vec3>().begin(), points.rows<Vec3>().end());
    return std::make_shared<Surface>(std::move(made));
}

py::array vertices_of_surface(const Needed<Surface>& self)
{
    const auto& vertices = self->get().mesh.vertices;
    py::object base = self->array() ? self->array() : py::cast(self);
    return seen<double>(vertices.empty() ? nullptr : vertices[0].data(), {static_cast<py::ssize_t>(vertices.size()), 3},
                        std::move(base));
}

py::array triangles_of_surface(const Needed<Surface>& self)
{
    const auto& triangles = self->get().mesh.triangles;
    return seen<std::uint32_t>(triangles.empty() ? nullptr : triangles[0].data(),
                               {static_cast<py::ssize_t>(triangles.size()), 3}, py::cast(self));
}

MorphTarget target_from(py::handle vertices, py::handle displacements, py::handle half)
{
    MorphTarget out;
    out.vertex = indices(vertices, "vertices", std::numeric_limits<std::uint32_t>::max());
    for (std::size_t i = 1; i < out.vertex.size(); ++i)
        if (out.vertex[i] <= out.vertex[i - 1])
            throw py::value_error("vertices: each once, ascending, are needed; at place " + std::to_string(i) + " is " +
                                  std::to_string(out.vertex[i]));
    auto rows = [&](py::handle from, const char* name, bool positive) {
        const Doubles given(from, name);
        require_shape(given.array(), name, {static_cast<py::ssize_t>(out.vertex.size()), 3});
        require_finite(given.values(), name, 3);
        for (const double x : given.values())
            if (positive && x < 0)
                throw py::value_error(std::string(name) + ": numbers from 0 on are needed");
        const auto span = given.rows<Vec3>();
        return std::vector<Vec3>(span.begin(), span.end());
    };
    out.displacement = rows(displacements, "displacements", false);
    if (!half.is_none())
        out.half = rows(half, "half", true);
    return out;
}

py::array rows_seen(const std::vector<Vec3>& rows, py::object base)
{
    return seen<double>(rows.empty() ? nullptr : rows[0].data(), {static_cast<py::ssize_t>(rows.size()), 3},
                        std::move(base));
}

void add_targets(py::module_& module)
{
    py::class_<MorphTarget, std::shared_ptr<MorphTarget>>(module, "MorphTarget",
                                                          R"(Displacements of some rest vertices.

With weights ``a`` of all targets, vertices at rest are ``v + sum(a[i] * d[i])``, before simulation nodes move them.

Parameters
----------
vertices : array_like of int, shape (n,)
    Ascending, each once; all others stay.
displacements : array_like, shape (n, 3)
    Finite, in the unit of the surface.
half : array_like, shape (n, 3), optional
    Half extents of boxes: each displacement is anywhere within so much of it along each coordinate.
)")
        .def(py::init(&target_from), py::arg("vertices"), py::arg("displacements"), py::arg("half") = py::none())
        .def_property_readonly(
            "vertices",
            [](const Needed<MorphTarget>& self) {
                return seen<std::uint32_t>(self->vertex.data(), {static_cast<py::ssize_t>(self->vertex.size())},
                                           py::cast(self));
            },
            "Indices of the vertices, uint32, shape (n,).")
        .def_property_readonly(
            "displacements",
            [](const Needed<MorphTarget>& self) { return rows_seen(self->displacement, py::cast(self)); },
            "Displacements, shape (n, 3).")
        .def_property_readonly(
            "half", [](const Needed<MorphTarget>& self) { return rows_seen(self->half, py::cast(self)); },
            "Half extents of boxes, shape (n, 3), or (0, 3) where displacements are known.");
}

} // namespace

Surface::Surface(Doubles vertices, DeformableSurface&& rest) : own_(std::move(rest)), at_(&own_)
{
    const auto rows = vertices.rows<Vec3>();
    const std::vector<py::array> chain = owners(vertices.array());
    if (rows.empty() || chain.empty() || !stands_in(own_.mesh.vertices, rows)) {
        own_.mesh.vertices.assign(rows.begin(), rows.end());
        return;
    }
    for (const py::array& array : chain)
        py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
    array_ = vertices.array();
    reference_ = py::reinterpret_steal<py::object>(PyWeakref_NewRef(chain.back().ptr(), nullptr));
    sum_ = sum();
}

Surface::~Surface()
{
    if (!array_)
        return;
    stands_no_more(own_.mesh.vertices);
    const py::gil_scoped_acquire locked; // the last to let go may be a thread of its own
    reference_ = {};
    array_ = {};
}

void add_surface(py::module_& module)
{
    add_weights(module);
    add_targets(module);
    py::class_<Surface, SurfacePtr>(module, "Surface",
                                    R"(A surface at rest, with the weights by which simulation nodes deform it.

Parameters
----------
vertices : array_like, shape (V, 3)
    Finite, in any unit. An array of float64 in C order is not copied: the surface stands in its memory, and the array
    cannot be written from then on. Arrays of other layouts, and parts of larger arrays, are copied.
triangles : array_like of int, shape (T, 3)
    Indices of vertices. Copied, as 32-bit numbers.
weights : Weights, array_like of shape (V, J), (data, indices, indptr), or a SciPy sparse array
    Convex: at least 0, of each vertex with the sum 1. See `Weights`.
copy : bool, optional
    Copy the vertices in any case, and leave the array as it is.
normalise : bool, optional
    Divide the weights of each vertex by their sum.
layout : array_like, shape (V, 3), optional
    Where the vertices stand when triangles are grouped, for parts with rest spaces of their own.

Raises
------
ValueError
    For shapes, kinds and indices that do not fit, numbers that are not finite, weights that are not convex.
)")
        .def(py::init(&make_surface), py::arg("vertices"), py::arg("triangles"), py::arg("weights"), py::kw_only(),
             py::arg("copy") = false, py::arg("normalise") = false, py::arg("layout") = py::none())
        .def_property_readonly("vertices", &vertices_of_surface,
                               "Rest vertices, shape (V, 3): the surface's own memory, which cannot be written.")
        .def_property_readonly("triangles", &triangles_of_surface,
                               "Indices of vertices, uint32, shape (T, 3). Cannot be written.")
        .def_property_readonly(
            "weights",
            [](const Needed<Surface>& self) {
                return WeightsObject{self->get().weights, {}, 0};
            },
            "A copy of its `Weights`.")
        .def_property_readonly(
            "layout",
            [](const Needed<Surface>& self) -> py::object {
                if (self->get().layout.empty())
                    return py::none();
                return rows_seen(self->get().layout, py::cast(self));
            },
            "Where the vertices stand when triangles are grouped, shape (V, 3), or None: at rest.")
        .def_property_readonly(
            "node_count", [](const Surface& self) { return self.get().weights.node_count; },
            "How many simulation nodes move it.")
        .def_property_readonly(
            "shares_memory", [](const Surface& self) { return bool(self.array()); },
            "Whether it stands in the memory of the array that it was made of.")
        .def("__repr__", [](const Surface& self) {
            const DeformableSurface& s = self.get();
            return "<cinch.Surface: " + std::to_string(s.mesh.vertices.size()) + " vertices, " +
                   std::to_string(s.mesh.triangles.size()) + " triangles, " + std::to_string(s.weights.node_count) +
                   " simulation nodes>";
        });
}

} // namespace cinch::python
