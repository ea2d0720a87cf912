// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "experiments/fuzz/fuzz_case.hpp"
#include "experiments/report/interrupt.hpp"

namespace cinch {
namespace {

template <class T> void erase_at(std::vector<T>& values, std::size_t i)
{
    values.erase(values.begin() + static_cast<std::ptrdiff_t>(i));
}

FuzzCase without_node(FuzzCase c, std::size_t j)
{
    if (c.is_surface()) {
        const std::size_t heir = j == 0 ? 1 : 0; // the weights still sum to 1
        for (auto& row : c.weights) {
            row[heir] += row[j];
            erase_at(row, j);
        }
        erase_at(c.maps, j);
    } else {
        erase_at(c.space.l, j);
        erase_at(c.space.h, j);
        erase_at(c.space.b[0], j);
    }
    return c;
}

FuzzCase without_vertex(FuzzCase c, std::size_t k)
{
    erase_at(c.rest, k);
    erase_at(c.weights, k);
    return c;
}

// Every number that may be replaced by a simpler one.
std::vector<double*> numbers(FuzzCase& c)
{
    std::vector<double*> all;
    for (auto* values : {&c.space.l, &c.space.h})
        for (double& x : *values)
            all.push_back(&x);
    for (auto& row : c.space.b)
        for (double& x : row)
            all.push_back(&x);
    for (Vec3& p : c.rest)
        for (int i = 0; i < 3; ++i)
            all.push_back(&p[i]);
    for (AffineMap& map : c.maps)
        for (auto& row : map.m)
            for (double& x : row)
                all.push_back(&x);
    return all;
}

bool is_valid(const FuzzCase& c)
{
    for (std::size_t j = 0; j < c.space.l.size(); ++j)
        if (!(0 <= c.space.l[j] && c.space.l[j] <= c.space.h[j] && c.space.h[j] <= 1))
            return false;
    return true;
}

} // namespace

FuzzCase shrink(FuzzCase problem, Defect defect)
{
    if (problem.is_of_times())
        return problem; // it is as small as they are drawn
    auto accept = [&](FuzzCase smaller) {
        if (interrupted() || !is_valid(smaller) || find_fault(smaller, defect).empty())
            return false;
        problem = std::move(smaller);
        return true;
    };
    for (bool progress = true; progress;) {
        progress = false;
        for (std::size_t k = problem.rest.size(); k-- > 0 && problem.rest.size() > 1;)
            progress |= accept(without_vertex(problem, k));
        for (std::size_t j = problem.nodes(); j-- > 0 && problem.nodes() > 1;)
            progress |= accept(without_node(problem, j));
        if (problem.kdop != 6) {
            FuzzCase smaller = problem;
            smaller.kdop = 6;
            progress |= accept(std::move(smaller));
        }
        const std::size_t count = numbers(problem).size();
        for (std::size_t i = 0; i < count; ++i) {
            const double x = *numbers(problem)[i];
            if (x == 0)
                continue;
            int exponent = 0;
            const double mantissa = std::frexp(x, &exponent);
            // Zero, one, an integer, a short mantissa: the first that still fails. Each is strictly simpler, so this
            // ends.
            for (const double simpler :
                 {0.0, 1.0, std::round(x), std::ldexp(std::round(std::ldexp(mantissa, 4)), exponent - 4),
                  std::ldexp(std::round(std::ldexp(mantissa, 20)), exponent - 20)}) {
                if (simpler == x)
                    break;
                FuzzCase smaller = problem;
                *numbers(smaller)[i] = simpler;
                if (accept(std::move(smaller))) {
                    progress = true;
                    break;
                }
            }
        }
    }
    return problem;
}

} // namespace cinch
