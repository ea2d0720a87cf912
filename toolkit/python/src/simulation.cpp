// SPDX-License-Identifier: Apache-2.0
#include <mutex>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "cinch/simulate.hpp"
#include "toolkit/python/src/animation.hpp"
#include "toolkit/python/src/calls.hpp"
#include "toolkit/python/src/module.hpp"

namespace cinch::python {
namespace {

// The first thing that a force of Python raised in a step.
struct Raised {
    std::mutex mutex;
    std::exception_ptr what;

    void keep(std::exception_ptr now)
    {
        const std::lock_guard lock(mutex);
        if (!what)
            what = std::move(now);
    }
    void rethrow()
    {
        const std::lock_guard lock(mutex);
        if (what)
            std::rethrow_exception(std::exchange(what, nullptr));
    }
};

// An object with energy() and force(). What it raises makes the step one that cannot be solved, and is raised again.
class PythonForce final : public OwnForce {
public:
    PythonForce(py::object force, std::shared_ptr<Raised> raised)
        : force_(new py::object(std::move(force)), release), raised_(std::move(raised))
    {
    }
    double energy(const Nodes& nodes) const override
    {
        const py::gil_scoped_acquire locked;
        try {
            return py::cast<double>(call("energy", nodes));
        } catch (...) {
            raised_->keep(std::current_exception());
            return std::numeric_limits<double>::quiet_NaN();
        }
    }
    void add(const Nodes& nodes, std::span<Vec3> force) const override
    {
        const py::gil_scoped_acquire locked;
        try {
            const Doubles given(call("force", nodes), "force");
            require_shape(given.array(), "force", {static_cast<py::ssize_t>(force.size()), 3});
            const auto rows = given.rows<Vec3>();
            for (std::size_t i = 0; i < force.size(); ++i)
                force[i] += rows[i];
        } catch (...) {
            raised_->keep(std::current_exception());
        }
    }

private:
    static void release(py::object* object)
    {
        const py::gil_scoped_acquire locked;
        delete object;
    }
    py::object call(const char* name, const Nodes& nodes) const
    {
        const auto n = static_cast<py::ssize_t>(nodes.position.size());
        const std::span<const double> flat(n ? nodes.position[0].data() : nullptr, 3 * nodes.position.size());
        return force_->attr(name)(copied<double>(flat, {n, 3}), copied<double>(nodes.mass, {n}), nodes.time_s);
    }

    std::shared_ptr<py::object> force_;
    std::shared_ptr<Raised> raised_;
};

struct SimulationFrame {
    std::size_t index;
    double time_s;
    py::tuple maps;
};

class SimulationObject : public std::enable_shared_from_this<SimulationObject> {
public:
    explicit SimulationObject(SceneSimulation&& scene) : scene_(std::move(scene)), surfaces_(scene_.body_count()) {}

    std::size_t checked(py::ssize_t body) const
    {
        const auto count = static_cast<py::ssize_t>(surfaces_.size());
        if (body < 0 || body >= count)
            throw py::index_error("body: " + std::to_string(body) + " is out of range; there are " +
                                  std::to_string(count));
        return static_cast<std::size_t>(body);
    }
    std::vector<std::string> names() const
    {
        std::vector<std::string> out;
        for (std::size_t b = 0; b < surfaces_.size(); ++b)
            out.push_back(scene_.name(b));
        return out;
    }
    SurfacePtr surface(py::ssize_t body)
    {
        std::weak_ptr<Surface>& seen = surfaces_[checked(body)];
        SurfacePtr out = seen.lock(); // one while somebody has it, so that trees over it know it again
        const DeformableSurface* there = scene_.surface(static_cast<std::size_t>(body));
        if (!out && there)
            seen = out = std::make_shared<Surface>(*there, shared_from_this());
        return out;
    }
    void add_force(py::ssize_t body, py::object force)
    {
        const Busy busy(busy_, "Simulation");
        for (const char* name : {"energy", "force"})
            if (!py::hasattr(force, name))
                throw py::type_error(std::string("force: an object with the methods energy and force is needed; it "
                                                 "has no ") +
                                     name);
        scene_.add(checked(body), std::make_unique<PythonForce>(std::move(force), raised_));
    }
    py::array_t<double> transforms(py::ssize_t body)
    {
        const Busy busy(busy_, "Simulation");
        return maps_of(checked(body));
    }
    std::size_t frame() const
    {
        const Busy busy(busy_, "Simulation");
        return scene_.frame();
    }
    std::size_t frame_count() const { return scene_.frame_count(); }
    double time_s() const
    {
        const Busy busy(busy_, "Simulation");
        return scene_.time_s();
    }
    void advance()
    {
        apart([self = shared_from_this()] {
            const Busy busy(self->busy_, "Simulation");
            try {
                self->scene_.advance();
            } catch (...) {
                self->raised_->rethrow(); // which says more
                throw;
            }
            self->raised_->rethrow();
        });
    }
    SimulationFrame next()
    {
        if (began_) {
            if (frame() + 1 >= frame_count())
                throw py::stop_iteration();
            advance();
        }
        began_ = true;
        const Busy busy(busy_, "Simulation");
        py::tuple maps(surfaces_.size());
        for (std::size_t b = 0; b < surfaces_.size(); ++b)
            maps[b] = maps_of(b);
        return {scene_.frame(), scene_.time_s(), std::move(maps)};
    }

private:
    py::array_t<double> maps_of(std::size_t body) const
    {
        const std::vector<AffineMap> maps = scene_.transforms(body);
        py::array_t<double> out(std::vector<py::ssize_t>{static_cast<py::ssize_t>(maps.size()), 3, 4});
        std::copy_n(maps.empty() ? nullptr : &maps[0].m[0][0], 12 * maps.size(), out.mutable_data());
        return out;
    }

    mutable std::atomic<bool> busy_{false};
    bool began_ = false;
    std::shared_ptr<Raised> raised_ = std::make_shared<Raised>();
    SceneSimulation scene_;
    std::vector<std::weak_ptr<Surface>> surfaces_;
};

} // namespace

void add_simulation(py::module_& module)
{
    py::class_<SimulationFrame>(module, "SimulationFrame", "The state of a simulated scene.")
        .def_readonly("index", &SimulationFrame::index, "0 at the start.")
        .def_readonly("time_s", &SimulationFrame::time_s, "Since the start, seconds.")
        .def_readonly("maps", &SimulationFrame::maps, "Per body its transforms, shape (J, 3, 4): a tuple of arrays.");

    py::class_<SimulationObject, std::shared_ptr<SimulationObject>>(
        module, "Simulation",
        R"(A scene of simulated bodies on its way through time: an iterator over its frames.

Parameters
----------
scene : str or os.PathLike
    A scene file (JSON); or, with `folder`, its text.
folder : str or os.PathLike, optional
    From which the text's relative file names are taken.

Raises
------
InputError
    One line with file, place in it and reason.

Examples
--------
>>> scene = cinch.Simulation("data/scenes/beam.json")
>>> refit = cinch.Refitter(cinch.build_bvh(scene.surface(0)))
>>> boxes = [refit(frame.maps[0]) for frame in scene]
)")
        .def(py::init([](py::object scene, py::object folder) {
                 if (folder.is_none())
                     return apart([file = py::cast<std::filesystem::path>(scene)] {
                         return std::make_shared<SimulationObject>(SceneSimulation(file, decoders()));
                     });
                 return apart([text = py::cast<std::string>(scene), at = py::cast<std::filesystem::path>(folder)] {
                     return std::make_shared<SimulationObject>(SceneSimulation(text, "scene", at, decoders()));
                 });
             }),
             py::arg("scene"), py::kw_only(), py::arg("folder") = py::none())
        .def_property_readonly("bodies", &SimulationObject::names, "Names, in the order of the scene: a list of str.")
        .def("surface", &SimulationObject::surface, py::arg("body"),
             "What a body's simulation nodes deform, a `Surface`; None where it has none.")
        .def("transforms", &SimulationObject::transforms, py::arg("body"),
             "At present, one map per simulation node, shape (J, 3, 4).")
        .def("add_force", &SimulationObject::add_force, py::arg("body"), py::arg("force"),
             R"(A force of one's own on a body, beside the scene's effects.

Parameters
----------
body : int
force : object
    With ``energy(positions, masses, time_s)``, U in J, and ``force(positions, masses, time_s)``, its -dU/dX in N, shape
    (J, 3). Positions in m, shape (J, 3), masses in kg. Called from several threads, one at a time.
)")
        .def("advance", &SimulationObject::advance, R"(To the next frame.

Raises
------
RuntimeError
    With time, body and reason for a step that cannot be solved; the state is that before it then.
)")
        .def_property_readonly("frame", &SimulationObject::frame, "0 at the start.")
        .def_property_readonly("frame_count", &SimulationObject::frame_count,
                               "That the scene asks for, the start included.")
        .def_property_readonly("time_s", &SimulationObject::time_s, "Since the start, seconds.")
        .def("__iter__", [](const Needed<SimulationObject>& self) { return self; })
        .def("__next__", &SimulationObject::next, "The next `SimulationFrame`, the present one first.");
}

} // namespace cinch::python
