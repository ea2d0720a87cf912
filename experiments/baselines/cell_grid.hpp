// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "cinch/bounds.hpp"

namespace cinch {

using Cell = std::array<std::int32_t, 3>;

/// The cells that a box overlaps, first and last included.
struct CellRange {
    Cell first, last;
};

/// The cells of spatial hashing [Teschner et al. 2003]. The index of x is ⌊(x − origin)/cell⌋ as computed in double. It
/// never decreases with x, whatever is rounded, so boxes with a common point have a common cell.
struct CellGrid {
    Vec3 origin = Vec3::Zero();
    double cell = 1;
};

/// Cells of the given size, doubled until every index of the finite boxes is less than 2³¹ in magnitude; the origin is
/// the centre of these boxes. A size that is not positive counts as the least normal double, an infinite one as the
/// greatest.
CellGrid choose_grid(std::span<const Aabb> boxes, double cell) noexcept;

/// The cells of a box; nothing for one that must be taken to be everywhere and tested against all: it is not finite, or
/// no box (lower > upper), or reaches beyond the indices, or covers more than `most` cells.
std::optional<CellRange> cells(const CellGrid& grid, const Aabb& box, std::uint64_t most) noexcept;

/// Calls visit(cell) for every cell of the range.
template <class Visit> void for_each_cell(const CellRange& range, Visit&& visit)
{
    for (std::int64_t x = range.first[0]; x <= range.last[0]; ++x) // 64 bits: the last index may be the greatest of 32
        for (std::int64_t y = range.first[1]; y <= range.last[1]; ++y)
            for (std::int64_t z = range.first[2]; z <= range.last[2]; ++z)
                visit(Cell{static_cast<std::int32_t>(x), static_cast<std::int32_t>(y), static_cast<std::int32_t>(z)});
}

/// The bucket of a cell, with their constants; all arithmetic is modulo 2³². buckets > 0.
std::uint32_t hash(const Cell& cell, std::uint32_t buckets) noexcept;

/// Whether the pair of two boxes is to be reported in this cell: the one of the greater first index along each axis. It
/// is a cell of both if they have one in common, so a pair is reported exactly once.
bool reports(const Cell& cell, const CellRange& a, const CellRange& b) noexcept;

} // namespace cinch
