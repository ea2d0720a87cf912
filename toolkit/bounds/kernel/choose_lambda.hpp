// SPDX-License-Identifier: Apache-2.0
// Internal to the kernels: what happens once per side and axis, not per simulation node.
#pragma once

#include <cmath>

#include "toolkit/bounds/rounding.hpp"

namespace cinch {

/// D(λ) from its parts, or an upper bound of it: see dual_sum_factor(). `greatest` and `opposite` are the greatest b
/// along and against the direction.
template <class T> struct DualParts {
    T lower, upper, mass; ///< Σ l (b − λ), Σ r max(b − λ, 0), Σ r over b > λ
};
template <class T> T dual_value(T lambda, const DualParts<T>& d) { return lambda + (d.lower + d.upper); }
template <class T> T proven_dual_value(T lambda, const DualParts<T>& d, T greatest, T opposite, T factor, T underflow)
{
    const T above = greatest - lambda, below = lambda + opposite, width = above > below ? above : below;
    const T error = succ(factor * (width + d.upper) + underflow);
    return succ(lambda + succ((d.lower + d.upper) + error));
}

/// Two tangents of the convex, piecewise linear D on either side of its minimum. Each step takes in the tangent at λ
/// and moves to the crossing; every λ on the way is as valid as any.
template <class T> class TangentSearch {
public:
    /// The tangents at λ = −∞ and +∞, written at the first λ: slopes 1 − Σ h and 1 − Σ l.
    TangentSearch(T lambda, const DualParts<T>& d, T sum_l, T sum_r, T mean)
        : falling_{lambda, lambda + d.lower + sum_r * (mean - lambda), 1 - sum_l - sum_r}, rising_{lambda,
                                                                                                   lambda + d.lower,
                                                                                                   1 - sum_l}
    {
    }
    /// λ again where the crossing is no number.
    T next(T lambda, const DualParts<T>& d, T sum_l)
    {
        const Tangent here{lambda, dual_value(lambda, d), 1 - sum_l - d.mass};
        (here.slope < 0 ? falling_ : rising_) = here;
        const T drop = rising_.value - falling_.value - rising_.slope * (rising_.at - falling_.at);
        const T step = drop / (falling_.slope - rising_.slope), crossing = falling_.at + step;
        return std::isfinite(crossing) ? crossing : lambda;
    }

private:
    struct Tangent {
        T at, value, slope;
    };
    Tangent falling_, rising_;
};

/// The next frame's λ and step, λ having slope `slope` of D in this one. Steps go downhill, longer while the direction
/// stays, shorter once it turns: no value of D is kept, which another frame may have changed. `first` is the step to
/// begin with.
template <class T> void remember(T lambda, T first, T slope, T* state)
{
    const bool known = std::isfinite(state[0]) && std::isfinite(state[1]);
    T step = known ? std::abs(state[1]) * ((slope < 0) == (state[1] > 0) ? T(1.25) : T(0.4)) : std::abs(first);
    if (!(slope < 0))
        step = -step;
    if (std::isfinite(lambda + step)) {
        state[0] = lambda + step;
        state[1] = step;
    }
}

} // namespace cinch
