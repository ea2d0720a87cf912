// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include <nlohmann/json.hpp>

namespace cinch {

/// Numbers in rows: JSON has none that are not finite, so these are null.
inline nlohmann::ordered_json or_null(double x)
{
    return std::isfinite(x) ? nlohmann::ordered_json(x) : nlohmann::ordered_json();
}
inline double number_or(const nlohmann::ordered_json& x, double if_null)
{
    return x.is_null() ? if_null : x.get<double>();
}

} // namespace cinch
