// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "cinch/io.hpp"

namespace cinch::exact {

/// A real interval with ends that are doubles.
struct Enclosure {
    double low = 0, high = 0;
};
/// Of an affine map, entry by entry.
struct MapEnclosure {
    Enclosure m[3][4];
};

/// A character's clip as the glTF 2.0 specification defines it from the stored numbers, in real arithmetic: T_j(t) and
/// T_j′(t), enclosed by intervals with directed rounding; the angles between keys are MPFI's. Shares no formula with
/// the toolkit: spherical interpolation is that of the specification, sin((1 − s)φ) q₀ + sin(sφ) q₁ over sin φ of unit
/// quaternions, and what is said of an interval of time comes from interval arithmetic alone.
class ClipEnclosure {
public:
    ClipEnclosure(const Character& character, const Character::Animation& animation);
    ~ClipEnclosure();

    /// For every t in [a, b], in which no key lies strictly inside; at a key where a curve jumps, the piece of the
    /// interval `piece_a` to `piece_b`, which holds [a, b] and no other key, decides. Unbounded where a quaternion may
    /// be 0.
    void at(double a_s, double b_s, double piece_a_s, double piece_b_s, std::vector<MapEnclosure>& maps,
            std::vector<MapEnclosure>& slopes) const;

    /// The same of the weights of morph targets, as many as the character has.
    void weights_at(double a_s, double b_s, double piece_a_s, double piece_b_s, std::vector<Enclosure>& weights,
                    std::vector<Enclosure>& slopes) const;

    /// Times of keys that move joints or weights, ascending, each once.
    const std::vector<double>& keys() const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

} // namespace cinch::exact
