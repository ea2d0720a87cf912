// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
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

/// A list with its length before it. What is read was checked by the checkpoint's own checksum; a length that the
/// stream does not hold makes it fail.
template <class List> void write_list(std::ostream& out, const List& list)
{
    const std::size_t count = list.size();
    write_raw<std::size_t>(out, {&count, 1});
    write_raw<typename List::value_type>(out, list);
}
template <class List> void read_list(std::istream& in, List& list)
{
    std::size_t count = 0;
    read_raw<std::size_t>(in, {&count, 1});
    if (!in || count > static_cast<std::size_t>(std::max<std::streamsize>(in.rdbuf()->in_avail(), 0)) /
                           sizeof(typename List::value_type)) {
        in.setstate(std::ios::failbit);
        return;
    }
    list.resize(count);
    read_raw<typename List::value_type>(in, list);
}

} // namespace cinch
