// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "cinch/collider.hpp"
#include "experiments/baselines/cell_grid.hpp"

namespace cinch {

/// Intersecting triangles of several bodies by spatial hashing [Teschner et al. 2003]: load() enters every triangle in
/// each cell that its box overlaps, find() goes through the cells of every triangle again. The cells are as large as
/// the mean edge, there are as many buckets as triangles. Triangles that are not finite or cover too many cells are
/// tested against all.
class SpatialHash {
public:
    struct Body {
        const TriangleMesh* mesh;
        std::span<const Vec3> positions; ///< of all vertices
    };

    /// Throws std::invalid_argument for positions that are not one per vertex, std::length_error for over 2^32 entries.
    /// All must stay alive until after find().
    void load(std::span<const Body> bodies);
    /// Appends all pairs, exact and closed, each once, in no particular order. Throws std::logic_error before the first
    /// load() and after one that threw.
    void find(std::vector<TrianglePair>& pairs) const;

    std::size_t bytes() const;

private:
    struct Item { // a triangle of any body
        std::uint32_t body, triangle;
        Aabb box;
        CellRange range;
        bool everywhere;
    };
    struct Entry {
        Cell cell;
        std::uint32_t item;
    };
    bool intersect(const Item& a, const Item& b) const;

    std::vector<Body> bodies_;
    std::vector<Item> items_;
    std::vector<std::uint32_t> everywhere_;
    std::vector<std::uint32_t> bucket_; ///< where each bucket's entries begin; one more at the end
    std::vector<Entry> entries_;
    bool loaded_ = false;
};

} // namespace cinch
