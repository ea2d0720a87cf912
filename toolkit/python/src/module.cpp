// SPDX-License-Identifier: Apache-2.0
#include "toolkit/python/src/module.hpp"

#include <pybind11/stl.h>

#include "cinch/bounds.hpp"
#include "cinch/environment.hpp"
#include "toolkit/python/src/arrays.hpp"
#include "toolkit/python/src/calls.hpp"

namespace cinch::python {
namespace {

// A context: the thread's arithmetic is the default one from __enter__ to __exit__.
class DefaultArithmeticContext {
public:
    void enter()
    {
        if (inside_)
            throw std::runtime_error("default_arithmetic: entered already");
        inside_ = std::make_unique<DefaultArithmetic>();
        thread_ = std::this_thread::get_id();
    }
    void exit()
    {
        if (thread_ != std::this_thread::get_id())
            throw std::runtime_error("default_arithmetic: left by another thread than entered it");
        inside_.reset();
    }

private:
    std::unique_ptr<DefaultArithmetic> inside_;
    std::thread::id thread_;
};

} // namespace

void add_environment(py::module_& module)
{
    module.attr("__version__") = CINCH_VERSION;
    py::register_exception<InputError>(module, "InputError", PyExc_ValueError).attr("__doc__") =
        "A file that cannot be read, or what it says cannot be.\n\n"
        "The message is one line: file, line or byte, and reason. A ValueError.";

    module.def("require_default_arithmetic", &require_default_arithmetic,
               R"(Ask whether this thread's arithmetic is the one that every guarantee rests on.

It must round to nearest and keep subnormal numbers. A library that was linked with ``-ffast-math`` and imported before
may have changed it for the whole thread. Asked wherever numbers are made that bounds rest on.

Raises
------
RuntimeError
    If it is not.
)");
    py::class_<DefaultArithmeticContext>(module, "default_arithmetic",
                                         R"(A context in which this thread's arithmetic is the default one.

Rounded to nearest, with subnormal numbers, no traps; afterwards it is what it was.

Examples
--------
>>> with cinch.default_arithmetic():
...     boxes = refit(maps)
)")
        .def(py::init<>())
        .def("__enter__", &DefaultArithmeticContext::enter)
        .def("__exit__", [](DefaultArithmeticContext& self, const py::args&) { self.exit(); });

    module.def(
        "axes",
        [](int k) {
            if (!is_kdop(k))
                throw py::value_error("k must be " + kdop_names());
            const auto axes = axes_of(k);
            py::array_t<double> out(std::vector<py::ssize_t>{static_cast<py::ssize_t>(axes.size()), 3});
            for (std::size_t a = 0; a < axes.size(); ++a)
                for (std::size_t c = 0; c < 3; ++c)
                    out.mutable_data()[3 * a + c] = axes[a][c];
            return out;
        },
        py::arg("k"), R"(The axes of a k-DOP.

Parameters
----------
k : int
    6, 14, 18 or 26.

Returns
-------
numpy.ndarray, shape (k/2, 3)
    Components in {-1, 0, 1}, not normalised; the coordinate axes come first. A bound has k supports: place 2a is the
    greatest ``axes[a] @ x``, place 2a + 1 the greatest ``-axes[a] @ x``.
)");
    module.def(
        "methods", [] { return method_names(); },
        R"(The names of the bounding methods, in the order of the ladder.

Returns
-------
list of str
    Several, joined by ``+``, are intersected: ``"support+linear"``.
)");
    module.attr("kdops") = py::make_tuple(6, 14, 18, 26);
    join_at_exit(module);
}

} // namespace cinch::python

PYBIND11_MODULE(_core, module)
{
    using namespace cinch::python;
    module.doc() = "The compiled part of cinch; see the package's own pages.";
    say_type_error();
    add_environment(module);
    add_surface(module);
    add_deform(module);
    add_character(module);
    add_files(module);
    add_bvh(module);
    add_refit(module);
    add_anytime(module);
    add_time(module);
    add_collider(module);
    add_swept(module);
    add_simulation(module);
}
