// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>

#include "toolkit/simulate/reference.hpp"

namespace cinch {

/// What an effect remembers from one step to the next: all that its future depends on beside where the nodes are and
/// how they move. A value: a copy is all that it takes to come back to it. Before the first step it is empty.
struct Memory {
    Field values;          ///< in a layout of the effect's own
    Reference reference;   ///< from which places and displacements among them are seen
    double interval_s = 0; ///< length of the step at whose beginning it was made

    void save(std::ostream& out) const;
    void restore(std::istream& in);
};

} // namespace cinch
