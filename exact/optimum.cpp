// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/optimum.hpp"

#include <numeric>

#include "exact/check_failed.hpp"
#include "exact/scaled.hpp"

namespace cinch::exact {
namespace {

/// The problem in integers: weights in units of 2^-weight_bits, extrema in units of 2^extremum_exponent.
struct Scaled {
    int weight_bits = 0;
    long extremum_exponent = 0;
    std::vector<mpz_class> l, h, b;
    mpz_class one;
};

Scaled in_integers(WeightSpace space, const std::vector<Exact>& b)
{
    Scaled out;
    out.weight_bits = common_shift(space);
    out.one = scaled<mpz_class>(1.0, out.weight_bits);
    for (auto* values : {&out.l, &out.h, &out.b})
        values->reserve(b.size());
    for (std::size_t j = 0; j < b.size(); ++j) {
        out.l.push_back(scaled<mpz_class>(space.l[j], out.weight_bits));
        out.h.push_back(scaled<mpz_class>(space.h[j], out.weight_bits));
        out.extremum_exponent = j == 0 ? b[j].exp() : std::min<long>(out.extremum_exponent, b[j].exp());
    }
    for (const Exact& x : b) {
        out.b.emplace_back(x.man());
        mpz_mul_2exp(out.b.back().get_mpz_t(), out.b.back().get_mpz_t(),
                     static_cast<mp_bitcnt_t>(x.exp() - out.extremum_exponent));
    }
    return out;
}

/// z·2^exponent.
Exact from_integer(const mpz_class& z, long exponent)
{
    Exact out(z.get_mpz_t());
    for (; exponent != 0;) { // powers of two that a double holds
        const int step = static_cast<int>(std::clamp(exponent, -1000L, 1000L));
        out = out * Exact(std::ldexp(1.0, step));
        exponent -= step;
    }
    return out;
}

void require(bool condition, const char* what)
{
    if (!condition)
        throw CheckFailed(std::string("optimum over the weight space: certificate refused: ") + what);
}

// w ∈ W', Σ w b = value, D(λ) = value.
void check(const Scaled& p, const std::vector<mpz_class>& w, const mpz_class& value, const mpz_class& lambda)
{
    mpz_class sum = 0, primal = 0, dual = lambda * p.one, above;
    for (std::size_t j = 0; j < p.b.size(); ++j) {
        require(p.l[j] <= w[j] && w[j] <= p.h[j], "a weight leaves its interval");
        sum += w[j];
        mpz_addmul(primal.get_mpz_t(), w[j].get_mpz_t(), p.b[j].get_mpz_t());
        above = p.b[j] - lambda;
        mpz_addmul(dual.get_mpz_t(), (above > 0 ? p.h[j] : p.l[j]).get_mpz_t(), above.get_mpz_t());
    }
    require(sum == p.one, "the weights do not sum to 1");
    require(primal == value, "the corner does not attain the value");
    require(dual == value, "primal and dual differ");
}

} // namespace

std::optional<Optimum> optimum(WeightSpace space, const std::vector<Exact>& b)
{
    if (b.empty())
        return std::nullopt;
    const Scaled p = in_integers(space, b);
    mpz_class slack = p.one;
    for (std::size_t j = 0; j < b.size(); ++j) {
        slack -= p.l[j];
        if (p.l[j] > p.h[j])
            return std::nullopt;
    }
    if (slack < 0)
        return std::nullopt;

    // Rounded values decide most comparisons; rounding is monotone, so only equal ones need the integers.
    std::vector<double> rounded;
    for (const mpz_class& x : p.b)
        rounded.push_back(x.get_d());
    std::vector<std::size_t> order(b.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
        return rounded[i] != rounded[j] ? rounded[j] < rounded[i] : p.b[j] < p.b[i];
    });

    Optimum out;
    out.corner = p.l;
    out.corner_bits = p.weight_bits;
    std::size_t last = order.back(); // the price of weight: what one more unit of it would earn
    for (std::size_t j : order) {
        mpz_class step = p.h[j] - p.l[j];
        if (slack < step)
            step = slack;
        out.corner[j] += step;
        slack -= step;
        if (slack == 0) {
            last = j;
            break;
        }
    }
    if (slack != 0)
        return std::nullopt; // Σ h < 1
    mpz_class value = 0;
    for (std::size_t j = 0; j < b.size(); ++j)
        mpz_addmul(value.get_mpz_t(), out.corner[j].get_mpz_t(), p.b[j].get_mpz_t());
    check(p, out.corner, value, p.b[last]);
    out.value = from_integer(value, p.extremum_exponent - p.weight_bits);
    out.lambda = b[last];
    return out;
}

} // namespace cinch::exact
