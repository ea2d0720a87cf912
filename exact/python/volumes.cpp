// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/stl.h>

#include "exact/polytope.hpp"
#include "exact/python/module.hpp"
#include "toolkit/python/src/options.hpp"

namespace cinch::python {

void add_volumes(py::module_& module)
{
    using exact::Polytope;
    py::class_<Polytope>(module, "Polytope", "A k-DOP as the intersection of its k half-spaces, in exact arithmetic.")
        .def_property_readonly(
            "volume", [](const Polytope& self) { return fraction(self.volume); },
            "A Fraction; 0 for flat or empty sets.")
        .def_readonly("approximate_volume", &Polytope::approximate_volume, "The same as a float.")
        .def_readonly("vertices", &Polytope::vertices, "How many different ones; 0 for flat or empty sets.")
        .def_readonly("redundant", &Polytope::redundant,
                      "Places of half-spaces without a facet; none for flat or empty sets.");

    module.def(
        "polytope",
        [](py::handle supports) {
            std::vector<double> given =
                supports_from(py::module_::import("numpy").attr("asarray")(supports)[py::none()], 1);
            require_finite(given, "supports", 1);
            return apart([given] { return exact::polytope(static_cast<int>(given.size()), given); });
        },
        py::arg("supports"), R"(The k-DOP of one BV's supports, or its box.

Parameters
----------
supports : array_like, shape (k,) or (2, 3)
    Finite.

Returns
-------
Polytope
)");
    module.def(
        "true_polytope",
        [](const Needed<Tree>& tree, py::ssize_t bv, py::handle maps, int kdop) {
            const DeformableSurface& surface = surface_of_tree(tree, nullptr);
            kdop_of(kdop);
            if (bv < 0 || bv >= static_cast<py::ssize_t>(tree->bvh.bvs.size()))
                throw py::index_error("bv: " + std::to_string(bv) + " is out of range; there are " +
                                      std::to_string(tree->bvh.bvs.size()) + " BVs");
            const Doubles given(maps, "maps");
            require_shape(given.array(), "maps", {static_cast<py::ssize_t>(surface.weights.node_count), 3, 4});
            require_finite(given.values(), "maps", 12);
            const auto rows = given.rows<AffineMap>();
            return apart([tree, bv, all = std::vector<AffineMap>(rows.begin(), rows.end()), kdop] {
                return exact::true_polytope(tree->surface->get(), tree->bvh, static_cast<std::size_t>(bv), all, kdop);
            });
        },
        py::arg("bvh"), py::arg("bv"), py::arg("maps"), py::kw_only(), py::arg("kdop") = 6,
        R"(The true k-DOP of one BV: exact supports of its exactly deformed vertices.

Parameters
----------
bvh : cinch.Bvh
bv : int
maps : array_like, shape (J, 3, 4)
    Finite.
kdop : {6, 14, 18, 26}, optional

Returns
-------
Polytope
)");
}

} // namespace cinch::python
