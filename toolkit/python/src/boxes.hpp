// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace cinch::python {

/// Six supports of every BV, max x, max −x, max y, ..., become its box in their place: least x, y, z, greatest x, y, z.
inline void as_boxes(std::span<double> supports)
{
    for (double* s = supports.data(); s != supports.data() + supports.size(); s += 6) {
        const double high[3] = {s[0], s[2], s[4]};
        s[0] = -s[1];
        s[1] = -s[3];
        s[2] = -s[5];
        s[3] = high[0];
        s[4] = high[1];
        s[5] = high[2];
    }
}

} // namespace cinch::python
