// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <istream>
#include <ostream>
#include <span>
#include <stdexcept>
#include <type_traits>

namespace cinch {

/// The bytes of plain values, for checkpoints: read back on the machine that wrote them.
template <class T> void write_raw(std::ostream& out, std::span<const T> values)
{
    static_assert(std::is_trivially_copyable_v<T>);
    out.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(values.size_bytes()));
}
template <class T> void read_raw(std::istream& in, std::span<T> values)
{
    static_assert(std::is_trivially_copyable_v<T>);
    in.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(values.size_bytes()));
}

} // namespace cinch
