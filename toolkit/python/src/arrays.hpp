// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "cinch/surface.hpp"

namespace cinch::python {

namespace py = pybind11;

static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(AffineMap) == 12 * sizeof(double), "rows of doubles");

/// Of a shape in messages: any number.
constexpr py::ssize_t any = -1;

/// "(30000, 3)".
inline std::string shape_text(std::span<const py::ssize_t> shape)
{
    std::string out = "(";
    for (const py::ssize_t n : shape)
        out += (n < 0 ? std::string("n") : std::to_string(n)) + ", ";
    if (!shape.empty() && shape.size() != 1)
        out.resize(out.size() - 2);
    else if (shape.size() == 1)
        out.pop_back();
    return out + ")";
}

/// Whether dimensions are as wanted, where `any` wants nothing.
inline bool fits(const py::array& array, std::initializer_list<py::ssize_t> shape)
{
    if (array.ndim() != static_cast<py::ssize_t>(shape.size()))
        return false;
    py::ssize_t axis = 0;
    for (const py::ssize_t n : shape)
        if (n != any && array.shape(axis++) != n)
            return false;
        else if (n == any)
            ++axis;
    return true;
}

inline std::string shape_of(const py::array& array)
{
    return shape_text({array.shape(), static_cast<std::size_t>(array.ndim())});
}

/// Throws ValueError unless the array has the shape.
inline void require_shape(const py::array& array, const char* name, std::initializer_list<py::ssize_t> shape)
{
    if (!fits(array, shape))
        throw py::value_error(std::string(name) + ": an array of shape " + shape_text({shape.begin(), shape.size()}) +
                              " is needed, not " + shape_of(array));
}

/// Any array or nested sequence of numbers, as NumPy makes an array of it. Throws ValueError.
inline py::array as_array(py::handle from, const char* name)
{
    if (py::isinstance<py::array>(from))
        return py::reinterpret_borrow<py::array>(from);
    PyObject* made =
        from.is_none() ? nullptr : py::detail::npy_api::get().PyArray_FromAny_(from.ptr(), nullptr, 0, 0, 0, nullptr);
    if (!made) {
        PyErr_Clear();
        throw py::value_error(std::string(name) + ": an array of numbers is needed");
    }
    return py::reinterpret_steal<py::array>(made);
}

/// Doubles in C order: the caller's own memory where it is laid out so, else a copy. While this lives the memory stays
/// where it is: NumPy resizes no array that is weakly referred to.
class Doubles {
public:
    Doubles() = default;
    Doubles(py::handle from, const char* name)
    {
        py::array array = as_array(from, name);
        const char kind = array.dtype().kind();
        if ((kind != 'f' && kind != 'i' && kind != 'u') || array.itemsize() > 8)
            throw py::value_error(std::string(name) + ": an array of float64 is needed, not of " +
                                  std::string(py::str(array.dtype())));
        using Wanted = py::array_t<double, py::array::c_style>;
        const bool as_it_is = Wanted::check_(array) && (array.flags() & py::detail::npy_api::NPY_ARRAY_ALIGNED_);
        if (as_it_is) {
            array_ = py::reinterpret_borrow<Wanted>(array);
            reference_ = py::reinterpret_steal<py::object>(PyWeakref_NewRef(array.ptr(), nullptr));
            if (!reference_)
                throw py::error_already_set();
        } else {
            array_ = py::reinterpret_steal<Wanted>(py::detail::npy_api::get().PyArray_FromAny_(
                array.ptr(), py::dtype::of<double>().release().ptr(), 0, 0,
                int{py::detail::npy_api::NPY_ARRAY_ENSUREARRAY_} | int{py::detail::npy_api::NPY_ARRAY_ALIGNED_} |
                    int{py::array::c_style} | int{py::array::forcecast},
                nullptr));
            if (!array_)
                throw py::error_already_set();
        }
    }

    const py::array& array() const { return array_; }
    py::ssize_t ndim() const { return array_.ndim(); }
    std::size_t shape(py::ssize_t axis) const { return static_cast<std::size_t>(array_.shape(axis)); }
    std::size_t size() const { return array_ ? static_cast<std::size_t>(array_.size()) : 0; }
    std::span<const double> values() const { return {array_.data(), size()}; }
    /// Rows of a type that is nothing but doubles: Vec3, AffineMap.
    template <class T> std::span<const T> rows() const
    {
        return {reinterpret_cast<const T*>(array_.data()), size() / (sizeof(T) / sizeof(double))};
    }

private:
    py::array_t<double, py::array::c_style> array_{};
    py::object reference_;
};

/// Throws ValueError, naming the first, unless all are numbers.
inline void require_finite(std::span<const double> values, const char* name, std::size_t per_row)
{
    for (std::size_t i = 0; i < values.size(); ++i)
        if (!std::isfinite(values[i]))
            throw py::value_error(std::string(name) + "[" + std::to_string(i / per_row) +
                                  "]: " + std::to_string(values[i]) + " is no finite number");
}

/// Whole numbers from 0 to below `limit`, copied: what is stored may not change. Throws ValueError, naming the first
/// that is out of range, and for arrays of other kinds.
inline std::vector<std::uint32_t> indices(py::handle from, const char* name, std::uint64_t limit)
{
    const py::array array = as_array(from, name);
    const char kind = array.dtype().kind();
    if (kind != 'i' && kind != 'u' && array.size() != 0)
        throw py::value_error(std::string(name) + ": an array of whole numbers is needed, not of " +
                              std::string(py::str(array.dtype())));
    const auto wide = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>::ensure(array);
    if (!wide)
        throw py::error_already_set();
    std::vector<std::uint32_t> out(static_cast<std::size_t>(wide.size()));
    for (std::size_t i = 0; i < out.size(); ++i) {
        const std::int64_t x = wide.data()[i];
        if (x < 0 || static_cast<std::uint64_t>(x) >= limit)
            throw py::value_error(std::string(name) + ": index " + std::to_string(x) + " at place " +
                                  std::to_string(i) + " is out of range; there are " + std::to_string(limit));
        out[i] = static_cast<std::uint32_t>(x);
    }
    return out;
}

/// Where results go: `given`, if it is an array of doubles of that shape that can be written as it stands, or a new
/// one where it is None.
inline py::array_t<double> result(py::handle given, const std::vector<py::ssize_t>& shape)
{
    if (given.is_none())
        return py::array_t<double>(shape);
    using Wanted = py::array_t<double, py::array::c_style>;
    if (!Wanted::check_(given))
        throw py::value_error("out: an array of float64 in C order is needed");
    auto array = py::reinterpret_borrow<py::array_t<double>>(given);
    const bool same =
        array.ndim() == static_cast<py::ssize_t>(shape.size()) && std::equal(shape.begin(), shape.end(), array.shape());
    if (!same)
        throw py::value_error("out: an array of shape " + shape_text(shape) + " is needed, not " + shape_of(array));
    if (!array.writeable() || !(array.flags() & py::detail::npy_api::NPY_ARRAY_ALIGNED_))
        throw py::value_error("out: the array cannot be written");
    return array;
}

/// While one lives, an array's memory stays where it is (see Doubles).
class Pinned {
public:
    explicit Pinned(py::handle array)
        : reference_(py::reinterpret_steal<py::object>(PyWeakref_NewRef(array.ptr(), nullptr)))
    {
        if (!reference_)
            throw py::error_already_set();
    }

private:
    py::object reference_;
};

/// What C++ has as an array that `base` keeps alive, without a copy; it cannot be written.
template <class T>
py::array seen(const T* data, std::vector<py::ssize_t> shape, py::object base, std::vector<py::ssize_t> strides = {})
{
    static const T nothing{};
    py::array array(py::dtype::of<T>(), std::move(shape), std::move(strides), data ? data : &nothing, std::move(base));
    py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
    return array;
}

/// A copy as a new array.
template <class T> py::array_t<T> copied(std::span<const T> values, std::vector<py::ssize_t> shape)
{
    py::array_t<T> array(std::move(shape));
    std::copy(values.begin(), values.end(), array.mutable_data());
    return array;
}

} // namespace cinch::python
