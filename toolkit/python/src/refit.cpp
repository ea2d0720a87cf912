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

class RefitterObject {
public:
    static std::shared_ptr<RefitterObject> make(const Needed<Tree>& tree, const SurfacePtr& surface, py::handle targets,
                                                const py::kwargs& options)
    {
        auto self = std::make_shared<RefitterObject>();
        self->options_ = refit_options(options);
        self->targets_ = targets_from(targets, surface_of_tree(tree, surface).mesh.vertices.size());
        self->tree_ = tree;
        apart([self] {
            self->refit_.emplace(self->tree_->bvh, self->tree_->surface->get(), self->options_, self->targets_);
        });
        return self;
    }

    py::array_t<double> call(py::handle maps, py::handle weights, py::handle out, bool boxes, py::handle progress)
    {
        if (options_.methods.contains(Method::vertices))
            tree_->surface->require_unchanged(); // all others have what they need
        Frames frames(maps, weights, tree_->surface->get().weights.node_count, targets_.size());
        const std::size_t bvs = tree_->bvh.bvs.size(), k = static_cast<std::size_t>(options_.kdop);
        boxes = boxes && k == 6;
        py::array_t<double> array = result(out, boxes ? frames.shape({bvs, 2, 3}) : frames.shape({bvs, k}));
        const Pinned pinned(array);
        double* const to = array.mutable_data();
        Ticker tick(progress);
        RefitReport report;
        {
            const py::gil_scoped_release unlocked;
            const Busy busy(busy_, "Refitter");
            for (std::size_t f = 0; f < frames.count(); ++f) {
                const std::span<double> supports(to + f * bvs * k, bvs * k);
                const RefitReport one = (*refit_)(frames.maps(f), frames.weights(f), supports);
                report.unbounded_nodes = std::max(report.unbounded_nodes, one.unbounded_nodes);
                report.infinite += one.infinite;
                if (boxes)
                    as_boxes(supports);
                tick(f + 1, frames.count());
            }
            report_ = report;
        }
        return array;
    }

    const TreePtr& tree() const { return tree_; }
    int kdop() const { return options_.kdop; }
    std::string method() const { return name_of(options_.methods); }
    const RefitReport& report() const { return report_; }
    std::size_t bytes() const { return refit_->bytes(); }

private:
    TreePtr tree_;
    RefitOptions options_;
    std::vector<MorphTarget> targets_;
    std::optional<Refitter> refit_; // there once it is made
    RefitReport report_;
    std::atomic<bool> busy_{false};
};

class CrowdObject {
public:
    CrowdObject(const Needed<Tree>& tree, const SurfacePtr& surface, int level, bool proven)
        : tree_(std::move(tree)),
          refit_(tree_->bvh, surface_of_tree(tree_, surface), {level, proven ? Rounding::proven : Rounding::plain})
    {
    }

    py::array_t<double> operator()(py::handle maps, py::handle out) const
    {
        const auto nodes = static_cast<py::ssize_t>(tree_->surface->get().weights.node_count);
        const Doubles given(maps, "maps");
        require_shape(given.array(), "maps", {any, nodes, 3, 4});
        py::array_t<double> array =
            result(out, {given.array().shape(0), static_cast<py::ssize_t>(refit_.bvs().size()), 2, 3});
        const Pinned pinned(array);
        static_assert(sizeof(Aabb) == 6 * sizeof(double), "boxes are written where they stand");
        const std::span<Aabb> boxes{reinterpret_cast<Aabb*>(array.mutable_data()),
                                    given.shape(0) * refit_.bvs().size()};
        const py::gil_scoped_release unlocked;
        refit_(given.rows<AffineMap>(), boxes);
        return array;
    }
    py::array bvs(const py::object& self) const
    {
        return seen<std::uint32_t>(refit_.bvs().data(), {static_cast<py::ssize_t>(refit_.bvs().size())}, self);
    }
    std::size_t bytes() const { return refit_.bytes(); }

private:
    TreePtr tree_;
    CrowdRefitter refit_;
};

constexpr const char* refitter_page = R"(Bounds of every BV of one surface, frame after frame.

A bound contains every vertex of the deformed surface, in real arithmetic and as `evaluate` computes it. All methods but
'vertices' cost O(n) per BV, n simulation nodes ('corners' O(n**2)), and do not touch the vertices.

Parameters
----------
bvh : Bvh
surface : Surface, optional
    That of the BVH.
targets : list of MorphTarget, optional
    Morph targets whose weights frames have.
method : str, optional
    One of `methods`, by default 'best', or several with ``+`` between them, which are intersected.
kdop : {6, 14, 18, 26}, optional
    Directions; see `axes`.
precision : {'float32', 'float64'}, optional
    Arithmetic of the methods that have kernels. Both give proven bounds.
rest_shape : {'aabb', 'obb'}, optional
    Rest boxes of convex, eq12 and limited.
passes : int, optional
    Evaluations of D for local, support and best.
proven : bool, optional
    False: double arithmetic as it comes, which proves nothing.
remember : bool, optional
    Whether local, support and best begin where the last frame left them.

Notes
-----
One call at a time: a second one from another thread is a RuntimeError. Results are the same bits for every number of
threads.
)";

constexpr const char* call_page = R"(Bounds of all BVs.

Parameters
----------
maps : array_like, shape (J, 3, 4) or (frames, J, 3, 4), or Clip
    Per simulation node the rows of (A | t): x becomes A x + t. One that is not finite makes the bounds of the BVs that
    its simulation node influences infinite.
weights : array_like, shape (targets,) or (frames, targets), optional
    Of the morph targets; by default those of the clip.
out : numpy.ndarray, optional
    Where to write, float64 in C order.
progress : callable, optional
    Called with the numbers of frames done and of all, now and then. What it raises ends the call.

Returns
-------
numpy.ndarray, shape ([frames,] BVs, 2, 3) or ([frames,] BVs, k)
    For kdop 6 boxes: least and greatest corner. Else supports, see `axes`.
)";

} // namespace

void add_refit(py::module_& module)
{
    py::class_<RefitReport>(module, "RefitReport", "What of the frames of a call could not be bounded.")
        .def_readonly("unbounded_nodes", &RefitReport::unbounded_nodes,
                      "The most simulation nodes in a frame whose transform is not finite, or too large.")
        .def_readonly("infinite", &RefitReport::infinite, "Supports that are infinite, for whatever reason.");

    py::class_<RefitterObject, std::shared_ptr<RefitterObject>>(module, "Refitter", refitter_page)
        .def(py::init(&RefitterObject::make), py::arg("bvh"), py::arg("surface") = py::none(),
             py::arg("targets") = py::tuple())
        .def(
            "__call__",
            [](RefitterObject& self, py::handle maps, py::handle weights, py::handle out, py::handle progress) {
                return self.call(maps, weights, out, true, progress);
            },
            py::arg("maps"), py::arg("weights") = py::none(), py::kw_only(), py::arg("out") = py::none(),
            py::arg("progress") = py::none(), call_page)
        .def(
            "supports",
            [](RefitterObject& self, py::handle maps, py::handle weights, py::handle out, py::handle progress) {
                return self.call(maps, weights, out, false, progress);
            },
            py::arg("maps"), py::arg("weights") = py::none(), py::kw_only(), py::arg("out") = py::none(),
            py::arg("progress") = py::none(), "The same as a call, as supports for every k: shape ([frames,] BVs, k).")
        .def_property_readonly("bvh", &RefitterObject::tree, "The BVH.")
        .def_property_readonly("kdop", &RefitterObject::kdop, "The number of directions.")
        .def_property_readonly("method", &RefitterObject::method, "The names of its methods.")
        .def_property_readonly("report", &RefitterObject::report, "A `RefitReport` of the last call.")
        .def_property_readonly("nbytes", &RefitterObject::bytes, "Of the rest data that the kernels stream.");

    module.def(
        "refit",
        [](const Needed<Tree>& tree, py::handle maps, const py::kwargs& options) {
            return RefitterObject::make(tree, nullptr, py::tuple(), options)
                ->call(maps, py::none(), py::none(), true, py::none());
        },
        py::arg("bvh"), py::arg("maps"), R"(Bounds of a single frame, or of some: prepares everything anew.

Parameters
----------
bvh : Bvh
maps : array_like, shape (J, 3, 4) or (frames, J, 3, 4), or Clip
**options
    Those of `Refitter`.

Returns
-------
numpy.ndarray, shape ([frames,] BVs, 2, 3) or ([frames,] BVs, k)
)");

    py::class_<CrowdObject>(module, "CrowdRefitter",
                            R"(Boxes of many bodies that share one surface, each in a pose of its own.

A box per simulation node and BV, transformed and united, as engines bound a character, with room for all rounding.

Parameters
----------
bvh : Bvh
    With local boxes: built with detail 'inner' or 'all'.
surface : Surface, optional
    That of the BVH.
level : int, optional
    Of the tree: its BVs, and leaves above it, are the boxes. 0: one box, of the root.
proven : bool, optional
    False: the formula of engines, which proves nothing.
)")
        .def(py::init<const Needed<Tree>&, const SurfacePtr&, int, bool>(), py::arg("bvh"),
             py::arg("surface") = py::none(), py::kw_only(), py::arg("level") = 0, py::arg("proven") = true)
        .def("__call__", &CrowdObject::operator(), py::arg("maps"), py::kw_only(), py::arg("out") = py::none(),
             R"(Boxes of all bodies.

Parameters
----------
maps : array_like, shape (bodies, J, 3, 4)
out : numpy.ndarray, optional
    Where to write, float64 in C order.

Returns
-------
numpy.ndarray, shape (bodies, B, 2, 3)
    B as in `bvs`.
)")
        .def_property_readonly(
            "bvs", [](const py::object& self) { return py::cast<const CrowdObject&>(self).bvs(self); },
            "The BVs whose boxes these are, uint32.")
        .def_property_readonly("nbytes", &CrowdObject::bytes, "Of the rest data.");
}

} // namespace cinch::python
