// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <utility>

namespace cinch::c {

/// What a handle stands for.
enum class Kind : std::uint8_t {
    surface,
    bvh,
    refitter,
    crowd,
    collider,
    character,
    clip,
    clip_bounder,
    simulation,
    baked,
};
/// As sentences have it.
const char* name_of(Kind kind);

/// A new handle of an object: a number that no handle had before, and that is no address.
void* handle_of(std::shared_ptr<void> object, Kind kind);
/// The object of a handle, which stays alive as long as this pointer. Throws Fault, with a sentence for null, for what
/// never was a handle, for one that was freed and for one of another kind.
std::shared_ptr<void> object_of(const void* handle, Kind kind);
/// Ends a handle of whatever kind. Throws Fault likewise, but not for null.
void free_handle(const void* handle);

/// The same for what says its kind and the type of its handles.
template <class T> std::shared_ptr<T> get(const typename T::Handle* handle)
{
    return std::static_pointer_cast<T>(object_of(handle, T::kind));
}
/// A new handle of what was just made.
template <class T> typename T::Handle* put(std::shared_ptr<T> object)
{
    return static_cast<typename T::Handle*>(handle_of(std::move(object), T::kind));
}

/// Of what does one thing at a time: while it lives, others cannot begin. Throws Fault where it is in use.
class InUse {
public:
    InUse(std::atomic<bool>& busy, Kind kind);
    ~InUse() { busy_.store(false, std::memory_order_release); }
    InUse(const InUse&) = delete;
    InUse& operator=(const InUse&) = delete;

private:
    std::atomic<bool>& busy_;
};

} // namespace cinch::c
