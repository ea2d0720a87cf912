// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "toolkit/time/norm.hpp"

namespace cinch {

/// Coefficients of a polynomial of degree 7 at most, the square of a cubic one and less, in place.
template <std::size_t N> class Coefficients {
public:
    explicit Coefficients(std::size_t size) : size_(size) {}
    Coefficients(const std::array<double, N>& constant) : all_{constant}, size_(1) {}

    std::size_t size() const { return size_; }
    void resize(std::size_t size) { size_ = size; } ///< what is new is 0
    std::array<double, N>& operator[](std::size_t i) { return all_[i]; }
    const std::array<double, N>& operator[](std::size_t i) const { return all_[i]; }
    const std::array<double, N>* begin() const { return all_.data(); }
    const std::array<double, N>* end() const { return all_.data() + size_; }

private:
    std::array<std::array<double, N>, 8> all_{};
    std::size_t size_;
};

/// A path p(u) = Σ_i c_i u^i in N dimensions.
template <std::size_t N> struct Polynomial {
    Coefficients<N> c{1}; ///< never empty

    std::size_t degree() const { return c.size() - 1; }

    /// The k-th derivative at u.
    std::array<double, N> derivative(std::size_t k, double u) const
    {
        std::array<double, N> out{};
        for (std::size_t i = c.size(); i-- > k;)
            for (std::size_t n = 0; n < N; ++n)
                out[n] = out[n] * u + falling(i, k) * c[i][n];
        return out;
    }

    /// Σ_i ‖c_i‖ i!/(i − k)! u^(i−k), u ≥ 0: what a k-th derivative at any place up to u is rounded against.
    double magnitude(std::size_t k, double u) const
    {
        double out = 0;
        for (std::size_t i = c.size(); i-- > k;) {
            out = out * u + falling(i, k) * norm_of(c[i]);
        }
        return out;
    }

    /// p(a + (b − a) w) as a path of w in [0, 1].
    Polynomial over(double a, double b) const
    {
        Polynomial out{Coefficients<N>(c.size())};
        double scale = 1;
        for (std::size_t k = 0; k < c.size(); ++k) {
            const auto d = derivative(k, a);
            for (std::size_t n = 0; n < N; ++n)
                out.c[k][n] = d[n] * scale;
            scale *= (b - a) / static_cast<double>(k + 1);
        }
        return out;
    }

    /// d/dw.
    Polynomial slope() const
    {
        Polynomial out{Coefficients<N>(std::max<std::size_t>(degree(), 1))};
        for (std::size_t i = 1; i < c.size(); ++i)
            for (std::size_t n = 0; n < N; ++n)
                out.c[i - 1][n] = static_cast<double>(i) * c[i][n];
        return out;
    }

    /// Bernstein's coefficients on [0, 1], whose convex hull the path stays in: β_i = Σ_j≤i C(i, j)/C(n, j) c_j.
    Coefficients<N> control() const
    {
        Coefficients<N> out(c.size());
        for (std::size_t i = 0; i < c.size(); ++i) {
            double share = 1; // C(i, j)/C(n, j)
            for (std::size_t j = 0; j <= i; ++j) {
                for (std::size_t n = 0; n < N; ++n)
                    out[i][n] += share * c[j][n];
                if (j < i)
                    share *= static_cast<double>(i - j) / static_cast<double>(degree() - j);
            }
        }
        return out;
    }

    /// At least the greatest ‖p‖ on [0, 1], but for rounding.
    double greatest_norm() const
    {
        double most = 0;
        for (const auto& point : control())
            most = std::max(most, norm_of(point));
        return most;
    }

private:
    // i!/(i − k)!
    static double falling(std::size_t i, std::size_t k)
    {
        double out = 1;
        for (std::size_t n = 0; n < k; ++n)
            out *= static_cast<double>(i - n);
        return out;
    }
};

/// Σ_n x_n y_n and the like: the product of two paths by a bilinear `of`, coefficient by coefficient.
template <std::size_t M, std::size_t N, class F>
Polynomial<M> product(const Polynomial<N>& x, const Polynomial<N>& y, F&& of)
{
    Polynomial<M> out{Coefficients<M>(x.degree() + y.degree() + 1)};
    for (std::size_t i = 0; i < x.c.size(); ++i)
        for (std::size_t j = 0; j < y.c.size(); ++j) {
            const std::array<double, M> term = of(x.c[i], y.c[j]);
            for (std::size_t m = 0; m < M; ++m)
                out.c[i + j][m] += term[m];
        }
    return out;
}

} // namespace cinch
