// SPDX-License-Identifier: Apache-2.0
// In the place of what needs cinch::io, where that is not built.
#include "toolkit/c/call.hpp"

namespace {

template <class... Handle> cinch_status absent(Handle**... made)
{
    ((made ? void(*made = nullptr) : void()), ...);
    return cinch::c::call(
        [] { throw cinch::c::Fault(CINCH_ERROR_ABSENT, "this library was built without cinch::io (CINCH_IO)"); });
}

} // namespace

cinch_status cinch_surface_read(const char*, const char*, cinch_surface** made) { return absent(made); }
cinch_status cinch_character_read(const char*, int32_t, cinch_character** made) { return absent(made); }
cinch_status cinch_character_get_surface(const cinch_character*, cinch_surface** made, size_t*) { return absent(made); }
cinch_status cinch_character_get_clip(const cinch_character*, size_t, cinch_clip_info*) { return absent(); }
cinch_status cinch_character_sample(const cinch_character*, size_t, double, cinch_clip** made, size_t*)
{
    return absent(made);
}
cinch_status cinch_clip_get_frame(const cinch_clip*, size_t, double*, double*, size_t, double*, size_t)
{
    return absent();
}
cinch_status cinch_clip_bounder_new(const cinch_character*, size_t, const cinch_bvh*, const cinch_refit_options*,
                                    cinch_clip_bounder** made)
{
    return absent(made);
}
cinch_status cinch_clip_bounder_bound(cinch_clip_bounder*, const double*, size_t, double, double*, size_t)
{
    return absent();
}
cinch_status cinch_baked_read(const char*, cinch_baked** made, size_t*) { return absent(made); }
cinch_status cinch_baked_get_clip(const cinch_baked*, size_t, cinch_baked_clip*) { return absent(); }
cinch_status cinch_baked_get_supports(const cinch_baked*, size_t, double*, size_t, double*, size_t) { return absent(); }
cinch_status cinch_baked_box(const cinch_baked*, size_t, double, size_t, double*) { return absent(); }
