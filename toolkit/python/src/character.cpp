// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "toolkit/python/src/animation.hpp"
#include "toolkit/python/src/calls.hpp"
#include "toolkit/python/src/module.hpp"
#include "toolkit/python/src/weights.hpp"

namespace cinch::python {
namespace {

CharacterPtr with_surface(Character&& character)
{
    auto out = std::make_shared<CharacterObject>();
    out->character = std::move(character);
    out->surface = std::make_shared<Surface>(surface_of(out->character, &out->report));
    return out;
}

CharacterPtr read(const std::filesystem::path& path, bool partial, bool morphs)
{
    return apart([path, partial, morphs] {
        return with_surface(read_gltf(path, partial ? Coverage::partial : Coverage::whole,
                                      morphs ? Morphs::read : Morphs::missing, decoders()));
    });
}

ClipPtr sampled(const Needed<CharacterObject>& self, py::handle clip, double fps)
{
    if (!(std::isfinite(fps) && fps > 0))
        throw py::value_error("fps: a finite number above 0 is needed");
    const AnimationObject chosen = animation_of(self, clip);
    return std::make_shared<ClipObject>(
        ClipObject{sample(self->character, *chosen.animation, fps), self->character.joints.size()});
}

CharacterPtr any_weights(const Needed<CharacterObject>& self, double least, double greatest)
{
    if (self->any_weights_of)
        throw py::value_error("the character's morph targets have any weights already");
    CharacterPtr out =
        apart([self, least, greatest] { return with_surface(with_any_weights(self->character, least, greatest)); });
    out->least = least;
    out->greatest = greatest;
    out->any_weights_of = self.object;
    return out;
}

template <class T, class Make> py::list list_of(const std::vector<T>& from, Make&& make)
{
    py::list out;
    for (const T& one : from)
        out.append(make(one));
    return out;
}

const char* name_of_target(Curve::Target target)
{
    constexpr const char* names[] = {"translation", "rotation", "scale"};
    return names[static_cast<std::size_t>(target)];
}
const char* name_of_interpolation(Curve::Interpolation interpolation)
{
    constexpr const char* names[] = {"step", "linear", "cubic_spline"};
    return names[static_cast<std::size_t>(interpolation)];
}

py::list curves_of(const AnimationObject& self)
{
    return list_of(self.animation->curves, [&](const Curve& curve) {
        py::dict out;
        out["bone"] = curve.bone;
        out["target"] = name_of_target(curve.target);
        out["interpolation"] = name_of_interpolation(curve.interpolation);
        out["time_s"] = copied<double>(curve.time_s, {static_cast<py::ssize_t>(curve.time_s.size())});
        const std::span<const double> values(curve.value.empty() ? nullptr : curve.value[0].data(),
                                             4 * curve.value.size());
        out["value"] = copied<double>(values, {static_cast<py::ssize_t>(curve.value.size()), 4});
        return out;
    });
}

py::list morph_curves_of(const AnimationObject& self)
{
    return list_of(self.animation->morphs, [&](const WeightCurve& curve) {
        py::dict out;
        out["first_target"] = curve.first_target;
        out["count"] = curve.count;
        out["interpolation"] = name_of_interpolation(curve.interpolation);
        out["time_s"] = copied<double>(curve.time_s, {static_cast<py::ssize_t>(curve.time_s.size())});
        out["value"] = copied<double>(curve.value, {static_cast<py::ssize_t>(curve.value.size())});
        return out;
    });
}

py::list bones_of(const Needed<CharacterObject>& self)
{
    return list_of(self->character.bones, [](const Bone& bone) {
        py::dict out;
        out["name"] = bone.name;
        out["parent"] = bone.parent;
        out["translation"] = py::make_tuple(bone.translation[0], bone.translation[1], bone.translation[2]);
        out["rotation"] = py::make_tuple(bone.rotation[0], bone.rotation[1], bone.rotation[2], bone.rotation[3]);
        out["scale"] = py::make_tuple(bone.scale[0], bone.scale[1], bone.scale[2]);
        out["matrix"] = bone.is_matrix ? py::object(copied<double>(bone.matrix, {4, 4}).attr("T")) : py::none();
        return out;
    });
}

void add_animation(py::module_& module)
{
    py::class_<AnimationObject>(module, "Animation", "A clip of a character, as its file has it: curves over time.")
        .def_property_readonly(
            "name", [](const AnimationObject& self) { return self.animation->name; }, "Unique within the file.")
        .def_property_readonly(
            "first_s", [](const AnimationObject& self) { return self.animation->first_s; }, "The first key, seconds.")
        .def_property_readonly(
            "last_s", [](const AnimationObject& self) { return self.animation->last_s; }, "The last key, seconds.")
        .def_property_readonly(
            "missing", [](const AnimationObject& self) { return self.animation->missing; },
            "What moves the surface in it and is not modelled.")
        .def_property_readonly(
            "notes", [](const AnimationObject& self) { return self.animation->notes; }, "What was changed.")
        .def_property_readonly(
            "fault", [](const AnimationObject& self) { return self.animation->fault; },
            "Why it cannot be sampled; empty where it can.")
        .def_property_readonly("curves", &curves_of, R"(Those that move bones: a list of dict.

'bone', 'target' ('translation', 'rotation' or 'scale'), 'interpolation' ('step', 'linear' or 'cubic_spline'), 'time_s',
shape (keys,), and 'value', shape (keys, 4), or (3 * keys, 4) for a cubic spline: in-tangent, value, out-tangent.)")
        .def_property_readonly("morphs", &morph_curves_of, R"(Those of the weights of morph targets: a list of dict.

'first_target', 'count', 'interpolation', 'time_s' and 'value', `count` per key, or three times that for a spline.)")
        .def("__repr__", [](const AnimationObject& self) {
            return "<cinch.Animation '" + self.animation->name + "', " + std::to_string(self.animation->first_s) +
                   " to " + std::to_string(self.animation->last_s) + " s>";
        });
}

} // namespace

AnimationObject animation_of(const CharacterPtr& character, py::handle clip)
{
    const auto& all = character->character.animations;
    if (clip.is_none())
        return {character, all.empty() ? &character->character.rest : &all[0]};
    if (py::isinstance<AnimationObject>(clip)) {
        const auto& given = py::cast<const AnimationObject&>(clip);
        if (given.of != character)
            throw py::value_error("clip: '" + given.animation->name + "' is of another character");
        return given;
    }
    if (!py::isinstance<py::str>(clip))
        throw py::type_error("clip: an Animation, its name or None is needed");
    const auto name = py::cast<std::string>(clip);
    std::string known;
    for (const Character::Animation& animation : all) {
        if (animation.name == name)
            return {character, &animation};
        known += (known.empty() ? "" : ", ") + animation.name;
    }
    throw py::value_error(character->character.file + ": has no clip '" + name + "'; it has " +
                          (known.empty() ? "none" : known));
}

void add_character(py::module_& module)
{
    add_animation(module);
    py::class_<CharacterObject, CharacterPtr>(module, "Character",
                                              R"(A character: every triangle that a glTF file draws, and how it moves.

Made by `read_character`. Vertices with equal position, weights and displacements are one vertex.
)")
        .def_property_readonly(
            "file", [](const CharacterObject& self) { return self.character.file; }, "Its file, for messages.")
        .def_property_readonly(
            "surface", [](const CharacterObject& self) { return self.surface; }, "Its `Surface` in bind pose.")
        .def_property_readonly(
            "clips",
            [](const Needed<CharacterObject>& self) {
                return list_of(self->character.animations, [&](const Character::Animation& a) {
                    return AnimationObject{self, &a};
                });
            },
            "Its animations, a list of `Animation`.")
        .def_property_readonly(
            "rest",
            [](const Needed<CharacterObject>& self) {
                return AnimationObject{self, &self->character.rest};
            },
            "The pose of the file, as an animation that moves nothing.")
        .def_property_readonly("bones", &bones_of, R"(Nodes of the scene graph that move joints: a list of dict.

'name', 'parent' (earlier in the list, or -1), 'translation', 'rotation' (x, y, z, w), 'scale', and 'matrix', shape (4,
4), where the file gives one, else None.)")
        .def_property_readonly(
            "joints",
            [](const CharacterObject& self) {
                return list_of(self.character.joints, [](const Joint& joint) { return joint.bone; });
            },
            "Of each simulation node the place of its bone in `bones`.")
        .def_property_readonly(
            "inverse_binds",
            [](const CharacterObject& self) {
                const auto& joints = self.character.joints;
                py::array_t<double> out(std::vector<py::ssize_t>{static_cast<py::ssize_t>(joints.size()), 3, 4});
                for (std::size_t j = 0; j < joints.size(); ++j)
                    std::copy_n(&joints[j].inverse_bind.m[0][0], 12, out.mutable_data() + 12 * j);
                return out;
            },
            "Of each simulation node the map from the mesh at rest to its bone, shape (J, 3, 4).")
        .def_property_readonly(
            "file_weights",
            [](const Needed<CharacterObject>& self) { return triplets(self->character.influences, py::cast(self)); },
            "Weights as the file has them, not normalised: (data, indices, indptr).")
        .def_property_readonly(
            "weight_report", [](const CharacterObject& self) { return self.report; },
            "A `WeightReport`: what normalising them changed.")
        .def_property_readonly(
            "targets",
            [](const CharacterObject& self) {
                return list_of(self.character.targets,
                               [](const MorphTarget& target) { return std::make_shared<MorphTarget>(target); });
            },
            "A list of `MorphTarget`.")
        .def_property_readonly(
            "target_weights", [](const CharacterObject& self) { return self.character.target_weights; },
            "Of the file, where no animation sets them.")
        .def_property_readonly(
            "skins", [](const CharacterObject& self) { return self.character.skins; }, "Of how many it is made.")
        .def_property_readonly(
            "carried", [](const CharacterObject& self) { return self.character.carried; }, "Meshes without a skin.")
        .def_property_readonly(
            "missing", [](const CharacterObject& self) { return self.character.missing; },
            "What is drawn or moves the surface, in whatever animation, and is not modelled.")
        .def_property_readonly(
            "notes", [](const CharacterObject& self) { return self.character.notes; },
            "What was left out since it bounds nothing.")
        .def("sample", &sampled, py::arg("clip") = py::none(), py::arg("fps") = 30, R"(Frames of an animation.

Parameters
----------
clip : Animation or str, optional
    By default the first one; the pose of the file where there is none.
fps : float, optional
    Frames per second, as near as evenly spaced times from the first key to the last allow.

Returns
-------
Clip
)")
        .def(
            "rest_pose",
            [](const Needed<CharacterObject>& self) {
                return std::make_shared<ClipObject>(
                    ClipObject{rest_pose(self->character), self->character.joints.size()});
            },
            "The pose of the file as a `Clip` of one frame.")
        .def("with_any_weights", &any_weights, py::arg("least") = 0, py::arg("greatest") = 1,
             R"(The character with its morph targets at any weights at any time, whatever its clips say.

Parameters
----------
least, greatest : float, optional
    The range of each weight.

Returns
-------
Character
    With one target of weight 1, whose displacements are boxes.
)")
        .def("__repr__", [](const CharacterObject& self) {
            return "<cinch.Character '" + self.character.file +
                   "': " + std::to_string(self.character.mesh.vertices.size()) + " vertices, " +
                   std::to_string(self.character.joints.size()) + " simulation nodes, " +
                   std::to_string(self.character.animations.size()) + " clips>";
        });
    module.def("read_character", &read, py::arg("path"), py::kw_only(), py::arg("partial") = false,
               py::arg("morphs") = true, R"(Read .gltf (with its .bin files), .glb or .vrm.

Parameters
----------
path : str or os.PathLike
partial : bool, optional
    Read what is modelled where something of the surface is not; `Character.missing` names it. Otherwise it is refused.
morphs : bool, optional
    Read morph targets, which otherwise are not modelled where their weights are not 0.

Returns
-------
Character

Raises
------
InputError
    One line with file, place and reason.
)");
}

} // namespace cinch::python
