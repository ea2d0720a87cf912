// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl.h>

#include "cinch/deform.hpp"
#include "toolkit/python/src/calls.hpp"
#include "toolkit/python/src/frames.hpp"
#include "toolkit/python/src/module.hpp"
#include "toolkit/python/src/options.hpp"
#include "toolkit/python/src/weights.hpp"

namespace cinch::python {
namespace {

std::vector<Vec3> points_from(py::handle from, const char* name)
{
    const Doubles points(from, name);
    require_shape(points.array(), name, {any, 3});
    if (points.shape(0) >= std::numeric_limits<std::uint32_t>::max())
        throw py::value_error(std::string(name) + ": over 2^32 of them");
    require_finite(points.values(), name, 3);
    const auto rows = points.rows<Vec3>();
    return {rows.begin(), rows.end()};
}

// Calls each(frame, out) for every frame, without the GIL.
template <class Each>
py::array_t<double> over_frames(Frames& frames, std::size_t vertices, py::handle out, py::handle progress, Each&& each)
{
    py::array_t<double> array = result(out, frames.shape({vertices, 3}));
    const Pinned pinned(array);
    auto* const to = reinterpret_cast<Vec3*>(array.mutable_data());
    Ticker tick(progress);
    const py::gil_scoped_release unlocked;
    for (std::size_t f = 0; f < frames.count(); ++f) {
        each(f, std::span<Vec3>(to + f * vertices, vertices));
        tick(f + 1, frames.count());
    }
    return array;
}

py::array_t<double> evaluate_frames(const Needed<Surface>& surface, py::handle maps, py::handle rest, py::handle out,
                                    py::handle progress)
{
    surface->require_unchanged();
    const DeformableSurface& s = surface->get();
    Frames frames(maps, py::none(), s.weights.node_count, 0);
    const auto vertices = static_cast<py::ssize_t>(s.mesh.vertices.size());
    std::optional<Doubles> displaced;
    if (!rest.is_none()) {
        displaced.emplace(rest, "rest");
        require_shape(displaced->array(), "rest", {vertices, 3});
    }
    const std::span<const Vec3> from = displaced ? displaced->rows<Vec3>() : std::span(s.mesh.vertices);
    return over_frames(frames, s.mesh.vertices.size(), out, progress,
                       [&](std::size_t f, std::span<Vec3> to) { evaluate(from, s.weights, frames.maps(f), to); });
}

py::array_t<double> displaced(py::handle targets, py::handle weights, py::handle rest)
{
    const std::vector<Vec3> points = points_from(rest, "rest");
    const std::vector<MorphTarget> all = targets_from(targets, points.size());
    const Doubles given(weights, "weights");
    require_shape(given.array(), "weights", {any});
    py::array_t<double> out(std::vector<py::ssize_t>{static_cast<py::ssize_t>(points.size()), 3});
    const std::span<Vec3> to{reinterpret_cast<Vec3*>(out.mutable_data()), points.size()};
    std::copy(points.begin(), points.end(), to.begin());
    displace(all, given.values(), to);
    return out;
}

// Either arithmetic.
class EvaluatorObject {
public:
    EvaluatorObject(const Needed<Surface>& surface, const std::string& precision) : surface_(surface)
    {
        surface_->require_unchanged();
        if (surface_->get().mesh.vertices.empty())
            throw py::value_error("SurfaceEvaluator: a surface with vertices is needed");
        if (precision_of(precision) == Precision::float64)
            twice_.emplace(surface_->get());
        else
            single_.emplace(surface_->get());
    }
    py::array_t<double> operator()(py::handle maps, py::handle out, py::handle progress) const
    {
        surface_->require_unchanged();
        const DeformableSurface& s = surface_->get();
        Frames frames(maps, py::none(), s.weights.node_count, 0);
        return over_frames(frames, s.mesh.vertices.size(), out, progress, [&](std::size_t f, std::span<Vec3> to) {
            if (twice_)
                (*twice_)(frames.maps(f), to);
            else
                (*single_)(frames.maps(f), to);
        });
    }

private:
    SurfacePtr surface_;
    std::optional<SurfaceEvaluator<double>> twice_;
    std::optional<SurfaceEvaluator<float>> single_;
};

void require_count(std::size_t count)
{
    if (count > std::numeric_limits<std::uint32_t>::max())
        throw py::value_error("count: over 2^32 simulation nodes");
}

void add_nodes(py::module_& module)
{
    using Self = Needed<SimulationNodes>;
    py::class_<SimulationNodes, std::shared_ptr<SimulationNodes>>(module, "SimulationNodes",
                                                                  R"(Simulation nodes in rest position.

Parameters
----------
positions : array_like, shape (J, 3)
fill_distance : float
    The farthest that any point of the volume or surface is from its nearest simulation node.
)")
        .def(py::init([](py::handle positions, double fill_distance) {
                 if (!(std::isfinite(fill_distance) && fill_distance >= 0))
                     throw py::value_error("fill_distance: a finite number from 0 on is needed");
                 return std::make_shared<SimulationNodes>(
                     SimulationNodes{points_from(positions, "positions"), fill_distance});
             }),
             py::arg("positions"), py::arg("fill_distance"))
        .def_property_readonly(
            "positions",
            [](const Self& self) {
                return seen<double>(self->position.empty() ? nullptr : self->position[0].data(),
                                    {static_cast<py::ssize_t>(self->position.size()), 3}, py::cast(self));
            },
            "Shape (J, 3), in the unit of the surface. Cannot be written.")
        .def_readonly("fill_distance", &SimulationNodes::fill_distance,
                      "The farthest that any point is from its nearest simulation node.")
        .def("__len__", [](const Self& self) { return self->position.size(); });

    module.def(
        "sample_nodes",
        [](py::handle vertices, py::handle triangles, std::size_t count, std::uint64_t seed) {
            require_count(count);
            TriangleMesh mesh{points_from(vertices, "vertices"), {}};
            const py::array array = as_array(triangles, "triangles");
            require_shape(array, "triangles", {any, 3});
            const auto flat = indices(array, "triangles", mesh.vertices.size());
            for (std::size_t i = 0; i + 2 < flat.size(); i += 3)
                mesh.triangles.push_back({flat[i], flat[i + 1], flat[i + 2]});
            return std::make_shared<SimulationNodes>(
                apart([mesh = std::move(mesh), count, seed] { return sample_nodes(mesh, count, seed); }));
        },
        py::arg("vertices"), py::arg("triangles"), py::arg("count"), py::kw_only(), py::arg("seed") = 0,
        R"(Farthest-point samples of a closed volume: simulation nodes for a body without a skeleton.

Parameters
----------
vertices : array_like, shape (V, 3)
triangles : array_like of int, shape (T, 3)
count : int
    How many; fewer come where there are not that many distinct points.
seed : int, optional
    Chooses the first one.

Returns
-------
SimulationNodes
)");
    module.def(
        "kernel_weights",
        [](py::handle vertices, const SimulationNodes& nodes, double support) {
            if (!(std::isfinite(support) && support > 0))
                throw py::value_error("support: a finite number above 0 is needed");
            if (nodes.position.empty())
                throw py::value_error("kernel_weights: at least one simulation node is needed");
            TriangleMesh mesh{points_from(vertices, "vertices"), {}};
            return apart([mesh = std::move(mesh), nodes, support] {
                WeightsObject out;
                out.weights = kernel_weights(mesh, nodes, support, &out.alone);
                out.report.vertices = out.weights.vertex_count();
                return out;
            });
        },
        py::arg("vertices"), py::arg("nodes"), py::arg("support"),
        R"(Weights by the kernel (1 - r^2/h^2)^3 for r < h, normalised per vertex.

Parameters
----------
vertices : array_like, shape (V, 3)
nodes : SimulationNodes
support : float
    h in fill distances; 2 is usual. A vertex beyond the reach of every simulation node follows its nearest one alone;
    `Weights.alone` counts these.

Returns
-------
Weights
)");
}

} // namespace

void add_deform(py::module_& module)
{
    add_nodes(module);
    module.def("evaluate", &evaluate_frames, py::arg("surface"), py::arg("maps"), py::kw_only(),
               py::arg("rest") = py::none(), py::arg("out") = py::none(), py::arg("progress") = py::none(),
               R"(The vertices of a deformed surface, as every bound is proven to contain them.

Operations and their order are fixed: the same bits everywhere. Maps that are not finite give such coordinates.

Parameters
----------
surface : Surface
maps : array_like, shape (J, 3, 4) or (frames, J, 3, 4), or Clip
    Per simulation node the rows of (A | t): x becomes A x + t.
rest : array_like, shape (V, 3), optional
    Other vertices at rest, as `displace` makes them.
out : numpy.ndarray, optional
    Where to write, float64 in C order.
progress : callable, optional
    Called with the numbers of frames done and of all, now and then.

Returns
-------
numpy.ndarray, shape (V, 3) or (frames, V, 3)
)");
    module.def("displace", &displaced, py::arg("targets"), py::arg("weights"), py::arg("rest"),
               R"(Rest vertices displaced by morph targets.

Parameters
----------
targets : list of MorphTarget
weights : array_like, shape (targets,)
rest : array_like, shape (V, 3)

Returns
-------
numpy.ndarray, shape (V, 3)
)");
    py::class_<EvaluatorObject>(module, "SurfaceEvaluator", R"(All vertices of one surface, frame after frame, by SIMD.

Parameters
----------
surface : Surface
precision : {'float64', 'float32'}, optional
    With float64 the bits of `evaluate`; with float32 for pictures and files, not for proofs.
)")
        .def(py::init<const Needed<Surface>&, const std::string&>(), py::arg("surface"),
             py::arg("precision") = "float64")
        .def("__call__", &EvaluatorObject::operator(), py::arg("maps"), py::kw_only(), py::arg("out") = py::none(),
             py::arg("progress") = py::none(), "The same as `evaluate`, of this surface.");
}

} // namespace cinch::python
