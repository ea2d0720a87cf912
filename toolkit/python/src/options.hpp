// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <string_view>

#include <pybind11/pybind11.h>

#include "cinch/bvh.hpp"
#include "cinch/refit.hpp"

namespace cinch::python {

namespace py = pybind11;

/// "precision: 'half' is unknown; known are 'float32' and 'float64'".
template <class T, std::size_t n>
T choice(const char* name, const std::string& text, const std::array<std::pair<std::string_view, T>, n>& known)
{
    std::string names;
    for (std::size_t i = 0; i < n; ++i) {
        if (known[i].first == text)
            return known[i].second;
        names += (i == 0 ? "'" : i + 1 < n ? ", '" : " and '") + std::string(known[i].first) + "'";
    }
    throw py::value_error(std::string(name) + ": '" + text + "' is unknown; known are " + names);
}

inline Methods methods_of(const std::string& text)
{
    const auto methods = named_methods(text);
    if (!methods) {
        std::string names;
        for (const std::string_view name : method_names())
            names += (names.empty() ? "" : ", ") + std::string(name);
        throw py::value_error("method: '" + text + "' is unknown; known are " + names +
                              ", and several with + between them");
    }
    return *methods;
}
inline Precision precision_of(const std::string& text)
{
    return choice<Precision, 2>("precision", text,
                                {{{"float32", Precision::float32}, {"float64", Precision::float64}}});
}
inline RestShape rest_shape_of(const std::string& text)
{
    return choice<RestShape, 2>("rest_shape", text, {{{"aabb", RestShape::aabb}, {"obb", RestShape::obb}}});
}
inline RestDetail detail_of(const std::string& text)
{
    return choice<RestDetail, 3>(
        "detail", text, {{{"boxes", RestDetail::boxes}, {"inner", RestDetail::inner}, {"all", RestDetail::all}}});
}
inline int kdop_of(int k)
{
    if (!is_kdop(k))
        throw py::value_error("k must be " + kdop_names());
    return k;
}

/// The options of a refit by their names. Throws TypeError for a name that is none.
inline RefitOptions refit_options(const py::kwargs& given)
{
    RefitOptions out;
    for (const auto& [key, value] : given) {
        const auto name = py::cast<std::string>(key);
        try {
            if (name == "method")
                out.methods = methods_of(py::cast<std::string>(value));
            else if (name == "kdop")
                out.kdop = kdop_of(py::cast<int>(value));
            else if (name == "proven")
                out.rounding = py::cast<bool>(value) ? Rounding::proven : Rounding::plain;
            else if (name == "precision")
                out.precision = precision_of(py::cast<std::string>(value));
            else if (name == "passes") {
                out.passes = py::cast<int>(value);
                if (out.passes < 0 || out.passes > 1000)
                    throw py::value_error("passes: from 0 to 1000 are needed, not " + std::to_string(out.passes));
            } else if (name == "rest_shape")
                out.rest_shape = rest_shape_of(py::cast<std::string>(value));
            else if (name == "remember")
                out.remember = py::cast<bool>(value);
            else
                throw py::type_error("there is no option '" + name +
                                     "'; known are method, kdop, proven, precision, passes, rest_shape, remember");
        } catch (const py::cast_error&) {
            throw py::type_error("option " + name + ": a " + std::string(py::str(py::type::of(value))) +
                                 " is none of its values");
        }
    }
    return out;
}

} // namespace cinch::python
