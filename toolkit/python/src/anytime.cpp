// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl.h>

#include "cinch/refit.hpp"
#include "toolkit/python/src/boxes.hpp"
#include "toolkit/python/src/calls.hpp"
#include "toolkit/python/src/frames.hpp"
#include "toolkit/python/src/module.hpp"
#include "toolkit/python/src/options.hpp"

namespace cinch::python {
namespace {

class AnytimeObject {
public:
    static std::shared_ptr<AnytimeObject> make(const Needed<Tree>& tree, const SurfacePtr& surface,
                                               const py::kwargs& options)
    {
        auto self = std::make_shared<AnytimeObject>();
        self->options_ = refit_options(options);
        surface_of_tree(tree, surface);
        self->tree_ = tree;
        apart([self] { self->bounder_.emplace(self->tree_->bvh, self->tree_->surface->get(), self->options_); });
        return self;
    }

    py::array_t<double> call(py::handle maps, std::size_t bv, double tolerance, std::optional<double> seconds,
                             py::handle out)
    {
        tree_->surface->require_unchanged();
        if (bv >= tree_->bvh.bvs.size())
            throw py::index_error("bv: there are " + std::to_string(tree_->bvh.bvs.size()) + " BVs, from 0");
        if (!(tolerance >= 0))
            throw py::value_error("tolerance: at least 0 is needed");
        if (seconds && !(*seconds >= 0 && *seconds <= 1e9))
            throw py::value_error("seconds: 0 to 1e9 are needed");
        Frames frames(maps, py::none(), tree_->surface->get().weights.node_count, 0);
        const std::size_t k = static_cast<std::size_t>(options_.kdop);
        py::array_t<double> array = result(out, k == 6 ? frames.shape({2, 3}) : frames.shape({k}));
        const Pinned pinned(array);
        double* const to = array.mutable_data();
        const py::gil_scoped_release unlocked;
        const Busy busy(busy_, "AnytimeBounder");
        for (std::size_t f = 0; f < frames.count(); ++f) {
            bounder_->begin(frames.maps(f));
            bounder_->begin(bv);
            if (seconds)
                bounder_->refine_for(std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 * *seconds)));
            else
                bounder_->refine_to(tolerance);
            const std::span<double> supports(to + f * k, k);
            std::ranges::copy(bounder_->supports(), supports.begin());
            if (k == 6)
                as_boxes(supports);
        }
        return array;
    }

    const TreePtr& tree() const { return tree_; }
    int kdop() const { return options_.kdop; }

private:
    TreePtr tree_;
    RefitOptions options_;
    std::optional<AnytimeBounder> bounder_; // there once it is made
    std::atomic<bool> busy_{false};
};

} // namespace

void add_anytime(py::module_& module)
{
    py::class_<AnytimeObject, std::shared_ptr<AnytimeObject>>(
        module, "AnytimeBounder",
        R"(A bound of one BV that tightens for as long as there is time, by branch and bound down the tree.

At any moment it is proven as those of a `Refitter` are; in the end it is the true box of the vertices.

Parameters
----------
bvh : Bvh
surface : Surface, optional
    That of the BVH.
method, kdop, precision, rest_shape, passes, proven : optional
    As for `Refitter`.
)")
        .def(py::init(&AnytimeObject::make), py::arg("bvh"), py::arg("surface") = py::none())
        .def("__call__", &AnytimeObject::call, py::arg("maps"), py::arg("bv") = 0, py::kw_only(),
             py::arg("tolerance") = 0.0, py::arg("seconds") = py::none(), py::arg("out") = py::none(),
             R"(A bound of one BV in each frame.

Parameters
----------
maps : array_like, shape (J, 3, 4) or (frames, J, 3, 4), or Clip
bv : int, optional
    By default the root: the whole surface.
tolerance : float, optional
    It stops where each support is above what the vertices reach by at most so much of the BV's width. 0: the true box.
seconds : float, optional
    It stops after so long in each frame instead, give or take some microseconds.
out : numpy.ndarray, optional
    Where to write, float64 in C order.

Returns
-------
numpy.ndarray, shape ([frames,] 2, 3) or ([frames,] k)
    For kdop 6 a box: least and greatest corner. Else supports, see `axes`.
)")
        .def_property_readonly("bvh", &AnytimeObject::tree, "The BVH.")
        .def_property_readonly("kdop", &AnytimeObject::kdop, "The number of directions.");
}

} // namespace cinch::python
