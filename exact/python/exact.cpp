// SPDX-License-Identifier: GPL-3.0-or-later
// The module cinch.exact._exact: the exact side, of the objects of cinch._core.
#include "exact/python/module.hpp"

#include "exact/check_failed.hpp"

PYBIND11_MODULE(_exact, module)
{
    using namespace cinch::python;
    pybind11::module_::import("cinch._core"); // whose classes these functions take
    module.doc() = "The compiled part of cinch.exact; see that package's own pages.";
    say_type_error();
    py::register_local_exception<cinch::CheckFailed>(module, "CheckFailed", PyExc_RuntimeError).attr("__doc__") =
        "A check that the exact side makes of itself, and that failed.";
    join_at_exit(module);
    add_verify(module);
    add_corners(module);
    add_volumes(module);
}
