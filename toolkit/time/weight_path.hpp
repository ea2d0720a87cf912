// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "toolkit/time/curve_piece.hpp"

namespace cinch {

/// The weights of all morph targets on a closed interval of time within which no curve of them has a key.
class WeightPath {
public:
    /// `still`: of all targets, where no curve moves them; the piece of each curve is that of the interval's middle.
    /// `end_s`: as of a BonePath.
    WeightPath(const std::vector<double>& still, const std::vector<WeightCurve>& curves, double middle_s,
               std::optional<double> end_s = {});

    /// The k-th derivative, of every target.
    std::vector<double> at(std::size_t k, double t_s) const;

    /// Of one target: suprema on [a, b] of the absolute values of derivatives 0 to 3, and what derivatives 0 to 2 of
    /// at() are rounded against.
    struct Limits {
        std::array<double, 4> sup{};
        std::array<double, 3> magnitude{};
    };
    std::vector<Limits> over(double a_s, double b_s) const;

private:
    std::vector<Since<Polynomial<1>>> path_;
};

} // namespace cinch
