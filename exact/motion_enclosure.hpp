// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "cinch/deform.hpp"

namespace cinch::exact {

/// A real interval with ends that are doubles.
struct Enclosure {
    double low = 0, high = 0;
};
/// Of an affine map, entry by entry.
struct MapEnclosure {
    Enclosure m[3][4];
};

/// A motion as its definition has it, in real arithmetic: T_j(t) and T_j′(t), enclosed by intervals with directed
/// rounding. Shares no formula with the toolkit.
class MotionEnclosure {
public:
    virtual ~MotionEnclosure() = default;

    /// For every t in [a, b], in which no key lies strictly inside; at a key where a curve jumps, the piece of the
    /// interval `piece_a` to `piece_b`, which holds [a, b] and no other key, decides. Unbounded where nothing is known.
    virtual void at(double a_s, double b_s, double piece_a_s, double piece_b_s, std::vector<MapEnclosure>& maps,
                    std::vector<MapEnclosure>& slopes) const = 0;
    /// The same of the weights of morph targets, as many as there are.
    virtual void weights_at(double a_s, double b_s, double piece_a_s, double piece_b_s, std::vector<Enclosure>& weights,
                            std::vector<Enclosure>& slopes) const = 0;
    /// Whether weights may be anything in those enclosures, at each t whatever they were before; slopes are 0 then.
    virtual bool has_any_weights() const { return false; }
    /// Times of keys, ascending, each once.
    virtual const std::vector<double>& keys() const = 0;
};

/// The frames of a clip, interpolated entry by entry: T_i + (t − t_i)/(t_i+1 − t_i) (T_i+1 − T_i).
class LinearEnclosure final : public MotionEnclosure {
public:
    /// The clip must stay alive.
    explicit LinearEnclosure(const Clip& clip);

    void at(double a_s, double b_s, double piece_a_s, double piece_b_s, std::vector<MapEnclosure>& maps,
            std::vector<MapEnclosure>& slopes) const override;
    void weights_at(double, double, double, double, std::vector<Enclosure>& weights,
                    std::vector<Enclosure>& slopes) const override
    {
        weights.clear();
        slopes.clear();
    }
    const std::vector<double>& keys() const override { return keys_; }

private:
    const Clip& clip_;
    std::vector<double> time_s_, keys_;
    mutable std::size_t kept_ = ~std::size_t{0}; // of the two frames below the first
    mutable Clip::Frame first_, last_;
};

} // namespace cinch::exact
