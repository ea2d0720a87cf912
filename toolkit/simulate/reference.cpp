// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/reference.hpp"

#include "toolkit/simulate/stream.hpp"

namespace cinch {

void Reference::save(std::ostream& out) const
{
    write_raw<double>(out, {origin.data(), 3});
    write_raw<double>(out, {low.data(), 3});
    write_raw<double>(out, {rotation.data(), 9});
    write_raw<double>(out, {centre.data(), 3});
}

void Reference::restore(std::istream& in)
{
    read_raw<double>(in, {origin.data(), 3});
    read_raw<double>(in, {low.data(), 3});
    read_raw<double>(in, {rotation.data(), 9});
    read_raw<double>(in, {centre.data(), 3});
}

} // namespace cinch
