// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/study/lists.hpp"

#include <charconv>
#include <set>

#include <fmt/format.h>

#include "cinch/surface.hpp"

namespace cinch {

std::vector<std::uint64_t> parse_list(std::string_view text, std::string_view what)
{
    constexpr std::size_t most = 100000;
    auto refuse = [&](std::string_view part) {
        return InputError(fmt::format("{}: expected whole numbers as 7, 1-20 or 16..512, found '{}'", what, part));
    };
    auto number = [&](std::string_view digits, std::string_view part) {
        std::uint64_t value = 0;
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
        if (digits.empty() || error != std::errc() || end != digits.data() + digits.size())
            throw refuse(part);
        return value;
    };
    std::vector<std::uint64_t> all;
    std::set<std::uint64_t> seen;
    auto take = [&](std::uint64_t value) {
        if (!seen.insert(value).second)
            throw InputError(fmt::format("{}: {} is there twice", what, value));
        if (all.size() == most)
            throw InputError(fmt::format("{}: more than {} numbers", what, most));
        all.push_back(value);
    };
    for (std::size_t at = 0; at <= text.size();) {
        const std::size_t comma = std::min(text.find(',', at), text.size());
        const std::string_view part = text.substr(at, comma - at);
        at = comma + 1;
        const std::size_t dots = part.find(".."), dash = part.find('-');
        if (dots == std::string_view::npos && dash == std::string_view::npos) {
            take(number(part, part));
            continue;
        }
        const bool doubled = dots != std::string_view::npos;
        const std::uint64_t first = number(part.substr(0, doubled ? dots : dash), part),
                            last = number(part.substr(doubled ? dots + 2 : dash + 1), part);
        if (first > last || (doubled && first == 0))
            throw refuse(part);
        for (std::uint64_t value = first;;) {
            take(value);
            if (value == last)
                break;
            value = !doubled ? value + 1 : value > last / 2 ? last : 2 * value;
        }
    }
    return all;
}

} // namespace cinch
