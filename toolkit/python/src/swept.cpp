// SPDX-License-Identifier: Apache-2.0
#include "toolkit/python/src/calls.hpp"
#include "toolkit/python/src/module.hpp"
#include "toolkit/python/src/objects.hpp"
#include "toolkit/python/src/options.hpp"
#include "toolkit/python/src/pairs.hpp"

namespace cinch::python {
namespace {

py::array_t<std::uint32_t> swept_pairs(const py::sequence& bodies, int kdop)
{
    kdop_of(kdop);
    std::vector<TreePtr> trees;
    std::vector<std::vector<double>> supports;
    for (const py::handle body : bodies) {
        if (!py::isinstance<py::tuple>(body) || py::len(body) != 2)
            throw py::value_error("bodies: pairs of a Bvh and its supports are needed");
        const auto pair = py::reinterpret_borrow<py::tuple>(body);
        trees.push_back(needed<Tree>(pair[0], "bodies"));
        supports.push_back(supports_from(pair[1], trees.back()->bvh.bvs.size(), kdop));
        for (const double s : supports.back())
            if (std::isnan(s))
                throw py::value_error("supports: NaN is no bound");
    }
    const std::vector<LeafPair> pairs = apart([trees, supports, kdop] {
        std::vector<SweptBody> all;
        for (std::size_t i = 0; i < trees.size(); ++i)
            if (trees[i]->bvh.bvs.empty())
                throw std::invalid_argument("bodies: one has no BVs");
            else
                all.push_back({&trees[i]->bvh, supports[i]});
        return swept_leaf_pairs(all, kdop);
    });
    return rows_of<LeafPair>(pairs);
}

py::array_t<double> swept_supports(py::handle first, py::handle last)
{
    const Doubles a(first, "first"), b(last, "last");
    if (a.ndim() != 2)
        throw py::value_error("first: supports, an array of shape (BVs, k), are needed, not " + shape_of(a.array()));
    require_shape(b.array(), "last", {a.array().shape(0), a.array().shape(1)});
    py::array_t<double> out(std::vector<py::ssize_t>{a.array().shape(0), a.array().shape(1)});
    swept(a.values(), b.values(), {out.mutable_data(), a.size()});
    return out;
}

} // namespace

void add_swept(py::module_& module)
{
    module.def("swept_leaf_pairs", &swept_pairs, py::arg("bodies"), py::kw_only(), py::arg("kdop") = 6,
               R"(Leaves of different bodies whose bounds over a step of time meet: broad phase of continuous collision.

Parameters
----------
bodies : list of (Bvh, array_like of shape (BVs, k) or (BVs, 2, 3))
    Trees with bounds of all of their BVs that hold throughout: those of a `ClipBounder`, or `swept` ones.
kdop : int, optional

Returns
-------
numpy.ndarray of uint32, shape (n, 4)
    Place of a body in the list, its BV, place of another body, its BV; sorted.
)");
    module.def("swept", &swept_supports, py::arg("first"), py::arg("last"),
               R"(Bounds over a step in which every transform moves from one end to the other linearly.

Parameters
----------
first, last : array_like, shape (BVs, k)
    Supports at both ends.

Returns
-------
numpy.ndarray, shape (BVs, k)
)");
}

} // namespace cinch::python
