// SPDX-License-Identifier: Apache-2.0
// What makes up the module: each function adds the classes of one file.
#pragma once

#include <pybind11/pybind11.h>

namespace cinch::python {

void add_environment(pybind11::module_& module);
void add_surface(pybind11::module_& module);
void add_deform(pybind11::module_& module);
void add_character(pybind11::module_& module);
void add_files(pybind11::module_& module);
void add_bvh(pybind11::module_& module);
void add_refit(pybind11::module_& module);
void add_anytime(pybind11::module_& module);
void add_time(pybind11::module_& module);
void add_collider(pybind11::module_& module);
void add_swept(pybind11::module_& module);
void add_simulation(pybind11::module_& module);

} // namespace cinch::python
