// SPDX-License-Identifier: Apache-2.0
// In the place of what needs cinch::simulate, where that is not built.
#include "toolkit/c/call.hpp"

namespace {

template <class... Handle> cinch_status absent(Handle**... made)
{
    ((made ? void(*made = nullptr) : void()), ...);
    return cinch::c::call([] {
        throw cinch::c::Fault(CINCH_ERROR_ABSENT, "this library was built without cinch::simulate (CINCH_SIMULATE)");
    });
}

} // namespace

cinch_status cinch_simulation_read(const char*, cinch_simulation** made) { return absent(made); }
cinch_status cinch_simulation_get_state(const cinch_simulation*, cinch_simulation_state*) { return absent(); }
cinch_status cinch_simulation_get_body(const cinch_simulation*, size_t, const char**, cinch_surface** made)
{
    return absent(made);
}
cinch_status cinch_simulation_advance(cinch_simulation*) { return absent(); }
cinch_status cinch_simulation_get_maps(const cinch_simulation*, size_t, double*, size_t, size_t*) { return absent(); }
