// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/baselines/cell_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cinch {
namespace {

constexpr double greatest_index = 0x1p31 - 1;

/// False for NaN.
bool is_box(const Aabb& box) noexcept
{
    return box.lower.allFinite() && box.upper.allFinite() && (box.lower.array() <= box.upper.array()).all();
}

} // namespace

CellGrid choose_grid(std::span<const Aabb> boxes, double cell) noexcept
{
    using limits = std::numeric_limits<double>;
    CellGrid grid;
    grid.cell = cell > 0 ? std::clamp(cell, limits::min(), limits::max()) : limits::min();
    Vec3 lower = Vec3::Constant(limits::infinity()), upper = -lower;
    for (const Aabb& box : boxes)
        if (is_box(box)) {
            lower = lower.cwiseMin(box.lower);
            upper = upper.cwiseMax(box.upper);
        }
    if (!(lower[0] <= upper[0]))
        return grid;                     // no finite box
    grid.origin = lower / 2 + upper / 2; // halved first: no difference from it overflows
    const double reach = std::max((upper - grid.origin).maxCoeff(), (grid.origin - lower).maxCoeff());
    while (!(reach / grid.cell <= greatest_index)) // ends: reach/2^31 is a double
        grid.cell *= 2;
    return grid;
}

std::optional<CellRange> cells(const CellGrid& grid, const Aabb& box, std::uint64_t most) noexcept
{
    if (!is_box(box))
        return {};
    CellRange range;
    double count = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto i = static_cast<Eigen::Index>(axis);
        const double first = std::floor((box.lower[i] - grid.origin[i]) / grid.cell),
                     last = std::floor((box.upper[i] - grid.origin[i]) / grid.cell);
        if (!(first >= -greatest_index && last <= greatest_index))
            return {};
        range.first[axis] = static_cast<std::int32_t>(first);
        range.last[axis] = static_cast<std::int32_t>(last);
        count *= last - first + 1; // < 2^33 each
    }
    if (count > static_cast<double>(most))
        return {};
    return range;
}

std::uint32_t hash(const Cell& cell, std::uint32_t buckets) noexcept
{
    const auto x = static_cast<std::uint32_t>(cell[0]), y = static_cast<std::uint32_t>(cell[1]),
               z = static_cast<std::uint32_t>(cell[2]);
    return (x * 73856093u ^ y * 19349663u ^ z * 83492791u) % buckets;
}

bool reports(const Cell& cell, const CellRange& a, const CellRange& b) noexcept
{
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (cell[axis] != std::max(a.first[axis], b.first[axis]))
            return false;
    return true;
}

} // namespace cinch
