// SPDX-License-Identifier: Apache-2.0
#include "toolkit/surface/left_out.hpp"

namespace cinch {

void note_left_out(const std::vector<LeftOut>& kinds, std::vector<std::string>& notes)
{
    std::string list;
    std::size_t all = 0;
    for (const LeftOut& kind : kinds) {
        if (kind.count == 0)
            continue;
        list +=
            (list.empty() ? "" : ", ") + std::to_string(kind.count) + " " + (kind.count == 1 ? kind.one : kind.many);
        all += kind.count;
    }
    if (all > 0)
        notes.push_back(list + (all == 1 ? " bounds" : " bound") + " nothing; left out");
}

} // namespace cinch
