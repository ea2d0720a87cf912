// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include <pybind11/pybind11.h>

namespace cinch::python {

/// An object that is there, as an argument: a shared pointer would be null for None.
template <class T> struct Needed {
    std::shared_ptr<T> object;

    T* operator->() const { return object.get(); }
    T& operator*() const { return *object; }
    operator const std::shared_ptr<T>&() const { return object; }
};

/// The same out of a list or tuple. Throws TypeError.
template <class T> std::shared_ptr<T> needed(pybind11::handle from, const char* name)
{
    if (from.is_none() || !pybind11::isinstance<T>(from))
        throw pybind11::type_error(
            std::string(name) + ": a " + std::string(pybind11::str(pybind11::type::of<T>().attr("__name__"))) +
            " is needed, not a " + std::string(pybind11::str(pybind11::type::handle_of(from).attr("__name__"))));
    return pybind11::cast<std::shared_ptr<T>>(from);
}

} // namespace cinch::python

namespace pybind11::detail {

template <class T> struct type_caster<cinch::python::Needed<T>> {
    using Inner = copyable_holder_caster<T, std::shared_ptr<T>>;
    static constexpr auto name = Inner::name;
    template <class> using cast_op_type = cinch::python::Needed<T>;

    bool load(handle from, bool convert) { return !from.is_none() && inner_.load(from, convert); }
    operator cinch::python::Needed<T>() { return {static_cast<std::shared_ptr<T>&>(inner_)}; }
    static handle cast(const cinch::python::Needed<T>& from, return_value_policy policy, handle parent)
    {
        return Inner::cast(from.object, policy, parent);
    }

private:
    Inner inner_;
};

} // namespace pybind11::detail
