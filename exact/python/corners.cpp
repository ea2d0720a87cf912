// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/stl.h>

#include "exact/answers.hpp"
#include "exact/corners.hpp"
#include "exact/python/module.hpp"
#include "toolkit/bounds/rounding.hpp"
#include "toolkit/bounds/weight_space.hpp"

namespace cinch::python {
namespace {

std::vector<double> numbers(py::handle from, const char* name, std::optional<std::size_t> n = {})
{
    const Doubles given(from, name);
    require_shape(given.array(), name, {n ? static_cast<py::ssize_t>(*n) : any});
    require_finite(given.values(), name, 1);
    return {given.values().begin(), given.values().end()};
}

struct Space {
    std::vector<double> l, h;
    WeightSpace view() const { return {l, h}; }
};

Space space_from(py::handle l, py::handle h)
{
    Space out{numbers(l, "l"), {}};
    if (out.l.empty())
        throw py::value_error("l: at least one weight is needed");
    out.h = numbers(h, "h", out.l.size());
    for (std::size_t j = 0; j < out.l.size(); ++j)
        if (!(0 <= out.l[j] && out.l[j] <= out.h[j] && out.h[j] <= 1))
            throw py::value_error("weight " + std::to_string(j) + ": 0 <= l <= h <= 1 is needed, not l = " +
                                  std::to_string(out.l[j]) + ", h = " + std::to_string(out.h[j]));
    return out;
}

// The toolkit's proven bound for extrema that are exact as given: method 'limited' without a box.
double toolkit_bound(WeightSpace space, std::span<const double> b)
{
    std::vector<std::pair<double, double>> scratch;
    return std::min({*std::max_element(b.begin(), b.end()), dual_bound(space, b, second_largest(b), Rounding::proven),
                     dual_bound(space, b, best_lambda(space, b, scratch), Rounding::proven)});
}

struct Optimum {
    exact::Answer answer;
    double bound;
};

py::list fractions(const std::vector<std::string>& from)
{
    py::list out;
    for (const std::string& one : from)
        out.append(fraction(one));
    return out;
}

py::list corners(py::handle l, py::handle h, py::handle limit)
{
    const Space space = space_from(l, h);
    const std::optional<std::uint64_t> most =
        limit.is_none() ? std::nullopt : std::optional(py::cast<std::uint64_t>(limit));
    py::list out;
    if (most == 0u)
        return out;
    exact::visit_corners(space.view(), [&](const exact::CornerRun& run, const exact::Corner& corner) {
        throw_if_signalled();
        out.append(fractions(exact::weights_of(space.view(), run, corner)));
        return !most || py::len(out) < *most;
    });
    return out;
}

} // namespace

void add_corners(py::module_& module)
{
    py::class_<Optimum>(module, "Optimum", R"(The exact maximum of sum(w * b) over a weight space, with its certificate.

The corner attains it, and D(lambda) equals it, so that nothing exceeds it; both were checked before it was returned.
)")
        .def_property_readonly(
            "value", [](const Optimum& self) { return fraction(self.answer.maximum); }, "A Fraction.")
        .def_property_readonly(
            "lambda_", [](const Optimum& self) { return fraction(self.answer.lambda); }, R"(A Fraction.

D(x) = x + sum(h * max(b - x, 0) - l * max(x - b, 0)), which for every x is at least the maximum.)")
        .def_property_readonly(
            "corner", [](const Optimum& self) { return fractions(self.answer.corner); },
            "Weights that attain it: a list of Fraction.")
        .def_property_readonly(
            "eq12",
            [](const Optimum& self) { return self.answer.eq12 ? fraction(*self.answer.eq12) : py::object(py::none()); },
            "The paper's Eq. 12, a Fraction; None for a single weight.")
        .def_readonly("bound", &Optimum::bound, "The toolkit's proven double bound, or the one that was given.")
        .def_property_readonly(
            "bound_holds", [](const Optimum& self) { return self.answer.bound_holds; },
            "Whether the bound is at least the maximum.");

    module.def(
        "is_feasible", [](py::handle l, py::handle h) { return exact::is_feasible(space_from(l, h).view()); },
        py::arg("l"), py::arg("h"), R"(Whether any weights between l and h sum to 1, exactly.

Parameters
----------
l, h : array_like, shape (n,)
    0 <= l <= h <= 1.

Returns
-------
bool
)");
    module.def("corners", &corners, py::arg("l"), py::arg("h"), py::kw_only(), py::arg("limit") = py::none(),
               R"(The vertices of the weight space { w : sum(w) = 1, l <= w <= h }, each once, exactly.

Parameters
----------
l, h : array_like, shape (n,)
    0 <= l <= h <= 1.
limit : int, optional
    No more than so many.

Returns
-------
list of list of fractions.Fraction
    Empty where no weights sum to 1.
)");
    module.def(
        "count_corners",
        [](py::handle l, py::handle h) -> py::object {
            const exact::CornerCount count =
                apart([space = space_from(l, h)] { return exact::count_corners(space.view()); });
            if (!count.count)
                return py::none();
            return py::int_(py::str(*count.count));
        },
        py::arg("l"), py::arg("h"), R"(The number of vertices of the weight space, without listing them.

Parameters
----------
l, h : array_like, shape (n,)
    0 <= l <= h <= 1.

Returns
-------
int or None
    None where there are too many weights to count within reason.
)");
    module.def(
        "optimum",
        [](py::handle l, py::handle h, py::handle b, py::handle bound) -> py::object {
            const Space space = space_from(l, h);
            const std::vector<double> extrema = numbers(b, "b", space.l.size());
            const double claimed = bound.is_none() ? toolkit_bound(space.view(), extrema) : py::cast<double>(bound);
            auto answer = exact::answer(space.view(), extrema, claimed);
            if (!answer)
                return py::none();
            return py::cast(Optimum{std::move(*answer), claimed});
        },
        py::arg("l"), py::arg("h"), py::arg("b"), py::kw_only(), py::arg("bound") = py::none(),
        R"(The exact maximum of sum(w * b) over all weights between l and h that sum to 1.

Parameters
----------
l, h : array_like, shape (n,)
    0 <= l <= h <= 1.
b : array_like, shape (n,)
    Finite.
bound : float, optional
    Whether it holds is decided; by default the toolkit's own proven bound.

Returns
-------
Optimum or None
    None where no weights sum to 1.
)");
}

} // namespace cinch::python
