// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl.h>

#include "toolkit/python/src/animation.hpp"
#include "toolkit/python/src/boxes.hpp"
#include "toolkit/python/src/calls.hpp"
#include "toolkit/python/src/module.hpp"
#include "toolkit/python/src/options.hpp"
#include "toolkit/time/bake_clip.hpp"
#include "toolkit/time/character_motion.hpp"

namespace cinch::python {
namespace {

// Throws ValueError unless the tree is over the character's surface.
void require_tree_of(const TreePtr& tree, const CharacterPtr& character)
{
    if (tree->surface != character->surface)
        throw py::value_error("the BVH was not built over the character's surface");
}

// Supports of all BVs become an array of boxes for k = 6.
py::array_t<double> boxed(std::vector<double>&& supports, std::size_t bvs, std::size_t k,
                          std::optional<std::size_t> intervals, bool boxes)
{
    std::vector<py::ssize_t> shape;
    if (intervals)
        shape.push_back(static_cast<py::ssize_t>(*intervals));
    shape.push_back(static_cast<py::ssize_t>(bvs));
    if (boxes && k == 6) {
        as_boxes(supports);
        shape.insert(shape.end(), {2, 3});
    } else {
        shape.push_back(static_cast<py::ssize_t>(k));
    }
    return copied<double>(supports, std::move(shape));
}

double time_from(py::handle from, const char* name)
{
    const double t = py::cast<double>(from);
    if (!std::isfinite(t))
        throw py::value_error(std::string(name) + ": a finite time in seconds is needed");
    return t;
}

class ClipBounderObject {
public:
    static std::shared_ptr<ClipBounderObject> make(const Needed<CharacterObject>& character, py::handle clip,
                                                   const Needed<Tree>& tree, const py::kwargs& options)
    {
        require_tree_of(tree, character);
        auto self = std::make_shared<ClipBounderObject>();
        self->chosen_ = animation_of(character, clip);
        self->tree_ = tree;
        self->kdop_ = static_cast<std::size_t>(refit_options(options).kdop);
        apart([self, how = refit_options(options)] {
            self->bound_.emplace(self->chosen_.of->character, *self->chosen_.animation, self->tree_->surface->get(),
                                 self->tree_->bvh, how);
        });
        return self;
    }

    // In parts, so that nobody waits for what is left behind.
    static py::array_t<double> call(const Needed<ClipBounderObject>& self, py::handle t0, py::handle t1,
                                    double tolerance, bool boxes)
    {
        if (!(std::isfinite(tolerance) && tolerance >= 0))
            throw py::value_error("tolerance: a finite number from 0 on is needed");
        const bool one = !py::isinstance<py::sequence>(t0) && !py::isinstance<py::array>(t0);
        std::vector<double> first, last;
        if (one) {
            first = {time_from(t0, "t0")};
            last = {time_from(t1, "t1")};
        } else {
            const Doubles begin(t0, "t0"), end(t1, "t1");
            require_shape(begin.array(), "t0", {any});
            require_shape(end.array(), "t1", {static_cast<py::ssize_t>(begin.size())});
            first.assign(begin.values().begin(), begin.values().end());
            last.assign(end.values().begin(), end.values().end());
            require_finite(first, "t0", 1);
            require_finite(last, "t1", 1);
        }
        const std::size_t bvs = self->tree_->bvh.bvs.size(), each = bvs * self->kdop_, count = first.size();
        std::vector<double> all = apart([self, first, last, tolerance, each](const std::atomic<bool>& stop) {
            const Busy busy(self->busy_, "ClipBounder");
            std::vector<double> out(first.size() * each);
            for (std::size_t i = 0; i < first.size() && !stop; ++i)
                (*self->bound_)(first[i], last[i], std::span(out).subspan(i * each, each), tolerance);
            return out;
        });
        return boxed(std::move(all), bvs, self->kdop_, one ? std::nullopt : std::optional(count), boxes);
    }

    const AnimationObject& clip() const { return chosen_; }

private:
    AnimationObject chosen_{};
    TreePtr tree_;
    std::size_t kdop_ = 6;
    std::optional<ClipBounder> bound_; // there once it is made
    std::atomic<bool> busy_{false};
};

py::array_t<double> bounds_of(const Baked& baked, bool boxes)
{
    std::vector<double> all;
    for (const BakedInterval& interval : baked.intervals)
        all.insert(all.end(), interval.supports.begin(), interval.supports.end());
    return boxed(std::move(all), baked.tree->bvh.bvs.size(), baked.kdop, baked.intervals.size(), boxes);
}

std::shared_ptr<Baked> bake(const Needed<CharacterObject>& character, py::handle clip, py::handle tree,
                            py::handle interval_s, bool whole, double tolerance, py::handle engine_options,
                            py::handle progress, const py::kwargs& options)
{
    const RefitOptions how = refit_options(options);
    ClipCuts cuts{whole, interval_s.is_none() ? 0 : time_from(interval_s, "interval"), tolerance};
    if (!interval_s.is_none() && !(cuts.interval_s > 0))
        throw py::value_error("interval: a length above 0 s is needed");
    if (!(std::isfinite(tolerance) && tolerance >= 0))
        throw py::value_error("tolerance: a finite number from 0 on is needed");
    Engine engine;
    if (!engine_options.is_none())
        for (const auto& [key, value] : py::cast<py::dict>(engine_options)) {
            const auto name = py::cast<std::string>(key);
            if (name == "float32")
                engine.float32 = py::cast<bool>(value);
            else if (name == "nlerp")
                engine.nlerp = py::cast<bool>(value);
            else if (name == "joint_error")
                engine.joint_error = py::cast<double>(value);
            else
                throw py::value_error("engine: '" + name + "' is unknown; known are float32, nlerp and joint_error");
        }
    if (!(std::isfinite(engine.joint_error) && engine.joint_error >= 0))
        throw py::value_error("engine: joint_error is a finite number from 0 on");
    // An engine's sums are rounded against all that they add up, which the extent of their box holds only with 0 in it.
    if (!engine.exact() && character->any_weights_of && (character->least > 0 || character->greatest < 0))
        throw py::value_error("engine: the limits of with_any_weights must have 0 between them");
    auto out = std::make_shared<Baked>();
    out->character = character;
    out->clip = animation_of(character, clip);
    out->kdop = static_cast<std::size_t>(how.kdop);
    if (tree.is_none()) {
        out->tree = apart([surface = character->surface] {
            return std::make_shared<Tree>(Tree{build_bvh(surface->get(), 4), surface});
        });
    } else {
        out->tree = needed<Tree>(tree, "bvh");
        require_tree_of(out->tree, character);
    }
    const auto& animation = *out->clip.animation;
    if (cuts.interval_s > 0 && (animation.last_s - animation.first_s) / cuts.interval_s > 1e7)
        throw py::value_error("interval: over ten million of them");
    Ticker tick(progress);
    const py::gil_scoped_release unlocked;
    TimedMotion motion = character_motion(character->character, animation, character->surface->get(), engine);
    const double length = motion.last_s() - motion.first_s();
    std::size_t permille = 0;
    motion.over = [over = std::move(motion.over), &tick, &permille](double a, double b) {
        tick(permille, 1000);
        return over(a, b);
    };
    IntervalRefitter refit(out->tree->bvh, character->surface->get(), how, character->character.targets);
    out->intervals = bake_clip(refit, motion, cuts, out->tree->bvh.bvs.size(), [&](double t) {
        permille = length > 0 ? static_cast<std::size_t>(999 * (t - motion.first_s()) / length) : 0;
        tick(permille, 1000);
    });
    tick(1000, 1000);
    return out;
}

void add_baked(py::module_& module)
{
    py::class_<Baked, std::shared_ptr<Baked>>(module, "Baked", "Bounds of a clip for all times; made by `bake`.")
        .def_property_readonly(
            "name", [](const Baked& self) { return self.clip.animation->name; }, "Of the clip.")
        .def_property_readonly(
            "clip", [](const Baked& self) { return self.clip; }, "The `Animation`.")
        .def_property_readonly(
            "character", [](const Baked& self) { return self.character; }, "The `Character`.")
        .def_property_readonly(
            "bvh", [](const Baked& self) { return self.tree; }, "The `Bvh` whose BVs are bounded.")
        .def_property_readonly(
            "times",
            [](const Baked& self) {
                std::vector<double> flat;
                for (const BakedInterval& interval : self.intervals)
                    flat.insert(flat.end(), {interval.first_s, interval.last_s});
                return copied<double>(flat, {static_cast<py::ssize_t>(self.intervals.size()), 2});
            },
            "First and last second of every interval, shape (intervals, 2).")
        .def_property_readonly(
            "bounds", [](const Baked& self) { return bounds_of(self, true); },
            "Boxes, shape (intervals, BVs, 2, 3), for kdop 6; else supports, shape (intervals, BVs, k). A copy.")
        .def_property_readonly(
            "supports", [](const Baked& self) { return bounds_of(self, false); }, "Shape (intervals, BVs, k). A copy.")
        .def_readonly("kdop", &Baked::kdop, "The number of directions.")
        .def("__len__", [](const Baked& self) { return self.intervals.size(); });
}

} // namespace

void add_time(py::module_& module)
{
    py::class_<ClipBounderObject, std::shared_ptr<ClipBounderObject>>(
        module, "ClipBounder",
        R"(Bounds of every BV of a character for all times of a clip.

Every curve as the glTF specification interpolates it, morph targets and parts without a skin included.

Parameters
----------
character : Character
clip : Animation or str or None
    None: the first one.
bvh : Bvh
    Over the character's surface.
**options
    Those of `Refitter`.
)")
        .def(py::init(&ClipBounderObject::make), py::arg("character"), py::arg("clip"), py::arg("bvh"))
        .def(
            "__call__",
            [](const Needed<ClipBounderObject>& self, py::handle t0, py::handle t1, double tolerance) {
                return ClipBounderObject::call(self, t0, t1, tolerance, true);
            },
            py::arg("t0"), py::arg("t1"), py::kw_only(), py::arg("tolerance") = 0.01,
            R"(Bounds that hold at every real time of an interval, or of each of some.

Parameters
----------
t0, t1 : float or array_like, shape (intervals,)
    First and last second, both included, between the clip's own.
tolerance : float, optional
    How much wider they may be than bounds at single times, as a share of a BV's half diagonal.

Returns
-------
numpy.ndarray, shape ([intervals,] BVs, 2, 3) or ([intervals,] BVs, k)
)")
        .def(
            "supports",
            [](const Needed<ClipBounderObject>& self, py::handle t0, py::handle t1, double tolerance) {
                return ClipBounderObject::call(self, t0, t1, tolerance, false);
            },
            py::arg("t0"), py::arg("t1"), py::kw_only(), py::arg("tolerance") = 0.01,
            "The same as a call, as supports for every k: shape ([intervals,] BVs, k).")
        .def_property_readonly("clip", &ClipBounderObject::clip, "The `Animation`.");

    add_baked(module);
    module.def("bake", &bake, py::arg("character"), py::arg("clip") = py::none(), py::arg("bvh") = py::none(),
               py::kw_only(), py::arg("interval") = py::none(), py::arg("whole") = false, py::arg("tolerance") = 0.01,
               py::arg("engine") = py::none(), py::arg("progress") = py::none(),
               R"(Bounds of a clip for all real times, cut into intervals: what ``cinch bake`` writes.

Parameters
----------
character : Character
clip : Animation or str, optional
    By default the first one; the pose of the file where there is none.
bvh : Bvh, optional
    Over the character's surface; by default with at most 4 triangles per leaf.
interval : float, optional
    Seconds of each interval. By default intervals are such that a cut in two halves would make the character's box
    smaller by less than a tenth.
whole : bool, optional
    One interval for the clip.
tolerance : float, optional
    How much wider bounds may be than at single times, as a share of a BV's half diagonal.
engine : dict, optional
    How an engine departs from the exact motion, which bounds then hold too: 'float32' (bool), 'nlerp' (bool),
    'joint_error' (float).
progress : callable, optional
    Called with how far it is, of 1000, now and then. What it raises ends the call.
**options
    Those of `Refitter`.

Returns
-------
Baked
)");
}

} // namespace cinch::python
