// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/number.hpp"

#include <fmt/format.h>

namespace cinch {

std::string grouped(std::size_t n)
{
    std::string digits = std::to_string(n);
    for (std::ptrdiff_t i = static_cast<std::ptrdiff_t>(digits.size()) - 3; i > 0; i -= 3)
        digits.insert(static_cast<std::size_t>(i), ",");
    return digits;
}

std::string counted(std::size_t n, const std::string& one, const std::string& many)
{
    return grouped(n) + " " + (n == 1 ? one : many);
}

std::string duration(double seconds)
{
    if (seconds < 9.95)
        return fmt::format("{:.1f} s", seconds);
    if (seconds < 99.5)
        return fmt::format("{:.0f} s", seconds);
    return fmt::format("{:d} min {:d} s", static_cast<int>(seconds) / 60, static_cast<int>(seconds) % 60);
}

} // namespace cinch
