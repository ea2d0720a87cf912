// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/memory.hpp"

#include "toolkit/simulate/stream.hpp"

namespace cinch {

void Memory::save(std::ostream& out) const
{
    write_list(out, values);
    reference.save(out);
    write_raw<double>(out, {&interval_s, 1});
}

void Memory::restore(std::istream& in)
{
    read_list(in, values);
    reference.restore(in);
    read_raw<double>(in, {&interval_s, 1});
}

} // namespace cinch
