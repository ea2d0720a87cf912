// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstring>
#include <span>
#include <vector>

#include "cinch/surface.hpp"

namespace cinch::python {

// A TriangleMesh owns its vertices in a std::vector, and the language has no way for one to take memory that is there.
// Here it is done by what every implementation in use is, three pointers: begin, end and end of capacity. Whether this
// one is so is asked of a vector that knows the answer, once, before any is made to stand in foreign memory; where it
// is not, vertices are copied. Nothing but reads may happen to such a vector until stands_no_more, which leaves an
// empty one: its surface is const to all who use it.

/// Whether vectors of this library are three pointers.
inline bool vectors_are_pointers()
{
    static const bool answer = [] {
        using Vector = std::vector<Vec3>;
        if (sizeof(Vector) != 3 * sizeof(const Vec3*))
            return false;
        Vector some(5, Vec3::Zero());
        some.reserve(64); // all three differ
        const Vec3* is[3];
        std::memcpy(is, static_cast<const void*>(&some), sizeof is);
        const Vector none;
        const Vec3* of_none[3];
        std::memcpy(of_none, static_cast<const void*>(&none), sizeof of_none);
        return is[0] == some.data() && is[1] == some.data() + some.size() && is[2] == some.data() + some.capacity() &&
               !of_none[0] && !of_none[1] && !of_none[2];
    }();
    return answer;
}

/// Makes an empty vector stand in `rows`, where that can be done. The memory must stay as long as it does.
inline bool stands_in(std::vector<Vec3>& vector, std::span<const Vec3> rows)
{
    if (!vectors_are_pointers() || vector.capacity() != 0)
        return false;
    const Vec3* is[3] = {rows.data(), rows.data() + rows.size(), rows.data() + rows.size()};
    std::memcpy(static_cast<void*>(&vector), is, sizeof is);
    return true;
}

/// Before it is destroyed.
inline void stands_no_more(std::vector<Vec3>& vector)
{
    const Vec3* none[3] = {};
    std::memcpy(static_cast<void*>(&vector), none, sizeof none);
}

} // namespace cinch::python
