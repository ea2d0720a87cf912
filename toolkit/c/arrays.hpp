// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "cinch/bounds.hpp"

namespace cinch::c {

/// Rows are as the library has them: 3 doubles a Vec3, 12 an AffineMap, 6 an Aabb, 3 indices a Triangle.
static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(AffineMap) == 12 * sizeof(double) &&
              sizeof(Aabb) == 6 * sizeof(double) && sizeof(Triangle) == 3 * sizeof(std::uint32_t));

/// What is given by a pointer that must not be null, and aligned.
template <class T> T& given(T* pointer, const char* name)
{
    if (!pointer)
        throw std::invalid_argument(std::string(name) + " is null");
    if (reinterpret_cast<std::uintptr_t>(pointer) % alignof(T) != 0)
        throw std::invalid_argument(std::string(name) + " is not aligned to " + std::to_string(alignof(T)) + " bytes");
    return *pointer;
}

/// An array of so many rows, each a Row. Throws std::invalid_argument for a null pointer to any, for one that is not
/// aligned, and for more than there can be.
template <class Row, class T> auto array(T* pointer, std::size_t rows, const char* name)
{
    using Element = std::conditional_t<std::is_const_v<T>, const Row, Row>;
    if (rows == 0)
        return std::span<Element>();
    given(pointer, name);
    if (rows > static_cast<std::size_t>(std::numeric_limits<std::ptrdiff_t>::max()) / sizeof(Row))
        throw std::invalid_argument(std::string(name) + " cannot have " + std::to_string(rows) + " rows");
    return std::span<Element>(reinterpret_cast<Element*>(pointer), rows);
}

/// The same where only one number of rows fits.
template <class Row, class T> auto array_of(T* pointer, std::size_t rows, std::size_t wanted, const char* name)
{
    if (rows != wanted)
        throw std::invalid_argument(std::string(name) + " has " + std::to_string(rows) + " rows; " +
                                    std::to_string(wanted) + " are needed");
    return array<Row>(pointer, rows, name);
}

/// a·b, as what no array has where it is too large.
inline std::size_t times(std::size_t a, std::size_t b)
{
    return b > 0 && a > std::numeric_limits<std::size_t>::max() / b ? std::numeric_limits<std::size_t>::max() : a * b;
}

/// A list of whatever length: how many there are, and the first ones of them. Writes nothing where there is no room.
template <class Row, class List, class T>
void write_list(const List& list, T* out, std::size_t capacity, std::size_t* count)
{
    given(count, "count");
    const auto to = array<Row>(out, out ? capacity : 0, "the list");
    *count = list.size();
    std::copy_n(list.begin(), std::min(list.size(), to.size()), to.begin());
}

} // namespace cinch::c
