// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>

namespace cinch {

/// 1234567 → "1,234,567".
std::string grouped(std::size_t n);
/// "1 vertex", "2,000 vertices".
std::string counted(std::size_t n, const std::string& one, const std::string& many);
/// A duration for people: "0.4 s", "12 s", "3 min 20 s".
std::string duration(double seconds);

} // namespace cinch
