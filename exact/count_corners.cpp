// SPDX-License-Identifier: GPL-3.0-or-later
// V = Σ_{A: r(A) < S} (N − 2|A|) + Σ_{A: r(A) = S} (1 − |A|) over the subsets A of the N weights with range r_j = h_j −
// l_j > 0, S = 1 − Σ l. Proof: vertices are pairs (A, f ∉ A) with r(A) < S < r(A) + r_f, and the A with r(A) = S. Of
// the pairs with r(A) < S, those with r(A ∪ f) < S are counted by |B| over B = A ∪ f with r(B) < S, those with r(A ∪ f)
// = S likewise.
#include <limits>

#include "exact/corners.hpp"
#include "exact/scaled.hpp"

namespace cinch::exact {
namespace {

template <class Int> constexpr std::size_t most_for_middle = std::is_same_v<Int, mpz_class> ? 40 : 44; // memory
constexpr std::size_t most_grid_work = 5'000'000;

/// All subsets of one sum: how many, and how many elements they have together. At most 2^44 · 44 either way.
template <class Int> struct SubsetSum {
    Int sum;
    std::int64_t subsets, elements;
};

// The distinct sums of all subsets, ascending: each range merges the list with itself shifted.
template <class Int> std::vector<SubsetSum<Int>> subset_sums(std::span<const Int> ranges)
{
    std::vector<SubsetSum<Int>> sums{{Int(0), 1, 0}}, merged;
    for (const Int& r : ranges) {
        merged.clear();
        merged.reserve(2 * sums.size());
        auto add = [&](const Int& sum, std::int64_t subsets, std::int64_t elements) {
            if (!merged.empty() && merged.back().sum == sum) {
                merged.back().subsets += subsets;
                merged.back().elements += elements;
            } else {
                merged.push_back({sum, subsets, elements});
            }
        };
        std::size_t next = 0; // to be shifted
        auto add_shifted = [&] {
            add(Int(sums[next].sum + r), sums[next].subsets, sums[next].elements + sums[next].subsets);
            ++next;
        };
        for (const auto& s : sums) {
            while (sums[next].sum + r < s.sum)
                add_shifted();
            add(s.sum, s.subsets, s.elements);
        }
        while (next < sums.size())
            add_shifted();
        sums.swap(merged);
    }
    return sums;
}

template <class Int> std::string count_in_the_middle(const Ranges<Int>& data)
{
    const auto n = static_cast<std::int64_t>(data.range.size());
    std::vector<Int> half[2];
    for (std::size_t i = 0; i < data.range.size(); ++i)
        half[i % 2].push_back(data.range[i]);
    const auto left = subset_sums<Int>(half[0]), right = subset_sums<Int>(half[1]);
    std::int64_t total = 0, subsets = 0,
                 elements = 0; // of right[0 … below), those with left + right < S; grows as left falls
    std::size_t below = 0;
    for (auto a = left.rbegin(); a != left.rend(); ++a) {
        while (below < right.size() && a->sum + right[below].sum < data.slack) {
            subsets += right[below].subsets;
            elements += right[below].elements;
            ++below;
        }
        total += n * a->subsets * subsets - 2 * (a->elements * subsets + a->subsets * elements);
        if (below < right.size() && a->sum + right[below].sum == data.slack) {
            const auto& b = right[below];
            total += a->subsets * b.subsets - a->elements * b.subsets - a->subsets * b.elements;
        }
    }
    return std::to_string(total);
}

// Where ranges and slack are multiples of a coarse unit: how many subsets, and how many elements in them, for every
// sum.
std::string count_on_grid(const std::vector<std::size_t>& range, std::size_t slack)
{
    std::vector<mpz_class> subsets(slack + 1), elements(slack + 1);
    subsets[0] = 1;
    for (std::size_t r : range)
        for (std::size_t s = slack; s >= r && s <= slack; --s) {
            elements[s] += elements[s - r] + subsets[s - r];
            subsets[s] += subsets[s - r];
        }
    mpz_class total = subsets[slack] - elements[slack];
    for (std::size_t s = 0; s < slack; ++s)
        total += static_cast<unsigned long>(range.size()) * subsets[s] - 2 * elements[s];
    return total.get_str();
}

} // namespace

CornerCount count_corners(WeightSpace space)
{
    if (!is_feasible(space))
        return {"0", {}};
    std::size_t free = 0;
    for (std::size_t j = 0; j < space.l.size(); ++j)
        free += space.l[j] < space.h[j];
    const auto in_the_middle = with_integers(space, [&](auto kind, int shift) -> std::optional<std::string> {
        using Int = decltype(kind);
        if (free > most_for_middle<Int>)
            return std::nullopt;
        return count_in_the_middle(ranges_of<Int>(space, shift));
    });
    if (in_the_middle)
        return {in_the_middle, {}};

    const Ranges<mpz_class> data = ranges_of<mpz_class>(space, common_shift(space));
    mpz_class unit = data.slack;
    for (const mpz_class& r : data.range)
        unit = gcd(unit, r);
    const mpz_class cells = data.slack / unit;
    if (cells * static_cast<unsigned long>(free) <= most_grid_work) {
        std::vector<std::size_t> range;
        for (const mpz_class& r : data.range) {
            const mpz_class steps = r / unit;
            range.push_back(steps <= cells ? steps.get_ui() : cells.get_ui() + 1); // wider than the slack: never raised
        }
        return {count_on_grid(range, cells.get_ui()), {}};
    }
    return {std::nullopt, "not counted: " + std::to_string(free) +
                              " weights are free, too many to count in halves, and their ranges share no coarse unit"};
}

} // namespace cinch::exact
