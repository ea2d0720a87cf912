// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/corners.hpp"
#include "exact/number.hpp"
#include "exact/scaled.hpp"

namespace cinch::exact {
namespace {

/// With ranges r_0 ≥ r_1 ≥ …, a vertex raises a subset A to h and leaves slack δ = S − r(A) ≥ 0. If δ = 0 all weights
/// are at a bound: one vertex. Otherwise any f ∉ A with r_f > δ may take it: one vertex each. (r_f = δ is the vertex of
/// A ∪ {f}.) A has a vertex iff its widest absentee p has r_p > δ: A holds 0 … p−1, and a set B of later ranges with
/// r(B) in (S − P_p − r_p, S − P_p], P_p = r_0 + … + r_{p−1}. No range after p is wider than that window, so adding
/// ranges one by one cannot jump over it: whenever all that are left together reach it, some subset lands in it, and no
/// branch is dead.
template <class Int> class Search {
public:
    Search(WeightSpace space, int shift, const CornerVisitor& visit)
        : data_(ranges_of<Int>(space, shift)), visit_(visit), mask_((data_.range.size() + 63) / 64 + 1, 0)
    {
        suffix_.resize(data_.range.size() + 1);
        suffix_.back() = 0;
        for (std::size_t i = data_.range.size(); i-- > 0;)
            suffix_[i] = suffix_[i + 1] + data_.range[i];
        run_.order = data_.order;
    }

    std::uint64_t run()
    {
        const std::size_t n = data_.range.size();
        Int rest = data_.slack; // S − P_p
        for (std::size_t p = 0; p < n && rest >= 0 && !stopped_; ++p) {
            widest_absentee_ = p;
            width_ = data_.range[p];
            if (suffix_[p + 1] > rest - width_) // the later ranges can reach the window
                descend(p + 1, rest);
            raise(p, true);
            rest -= data_.range[p];
        }
        if (rest == 0 && !stopped_)
            emit(-1); // every weight at h
        return visited_;
    }

private:
    void raise(std::size_t i, bool up)
    {
        mask_[i / 64] =
            up ? mask_[i / 64] | std::uint64_t{1} << (i % 64) : mask_[i / 64] & ~(std::uint64_t{1} << (i % 64));
    }

    void emit(int between)
    {
        ++visited_;
        stopped_ = !visit_(run_, {mask_, between});
    }

    // δ: what is left of the slack by the subset so far; ranges from `next` on are undecided.
    void descend(std::size_t next, const Int& delta)
    {
        if (delta < width_)
            emit_subset(delta);
        const std::size_t n = data_.range.size();
        auto first = next; // too wide ones cannot be raised
        if (first < n && data_.range[first] > delta)
            first = static_cast<std::size_t>(
                std::partition_point(data_.range.begin() + static_cast<std::ptrdiff_t>(next), data_.range.end(),
                                     [&](const Int& r) { return r > delta; }) -
                data_.range.begin());
        for (std::size_t i = first; i < n && !stopped_; ++i) {
            if (delta - suffix_[i] >= width_)
                return; // all that are left together no longer reach the window
            raise(i, true);
            descend(i + 1, Int(delta - data_.range[i]));
            raise(i, false);
        }
    }

    void emit_subset(const Int& delta)
    {
        if (delta == 0)
            return emit(-1);
        for (std::size_t word = widest_absentee_ / 64; word < mask_.size(); ++word) {
            for (std::uint64_t absent = ~mask_[word]; absent != 0; absent &= absent - 1) {
                const std::size_t f = 64 * word + static_cast<std::size_t>(std::countr_zero(absent));
                if (f >= data_.range.size() || data_.range[f] <= delta)
                    return; // and so are all later ones
                emit(static_cast<int>(f));
                if (stopped_)
                    return;
            }
        }
    }

    Ranges<Int> data_;
    const CornerVisitor& visit_;
    std::vector<std::uint64_t> mask_;
    std::vector<Int> suffix_;
    CornerRun run_;
    std::size_t widest_absentee_ = 0;
    Int width_ = 0;
    std::uint64_t visited_ = 0;
    bool stopped_ = false;
};

} // namespace

bool is_feasible(WeightSpace space)
{
    Exact low(0), high(0);
    for (std::size_t j = 0; j < space.l.size(); ++j) {
        if (space.l[j] > space.h[j])
            return false;
        low = low + Exact(space.l[j]);
        high = high + Exact(space.h[j]);
    }
    return low <= Exact(1) && Exact(1) <= high;
}

std::uint64_t visit_corners(WeightSpace space, const CornerVisitor& visit)
{
    if (!is_feasible(space))
        return 0;
    return with_integers(space,
                         [&](auto kind, int shift) { return Search<decltype(kind)>(space, shift, visit).run(); });
}

std::vector<std::string> weights_of(WeightSpace space, const CornerRun& run, const Corner& corner)
{
    std::vector<Exact> w(space.l.begin(), space.l.end());
    Exact sum(0);
    for (std::size_t i = 0; i < run.order.size(); ++i)
        if (corner.at_upper[i / 64] >> (i % 64) & 1)
            w[run.order[i]] = Exact(space.h[run.order[i]]);
    for (const Exact& x : w)
        sum = sum + x;
    if (corner.between >= 0) {
        Exact& free = w[run.order[static_cast<std::size_t>(corner.between)]];
        free = free + (Exact(1) - sum);
    }
    std::vector<std::string> out;
    for (const Exact& x : w)
        out.push_back(as_fraction(x));
    return out;
}

} // namespace cinch::exact
