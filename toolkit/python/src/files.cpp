// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "toolkit/python/src/calls.hpp"
#include "toolkit/python/src/module.hpp"
#include "toolkit/python/src/objects.hpp"
#include "toolkit/python/src/weights.hpp"

namespace cinch::python {
namespace {

ClipPtr clip_from(const std::string& name, py::handle times, py::handle maps)
{
    const Doubles time(times, "times"), given(maps, "maps");
    require_shape(time.array(), "times", {any});
    require_shape(given.array(), "maps", {static_cast<py::ssize_t>(time.size()), any, 3, 4});
    require_finite(time.values(), "times", 1);
    const std::size_t nodes = given.shape(1);
    std::vector<Clip::Frame> frames;
    const auto all = given.rows<AffineMap>();
    for (std::size_t f = 0; f < time.size(); ++f) {
        const auto frame = all.subspan(f * nodes, nodes);
        frames.emplace_back(frame.begin(), frame.end());
    }
    const auto t = time.values();
    return std::make_shared<ClipObject>(ClipObject{Clip(name, {t.begin(), t.end()}, std::move(frames)), nodes});
}

std::size_t frame_of(const ClipObject& self, py::ssize_t frame)
{
    const auto count = static_cast<py::ssize_t>(self.clip.frame_count());
    if (frame < 0)
        frame += count;
    if (frame < 0 || frame >= count)
        throw py::index_error("the clip has " + std::to_string(count) + " frames");
    return static_cast<std::size_t>(frame);
}

py::array_t<double> maps_of(const ClipObject& self, py::ssize_t frame)
{
    const Clip::Frame maps = self.clip.frame(frame_of(self, frame));
    py::array_t<double> out(std::vector<py::ssize_t>{static_cast<py::ssize_t>(maps.size()), 3, 4});
    std::copy_n(maps.empty() ? nullptr : &maps[0].m[0][0], 12 * maps.size(), out.mutable_data());
    return out;
}

py::array_t<double> all_maps(const ClipObject& self)
{
    const std::size_t count = self.clip.frame_count(), each = 12 * self.nodes;
    py::array_t<double> out(
        std::vector<py::ssize_t>{static_cast<py::ssize_t>(count), static_cast<py::ssize_t>(self.nodes), 3, 4});
    double* to = out.mutable_data();
    Ticker tick;
    const py::gil_scoped_release unlocked;
    for (std::size_t f = 0; f < count; ++f, to += each) {
        const Clip::Frame maps = self.clip.frame(f);
        if (maps.size() != self.nodes)
            throw std::logic_error("a frame of the clip has other simulation nodes");
        std::copy_n(maps.empty() ? nullptr : &maps[0].m[0][0], each, to);
        tick(f, count);
    }
    return out;
}

py::array_t<double> all_weights(const ClipObject& self)
{
    std::vector<double> flat;
    const auto count = self.clip.frame_count();
    std::size_t each = 0;
    for (std::size_t f = 0; f < count; ++f) {
        const std::vector<double> weights = self.clip.weights(f);
        each = weights.size();
        flat.insert(flat.end(), weights.begin(), weights.end());
    }
    return copied<double>(flat, {static_cast<py::ssize_t>(count), static_cast<py::ssize_t>(each)});
}

void add_clip(py::module_& module)
{
    py::class_<ClipObject, std::shared_ptr<ClipObject>>(module, "Clip",
                                                        R"(Motion as frames, each made when it is asked for.

Parameters
----------
name : str
times : array_like, shape (frames,)
    Seconds.
maps : array_like, shape (frames, J, 3, 4)
    Per frame and simulation node the rows of (A | t): x becomes A x + t. Copied.
)")
        .def(py::init(&clip_from), py::arg("name"), py::arg("times"), py::arg("maps"))
        .def_property_readonly(
            "name", [](const ClipObject& self) { return self.clip.name; }, "As files call it.")
        .def_property_readonly(
            "node_count", [](const ClipObject& self) { return self.nodes; }, "Simulation nodes that it moves.")
        .def_property_readonly(
            "displaces", [](const ClipObject& self) { return self.clip.displaces(); },
            "Whether morph targets displace vertices.")
        .def_property_readonly(
            "times",
            [](const ClipObject& self) {
                py::array_t<double> out(static_cast<py::ssize_t>(self.clip.frame_count()));
                for (std::size_t f = 0; f < self.clip.frame_count(); ++f)
                    out.mutable_data()[f] = self.clip.time_s(f);
                return out;
            },
            "Seconds, shape (frames,).")
        .def_property_readonly("maps", &all_maps, "Of all frames, shape (frames, J, 3, 4).")
        .def_property_readonly("weights", &all_weights,
                               "Of all morph targets, shape (frames, targets); (frames, 0) where none displaces.")
        .def("frame", &maps_of, py::arg("i"), "Maps of one frame, shape (J, 3, 4).")
        .def(
            "evenly_spread",
            [](const ClipObject& self, std::size_t frames) {
                return std::make_shared<ClipObject>(ClipObject{evenly_spread(self.clip, frames), self.nodes});
            },
            py::arg("frames"), R"(So many of its frames, evenly spread, the last one included.

Parameters
----------
frames : int
    0, and as many as it has or more, keep all.

Returns
-------
Clip
)")
        .def("__len__", [](const ClipObject& self) { return self.clip.frame_count(); })
        .def("__getitem__", &maps_of, py::arg("i"))
        .def("__repr__", [](const ClipObject& self) {
            return "<cinch.Clip '" + self.clip.name + "': " + std::to_string(self.clip.frame_count()) + " frames>";
        });
}

} // namespace

void add_files(py::module_& module)
{
    add_clip(module);
    using Self = Needed<MeshFile>;
    py::class_<MeshFile, std::shared_ptr<MeshFile>>(
        module, "Mesh", "The surface of a mesh file, as it declares it; made by `read_mesh`.")
        .def_property_readonly(
            "vertices",
            [](const Self& self) {
                const auto& v = self->mesh.vertices;
                return seen<double>(v.empty() ? nullptr : v[0].data(), {static_cast<py::ssize_t>(v.size()), 3},
                                    py::cast(self));
            },
            "Shape (V, 3), in the file's unit. Cannot be written.")
        .def_property_readonly(
            "triangles",
            [](const Self& self) {
                const auto& t = self->mesh.triangles;
                return seen<std::uint32_t>(t.empty() ? nullptr : t[0].data(), {static_cast<py::ssize_t>(t.size()), 3},
                                           py::cast(self));
            },
            "Indices of vertices, uint32, shape (T, 3). Cannot be written.")
        .def_readonly("notes", &MeshFile::notes, "What was left out or not read, one line each.");

    module.def(
        "read_mesh",
        [](const std::filesystem::path& path) {
            return apart([path] { return std::make_shared<MeshFile>(read_mesh(path)); });
        },
        py::arg("path"), R"(Read OBJ, OFF, PLY or STL, chosen by the extension.

Nothing is welded, dropped or reordered; polygons become triangle fans.

Parameters
----------
path : str or os.PathLike

Returns
-------
Mesh

Raises
------
InputError
    One line with file, line or byte, and reason.
)");
    module.def(
        "is_mesh_file", [](const std::filesystem::path& path) { return cinch::is_mesh_file(path); }, py::arg("path"),
        "Whether the extension is one that `read_mesh` knows.");
    module.def(
        "is_character_file", [](const std::filesystem::path& path) { return cinch::is_character_file(path); },
        py::arg("path"), "Whether the extension is .glb, .gltf or .vrm.");
    module.def(
        "read_weights",
        [](const std::filesystem::path& path, std::size_t vertices) {
            return apart([path, vertices] {
                WeightsObject out;
                out.weights = to_dyadic(read_weights_text(path, vertices), &out.report);
                return out;
            });
        },
        py::arg("path"), py::arg("vertices"), R"(Read weights as text, and normalise them.

First line ``V J``; then per vertex ``n j1 w1 ... jn wn``.

Parameters
----------
path : str or os.PathLike
vertices : int
    How many the mesh has.

Returns
-------
Weights

Raises
------
InputError
)");
    module.def(
        "read_clips",
        [](const std::filesystem::path& path, std::uint32_t nodes) {
            return apart([path, nodes] {
                std::vector<std::shared_ptr<ClipObject>> out;
                for (Clip& clip : read_clips_text(path, nodes))
                    out.push_back(std::make_shared<ClipObject>(ClipObject{std::move(clip), nodes}));
                return out;
            });
        },
        py::arg("path"), py::arg("nodes"), R"(Read clips of transforms as text.

First the number of clips; per clip a line ``name K J``, then K lines ``time`` and J times 12 numbers, the rows of
(A | t) of every simulation node.

Parameters
----------
path : str or os.PathLike
nodes : int
    J.

Returns
-------
list of Clip

Raises
------
InputError
)");
}

} // namespace cinch::python
