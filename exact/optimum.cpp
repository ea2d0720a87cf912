// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/optimum.hpp"

#include <numeric>
#include <stdexcept>

#include "exact/formulas.hpp"

namespace cinch::exact {
namespace {

void require(bool condition, const char* what)
{
    if (!condition)
        throw std::logic_error(std::string("optimum over the weight space: certificate refused: ") + what);
}

void check(WeightSpace space, const std::vector<Exact>& b, const Optimum& found)
{
    Exact sum(0), value(0);
    for (std::size_t j = 0; j < b.size(); ++j) {
        require(Exact(space.l[j]) <= found.corner[j] && found.corner[j] <= Exact(space.h[j]), "a weight leaves its interval");
        sum = sum + found.corner[j];
        value = value + found.corner[j] * b[j];
    }
    require(sum == Exact(1), "the weights do not sum to 1");
    require(value == found.value, "the corner does not attain the value");
    require(dual_value(space, b, found.lambda) == found.value, "primal and dual differ");
}

} // namespace

std::optional<Optimum> optimum(WeightSpace space, const std::vector<Exact>& b)
{
    Exact slack(1);
    for (std::size_t j = 0; j < b.size(); ++j) {
        slack = slack - Exact(space.l[j]);
        if (space.l[j] > space.h[j])
            return std::nullopt;
    }
    if (b.empty() || slack < Exact(0))
        return std::nullopt;

    std::vector<std::size_t> order(b.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return b[j] < b[i]; });

    Optimum out{Exact(0), b[order.back()], {}};
    out.corner.assign(space.l.begin(), space.l.end());
    bool filled = false;
    for (std::size_t j : order) {
        const Exact range = Exact(space.h[j]) - Exact(space.l[j]);
        if (range < slack) {
            out.corner[j] = Exact(space.h[j]);
            slack = slack - range;
            continue;
        }
        out.corner[j] = out.corner[j] + slack;
        out.lambda = b[j]; // the price of weight: what one more unit of it would earn
        filled = true;
        break;
    }
    if (!filled && slack != Exact(0))
        return std::nullopt; // Σ h < 1
    for (std::size_t j = 0; j < b.size(); ++j)
        out.value = out.value + out.corner[j] * b[j];
    check(space, b, out);
    return out;
}

} // namespace cinch::exact
