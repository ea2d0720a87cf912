// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/effect.hpp"

#include <map>
#include <mutex>

namespace cinch {
namespace {

std::mutex guard;
std::map<std::string, std::size_t>& constructions()
{
    static std::map<std::string, std::size_t> count;
    return count;
}

} // namespace

Effect::Effect(const char* name) : name_(name)
{
    const std::lock_guard lock(guard);
    ++constructions()[name];
}

std::size_t Effect::constructed(const std::string& name)
{
    const std::lock_guard lock(guard);
    const auto found = constructions().find(name);
    return found == constructions().end() ? 0 : found->second;
}

} // namespace cinch
