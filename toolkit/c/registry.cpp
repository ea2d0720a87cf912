// SPDX-License-Identifier: Apache-2.0
#include "toolkit/c/registry.hpp"

#include <array>
#include <mutex>
#include <shared_mutex>
#include <string>
#include <unordered_map>

#include "toolkit/c/call.hpp"

namespace cinch::c {
namespace {

// A handle is its mark, which no address of a process has (bits 63 to 48 of these are equal, and of small numbers 0),
// its number from 1 on, and its kind. 2^40 handles take a process days.
static_assert(sizeof(void*) == sizeof(std::uint64_t), "handles need pointers of 64 bits");
constexpr std::uint64_t mark = 0xc19c, most_handles = std::uint64_t{1} << 40;
constexpr std::array names = {"surface",   "BVH",  "refitter",       "crowd",      "collider",
                              "character", "clip", "clip's bounder", "simulation", "file of bounds"};

std::uint64_t bits_of(std::uint64_t number, Kind kind)
{
    return mark << 48 | number << 8 | static_cast<std::uint8_t>(kind);
}
std::uint64_t bits_of(const void* handle) { return reinterpret_cast<std::uintptr_t>(handle); }

struct Registry {
    std::shared_mutex mutex;
    std::unordered_map<std::uint64_t, std::shared_ptr<void>> objects;
    std::uint64_t given = 0; // numbers
};

// Never destroyed: threads may still call while the process ends.
Registry& registry()
{
    static Registry& all = *new Registry;
    return all;
}

// Why it is no handle that is there. Called with the registry locked.
Fault fault_of(const Registry& all, std::uint64_t bits, const std::string& wanted)
{
    const std::uint64_t number = bits >> 8 & (most_handles - 1), kind = bits & 0xff;
    if (bits == 0)
        return {CINCH_ERROR_HANDLE, wanted + " is needed, not null"};
    if (bits >> 48 != mark || number == 0 || number > all.given || kind >= names.size())
        return {CINCH_ERROR_HANDLE, wanted + " is needed, and this is none"};
    return {CINCH_ERROR_HANDLE, std::string("the handle of a ") + names[kind] + " was freed"};
}

} // namespace

const char* name_of(Kind kind) { return names[static_cast<std::size_t>(kind)]; }

void* handle_of(std::shared_ptr<void> object, Kind kind)
{
    Registry& all = registry();
    const std::unique_lock lock(all.mutex);
    if (all.given + 1 == most_handles)
        throw std::length_error("there are no more handles");
    const std::uint64_t bits = bits_of(all.given + 1, kind);
    all.objects.emplace(bits, std::move(object));
    ++all.given;
    return reinterpret_cast<void*>(static_cast<std::uintptr_t>(bits));
}

std::shared_ptr<void> object_of(const void* handle, Kind kind)
{
    Registry& all = registry();
    const std::uint64_t bits = bits_of(handle);
    const std::shared_lock lock(all.mutex);
    const auto found = all.objects.find(bits);
    if (found == all.objects.end())
        throw fault_of(all, bits, std::string("the handle of a ") + name_of(kind));
    const std::size_t own = bits & 0xff;
    if (own != static_cast<std::size_t>(kind))
        throw Fault(CINCH_ERROR_HANDLE, std::string("the handle of a ") + name_of(kind) +
                                            " is needed, and this is that of a " + names[own]);
    return found->second;
}

void free_handle(const void* handle)
{
    if (!handle)
        return;
    Registry& all = registry();
    std::shared_ptr<void> last; // its object ends after the lock
    const std::unique_lock lock(all.mutex);
    const auto found = all.objects.find(bits_of(handle));
    if (found == all.objects.end())
        throw fault_of(all, bits_of(handle), "a handle");
    last = std::move(found->second);
    all.objects.erase(found);
}

InUse::InUse(std::atomic<bool>& busy, Kind kind) : busy_(busy)
{
    if (busy.exchange(true, std::memory_order_acquire))
        throw Fault(CINCH_ERROR_BUSY, std::string("the ") + name_of(kind) +
                                          " is in use, by another thread or by the call "
                                          "that called this one");
}

} // namespace cinch::c
