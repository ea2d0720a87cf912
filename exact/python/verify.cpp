// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/stl.h>

#include "exact/clip_enclosure.hpp"
#include "exact/python/module.hpp"
#include "exact/time_check.hpp"
#include "exact/verifier.hpp"
#include "toolkit/python/src/frames.hpp"
#include "toolkit/python/src/options.hpp"

namespace cinch::python {
namespace {

std::atomic<std::thread::id> main_thread{};
thread_local std::chrono::steady_clock::time_point looked{};

} // namespace

void expect_signals()
{
    const py::object threading = py::module_::import("threading");
    if (threading.attr("current_thread")().is(threading.attr("main_thread")()))
        main_thread = std::this_thread::get_id();
}

void pause()
{
    if (std::this_thread::get_id() != main_thread.load())
        return;
    const auto now = std::chrono::steady_clock::now();
    if (now - looked < look_every)
        return;
    looked = now;
    const py::gil_scoped_acquire locked;
    throw_if_signalled();
}

namespace {

struct Verdict {
    exact::FrameVerdict frame;
    std::size_t bvs, k;

    std::size_t violated() const
    {
        std::size_t count = 0;
        for (const std::uint8_t mask : frame.failed)
            count += mask != 0;
        return count;
    }
    template <class Get> py::array_t<double> per_bv(Get get) const
    {
        py::array_t<double> out(static_cast<py::ssize_t>(bvs));
        for (std::size_t i = 0; i < bvs; ++i)
            out.mutable_data()[i] = get(frame.bvs[i]);
        return out;
    }
    std::vector<py::ssize_t> shape() const { return {static_cast<py::ssize_t>(bvs), static_cast<py::ssize_t>(k)}; }
};

py::list examples_of(const std::vector<exact::Violation>& from)
{
    py::list out;
    for (const exact::Violation& v : from) {
        py::dict one;
        one["bv"] = v.bv;
        one["direction"] = v.direction < 0 ? py::object(py::none()) : py::int_(v.direction);
        one["statement"] = exact::name_of(v.statement);
        one["detail"] = v.detail;
        out.append(one);
    }
    return out;
}

class VerifierObject {
public:
    VerifierObject(const Needed<Tree>& tree, const SurfacePtr& surface, py::handle targets)
        : tree_(tree), targets_(targets_from(targets, surface_of_tree(tree_, surface).mesh.vertices.size()))
    {
        for (const MorphTarget& target : targets_)
            if (!target.half.empty())
                throw py::value_error("targets: displacements that are boxes have no exact place");
        expect_signals();
        const py::gil_scoped_release unlocked;
        verifier_.emplace(tree_->surface->get(), tree_->bvh, pause, targets_);
    }

    py::object check(py::handle maps, py::handle bounds, const std::string& method, py::handle kdop,
                     const std::string& rest_shape, py::handle weights, py::handle progress) const
    {
        tree_->surface->require_unchanged();
        const Methods methods = methods_of(method);
        const RestShape shape = rest_shape_of(rest_shape);
        const std::size_t bvs = tree_->bvh.bvs.size();
        Frames frames(maps, weights, tree_->surface->get().weights.node_count, targets_.size());
        const py::array all = as_array(bounds, "bounds");
        if (!frames.single() && (all.ndim() == 0 || all.shape(0) != static_cast<py::ssize_t>(frames.count())))
            throw py::value_error("bounds: those of " + std::to_string(frames.count()) + " frames are needed, not " +
                                  shape_of(all));
        std::optional<int> k;
        if (!kdop.is_none())
            k = kdop_of(py::cast<int>(kdop));
        expect_signals();
        py::list out;
        for (std::size_t f = 0; f < frames.count(); ++f) {
            const py::object one = frames.single() ? py::object(all) : py::object(all[py::int_(f)]);
            const std::vector<double> supports = supports_from(one, bvs, k);
            const std::size_t of_each = bvs ? supports.size() / bvs : 6;
            Verdict verdict{{}, bvs, of_each};
            {
                const py::gil_scoped_release unlocked;
                verdict.frame = verifier_->check(frames.maps(f), methods, static_cast<int>(of_each), supports, shape,
                                                 frames.weights(f));
            }
            out.append(std::move(verdict));
            throw_if_signalled();
            if (!progress.is_none())
                progress(f + 1, frames.count());
        }
        return frames.single() ? py::object(out[0]) : py::object(out);
    }

    const std::vector<std::string>& faults() const { return verifier_->rest_data_faults(); }
    const TreePtr& tree() const { return tree_; }

private:
    TreePtr tree_;
    std::vector<MorphTarget> targets_;
    std::optional<exact::Verifier> verifier_;
};

exact::TimeVerdict verify_times(const Baked& baked, py::handle bounds, py::handle progress)
{
    const std::size_t bvs = baked.tree->bvh.bvs.size();
    std::vector<std::vector<double>> given; // instead of its own
    if (!bounds.is_none()) {
        const py::array all = as_array(bounds, "bounds");
        if (all.ndim() == 0 || all.shape(0) != static_cast<py::ssize_t>(baked.intervals.size()))
            throw py::value_error("bounds: those of " + std::to_string(baked.intervals.size()) +
                                  " intervals are needed, not " + shape_of(all));
        for (std::size_t i = 0; i < baked.intervals.size(); ++i)
            given.push_back(supports_from(all[py::int_(i)], bvs, static_cast<int>(baked.kdop)));
    }
    const CharacterObject& of = *baked.character;
    const CharacterObject& read = of.any_weights_of ? *of.any_weights_of : of;
    std::optional<exact::Enclosure> any_weights;
    if (of.any_weights_of)
        any_weights = exact::Enclosure{of.least, of.greatest};
    expect_signals();
    Ticker tick(progress);
    const py::gil_scoped_release unlocked;
    const exact::ClipEnclosure enclosure(read.character, *baked.clip.animation, any_weights);
    const exact::TimeChecker check(of.surface->get(), baked.tree->bvh, enclosure, read.character.targets,
                                   static_cast<int>(baked.kdop), pause);
    exact::TimeVerdict out;
    for (std::size_t i = 0; i < baked.intervals.size(); ++i) {
        const BakedInterval& interval = baked.intervals[i];
        out.add(check(interval.first_s, interval.last_s, given.empty() ? interval.supports : given[i]));
        tick(i + 1, baked.intervals.size());
    }
    return out;
}

py::object worst_of(const exact::TimeVerdict& self)
{
    if (!self.worst)
        return py::none();
    py::dict out;
    out["bv"] = self.worst->bv;
    out["direction"] = self.worst->direction;
    out["vertex"] = self.worst->vertex;
    out["time_s"] = self.worst->time_s;
    out["bound"] = self.worst->bound;
    out["at_least"] = self.worst->at_least;
    return out;
}

void add_verdicts(py::module_& module)
{
    py::class_<Verdict>(module, "Verdict", "What was decided, in exact arithmetic, of the bounds of one frame.")
        .def_property_readonly(
            "bounds", [](const Verdict& self) { return self.frame.failed.size(); }, "BVs times directions.")
        .def_property_readonly(
            "proven", [](const Verdict& self) { return self.frame.failed.size() - self.violated(); },
            "Bounds of which all statements hold.")
        .def_property_readonly("violated", &Verdict::violated, "The others: 0 unless something is wrong.")
        .def_property_readonly(
            "failed", [](const Verdict& self) { return copied<std::uint8_t>(self.frame.failed, self.shape()); },
            R"(Which statements do not hold, uint8, shape (BVs, k): 0, or a sum of

1, the rest box and weight intervals hold all vertices; 2, the bound is at least the exact maximum over the weight
space; 4, it is at least every vertex in real arithmetic; 8, and as `cinch.evaluate` computes it.)")
        .def_property_readonly(
            "examples", [](const Verdict& self) { return examples_of(self.frame.examples); },
            "The first few violations: a list of dict of 'bv', 'direction', 'statement' and 'detail'.")
        .def_property_readonly(
            "decided_by_filter", [](const Verdict& self) { return self.frame.decided_by_filter; },
            "Bounds that interval arithmetic settled; the rest took exact arithmetic.")
        .def_property_readonly(
            "true_radius",
            [](const Verdict& self) { return self.per_bv([](const exact::BvReport& b) { return b.true_radius; }); },
            "Half diagonals of the true boxes, shape (BVs,).")
        .def_property_readonly(
            "bound_radius",
            [](const Verdict& self) { return self.per_bv([](const exact::BvReport& b) { return b.bound_radius; }); },
            "Half diagonals of the bounds, shape (BVs,).")
        .def_property_readonly(
            "loss",
            [](const Verdict& self) {
                py::array_t<double> out(std::vector<py::ssize_t>{static_cast<py::ssize_t>(self.bvs), 4});
                for (std::size_t i = 0; i < self.bvs; ++i) {
                    const exact::Loss& loss = self.frame.bvs[i].loss;
                    const double parts[] = {loss.box, loss.interval, loss.corner, loss.rounding};
                    std::copy_n(parts, 4, out.mutable_data() + 4 * i);
                }
                return out;
            },
            R"(What bounds give away per direction, on average, shape (BVs, 4), in the unit of the surface:

for rest boxes, for weight intervals, for what the method takes of these, for rounding.)")
        .def_property_readonly(
            "lambda_", [](const Verdict& self) { return copied<double>(self.frame.lambda, self.shape()); },
            "Of the methods convex, corners, eq12 and limited: D(lambda) certifies the bound, shape (BVs, k).");

    py::class_<exact::TimeVerdict>(module, "TimeVerdict", "What was decided of bounds over intervals of time.")
        .def_readonly("bounds", &exact::TimeVerdict::bounds, "BVs times directions times intervals.")
        .def_property_readonly("proven", &exact::TimeVerdict::proven, "For all real times.")
        .def_readonly("violated", &exact::TimeVerdict::violated, "Refuted by a vertex and a time.")
        .def_readonly("undecided", &exact::TimeVerdict::undecided, "Neither, after all halvings.")
        .def_readonly("pieces", &exact::TimeVerdict::pieces, "Intervals of time looked at.")
        .def_property_readonly("worst", &worst_of,
                               "A dict of 'bv', 'direction', 'vertex', 'time_s', 'bound' and 'at_least', or None.");
}

} // namespace

void add_verify(py::module_& module)
{
    add_verdicts(module);
    py::class_<VerifierObject>(module, "Verifier", R"(Proves the bounds of one BVH, frame by frame, in exact arithmetic.

Shares data with the toolkit, and no algorithm.

Parameters
----------
bvh : cinch.Bvh
surface : cinch.Surface, optional
    That of the BVH.
targets : list of cinch.MorphTarget, optional
)")
        .def(py::init<const Needed<Tree>&, const SurfacePtr&, py::handle>(), py::arg("bvh"),
             py::arg("surface") = py::none(), py::arg("targets") = py::tuple())
        .def("check", &VerifierObject::check, py::arg("maps"), py::arg("bounds"), py::kw_only(),
             py::arg("method") = "best", py::arg("kdop") = py::none(), py::arg("rest_shape") = "aabb",
             py::arg("weights") = py::none(), py::arg("progress") = py::none(),
             R"(Decide the bounds of one frame or of many.

Parameters
----------
maps : array_like, shape (J, 3, 4) or (frames, J, 3, 4), or cinch.Clip
    Finite.
bounds : array_like, shape ([frames,] BVs, 2, 3) or ([frames,] BVs, k)
    Boxes or supports, as a `cinch.Refitter` makes them.
method : str, optional
    That made them; some make a statement on weight spaces too.
kdop : int, optional
rest_shape : {'aabb', 'obb'}, optional
weights : array_like, optional
    Of the morph targets; by default those of the clip.
progress : callable, optional
    Called with the numbers of frames done and of all.

Returns
-------
Verdict, or a list of them for many frames
)")
        .def_property_readonly("bvh", &VerifierObject::tree, "The BVH.")
        .def_property_readonly("rest_data_faults", &VerifierObject::faults,
                               "Why rest data fail, per BV: a list of str, empty where they hold.");

    module.def(
        "verify",
        [](const Needed<Tree>& tree, py::handle maps, py::handle bounds, const py::kwargs& options) {
            return py::cast(VerifierObject(tree, nullptr,
                                           options.contains("targets") ? py::object(options["targets"]) : py::tuple()))
                .attr("check")(
                    maps, bounds, **[&] {
                        py::dict rest = options.attr("copy")();
                        rest.attr("pop")("targets", py::none());
                        return rest;
                    }());
        },
        py::arg("bvh"), py::arg("maps"), py::arg("bounds"), R"(Decide bounds at once: a `Verifier` and its check.

Parameters
----------
bvh : cinch.Bvh
maps : array_like, shape (J, 3, 4) or (frames, J, 3, 4), or cinch.Clip
bounds : array_like, shape ([frames,] BVs, 2, 3) or ([frames,] BVs, k)
**options
    'targets' of the `Verifier`, the others of `Verifier.check`.

Returns
-------
Verdict, or a list of them for many frames
)");
    module.def("verify_times", &verify_times, py::arg("baked"), py::kw_only(), py::arg("bounds") = py::none(),
               py::arg("progress") = py::none(),
               R"(Decide bounds for all real times, on the curves of the file themselves.

Parameters
----------
baked : cinch.Baked
bounds : array_like, shape (intervals, BVs, 2, 3) or (intervals, BVs, k), optional
    Instead of its own.
progress : callable, optional
    Called with the numbers of intervals done and of all, now and then.

Returns
-------
TimeVerdict
)");
}

} // namespace cinch::python
