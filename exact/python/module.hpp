// SPDX-License-Identifier: GPL-3.0-or-later
// What makes up the module: each function adds what stands in one file.
#pragma once

#include <thread>

#include "toolkit/python/src/calls.hpp"
#include "toolkit/python/src/objects.hpp"

namespace cinch::python {

void add_verify(py::module_& module);
void add_corners(py::module_& module);
void add_volumes(py::module_& module);

/// "p/q" as fractions.Fraction.
inline py::object fraction(const std::string& text) { return py::module_::import("fractions").attr("Fraction")(text); }

/// Called now and then by whatever thread does a part of a proof; the one that the interpreter handles signals in looks
/// for Ctrl-C. Throws what its handler raises. Without the GIL.
void pause();
/// Says that this thread is that one, where it is. With the GIL, before each call that pauses.
void expect_signals();

} // namespace cinch::python
