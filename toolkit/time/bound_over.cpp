// SPDX-License-Identifier: Apache-2.0
#include "toolkit/time/bound_over.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>

namespace cinch {
namespace {

constexpr int most_halvings = 20;
// And of all pieces together: enough for any motion that halving helps, little where it does not, as where a curve's
// tangents are so long that rounding hides it.
constexpr std::size_t spare_intervals = 1000, intervals_per_piece = 8;
// The share of the tolerance within which a bound needs no bend.
constexpr double share_of_norms = 0.25;
// Most intervals between keys that are first tried as one.
constexpr std::size_t longest_span = 4;

using Instant = std::shared_ptr<const InstantBounds>;

// An interval without a key inside, or several in a row.
struct Piece {
    std::vector<double> cuts; // its ends, and the keys between
    int halvings = 0;
    std::vector<std::shared_ptr<const MotionInterval>> inside; // between cuts; empty until it is bounded
    std::shared_ptr<const std::vector<std::uint32_t>> bvs;
    std::vector<bool> open;      // which of them the piece is there for; the others are below these
    std::vector<double> bound;   // their supports
    Instant first, last, middle; // of the same list

    bool has_keys() const { return cuts.size() > 2; }
    double first_s() const { return cuts.front(); }
    double last_s() const { return cuts.back(); }
    // A key where there is one.
    double middle_s() const
    {
        return has_keys() ? cuts[(cuts.size() - 1) / 2] : first_s() + (last_s() - first_s()) / 2;
    }
};

bool is_of(const Instant& instant, const std::vector<AffineMap>& maps, const std::vector<double>& weights)
{
    return instant && instant->weights == weights && instant->maps.size() == maps.size() &&
           std::memcmp(instant->maps.data(), maps.data(), maps.size() * sizeof(AffineMap)) == 0;
}

void take(std::span<double> to, std::span<const double> from)
{
    for (std::size_t i = 0; i < to.size(); ++i)
        to[i] = std::max(to[i], from[i]);
}

class OverTime {
public:
    OverTime(IntervalRefitter& refit, const TimedMotion& motion, double tolerance, std::span<double> supports)
        : refit_(refit), motion_(motion), tolerance_(tolerance), k_(refit.kdop()), supports_(supports),
          instant_(supports.size(), -std::numeric_limits<double>::infinity())
    {
        std::fill(supports.begin(), supports.end(), -std::numeric_limits<double>::infinity());
    }

    // Bounds a piece; what of it exceeds the times looked at so far, its own ends among them.
    Piece bound(Piece piece)
    {
        const BvList bvs = *piece.bvs;
        for (std::size_t i = 1; piece.inside.size() + 1 < piece.cuts.size(); ++i)
            piece.inside.push_back(over(piece.cuts[i - 1], piece.cuts[i]));
        const MotionInterval &begin = *piece.inside.front(), &end = *piece.inside.back();
        // The last piece's end, where it is this one's beginning and of the same BVs.
        const bool follows = last_bvs_ == piece.bvs && is_of(last_, begin.first, begin.morph.first);
        if (!is_of(piece.first, begin.first, begin.morph.first))
            piece.first = follows ? last_ : at(bvs, begin.first, begin.morph.first);
        if (!is_of(piece.last, end.last, end.morph.last))
            piece.last = is_of(piece.first, end.last, end.morph.last) ? piece.first : at(bvs, end.last, end.morph.last);
        last_ = piece.last;
        last_bvs_ = piece.bvs;
        piece.bound.resize(bvs.size() * k_);
        if (piece.has_keys())
            refit_(bvs, motion_span(piece.inside, refit_.bvh(), static_cast<int>(k_)), *piece.first, *piece.last,
                   piece.bound);
        else
            refit_(bvs, begin, *piece.first, *piece.last, share_of_norms * tolerance_, piece.bound);
        if (piece.first_s() < piece.last_s())
            bounded_ += static_cast<double>(bvs.size());
        for (std::size_t n = 0; n < bvs.size(); ++n)
            for (const Instant& end : {piece.first, piece.last})
                see(bvs[n], std::span(end->supports).subspan(n * k_, k_));
        return left_of(piece);
    }

    // What of it exceeds all times looked at; takes the rest.
    Piece left_of(const Piece& piece)
    {
        std::vector<bool> far(piece.bvs->size());
        for (std::size_t n = 0; n < far.size(); ++n)
            if (piece.open[n] && !accept(piece, n))
                far[n] = true;
        return part(piece, far);
    }

    // Looks at the time in the middle.
    void look(Piece& piece)
    {
        if (piece.has_keys()) {
            piece.middle = at(*piece.bvs, piece.inside[(piece.cuts.size() - 1) / 2]->first, {});
        } else {
            const auto motion = over(piece.first_s(), piece.middle_s());
            piece.middle = at(*piece.bvs, motion->last, motion->morph.last);
        }
        for (std::size_t n = 0; n < piece.bvs->size(); ++n)
            see((*piece.bvs)[n], std::span(piece.middle->supports).subspan(n * k_, k_));
    }

    void take_all(const Piece& piece)
    {
        for (std::size_t n = 0; n < piece.bvs->size(); ++n)
            if (piece.open[n])
                take(std::span(supports_).subspan((*piece.bvs)[n] * k_, k_),
                     std::span(piece.bound).subspan(n * k_, k_));
    }

    double intervals() const { return bounded_ / static_cast<double>(std::max<std::size_t>(refit_.all().size(), 1)); }

private:
    void see(std::uint32_t bv, std::span<const double> supports)
    {
        take(std::span(instant_).subspan(bv * k_, k_), supports);
    }

    std::shared_ptr<const MotionInterval> over(double first_s, double last_s) const
    {
        return std::make_shared<const MotionInterval>(motion_.over(first_s, last_s));
    }

    Instant at(BvList bvs, const std::vector<AffineMap>& maps, const std::vector<double>& weights)
    {
        return std::make_shared<const InstantBounds>(refit_.at(bvs, maps, weights));
    }

    // Takes the n-th BV's bound if with all that was taken it is near enough to those at instants.
    bool accept(const Piece& piece, std::size_t n)
    {
        const auto instants = std::span(instant_).subspan((*piece.bvs)[n] * k_, k_);
        const auto mine = std::span(piece.bound).subspan(n * k_, k_);
        const auto taken = supports_.subspan((*piece.bvs)[n] * k_, k_);
        std::vector<double>& both = scratch_;
        both.assign(mine.begin(), mine.end());
        // All that was taken counts, unless that is far by itself, of pieces that could not be halved any more.
        if (is_near(taken, instants, tolerance_))
            take(both, taken);
        else
            for (std::size_t d = 0; d < k_; ++d)
                if (mine[d] <= taken[d])
                    both[d] = -std::numeric_limits<double>::infinity();
        if (!is_near(both, instants, tolerance_))
            return false;
        take(taken, mine);
        return true;
    }

    // The same piece for these of its BVs, and all below them.
    Piece part(const Piece& piece, const std::vector<bool>& open)
    {
        Piece out{piece.cuts, piece.halvings, piece.inside, {}, {}, {}, {}, {}, {}};
        const std::vector<Bv>& tree = refit_.bvh().bvs;
        marked_.resize(tree.size());
        std::vector<std::uint32_t> bvs, place;
        for (std::size_t n = 0; n < open.size(); ++n) {
            const std::uint32_t bv = (*piece.bvs)[n];
            if (!open[n] && !marked_[bv])
                continue;
            marked_[bv] = false; // for the next
            if (!tree[bv].is_leaf())
                marked_[tree[bv].first_child] = marked_[tree[bv].first_child + 1] = true;
            bvs.push_back(bv);
            out.open.push_back(open[n]);
            place.push_back(static_cast<std::uint32_t>(n));
        }
        if (bvs.empty())
            return out;
        auto those = [&](const std::vector<double>& from) {
            std::vector<double> to;
            to.reserve(place.size() * k_);
            for (const std::uint32_t n : place)
                to.insert(to.end(), from.begin() + static_cast<std::ptrdiff_t>(n * k_),
                          from.begin() + static_cast<std::ptrdiff_t>((n + 1) * k_));
            return to;
        };
        auto instant = [&](const Instant& from) -> Instant {
            if (!from)
                return nullptr;
            return std::make_shared<const InstantBounds>(
                InstantBounds{from->maps, from->weights, those(from->supports)});
        };
        out.bound = those(piece.bound);
        out.first = instant(piece.first);
        out.last = instant(piece.last);
        out.middle = instant(piece.middle);
        out.bvs = std::make_shared<const std::vector<std::uint32_t>>(std::move(bvs));
        return out;
    }

    IntervalRefitter& refit_;
    const TimedMotion& motion_;
    double tolerance_;
    std::size_t k_;
    std::span<double> supports_;
    std::vector<double> instant_, scratch_; // the greatest bounds at times looked at
    std::vector<bool> marked_;
    Instant last_;
    std::shared_ptr<const std::vector<std::uint32_t>> last_bvs_;
    double bounded_ = 0; // BVs, in an interval each
};

} // namespace

double bound_over(IntervalRefitter& refit, const TimedMotion& motion, double a_s, double b_s, double tolerance,
                  std::span<double> supports)
{
    const BvList all = refit.all();
    if (supports.size() != all.size() * refit.kdop())
        throw std::invalid_argument("supports has " + std::to_string(supports.size()) + " entries; the BVs need " +
                                    std::to_string(all.size() * refit.kdop()));
    OverTime over(refit, motion, tolerance, supports);
    // Pieces of keys; bounds of what is loose are kept until all their ends are known, as it depends on them.
    std::vector<double> cuts{a_s};
    for (const double key : motion.keys)
        if (key > a_s && key < b_s)
            cuts.push_back(key);
    cuts.push_back(b_s);
    cuts.push_back(b_s); // where a curve may jump to what no interval before it has
    const auto bvs = std::make_shared<const std::vector<std::uint32_t>>(all.begin(), all.end());
    std::vector<Piece> open;
    for (std::size_t i = 1; i < cuts.size();) {
        const bool alone = motion.weights || i + 1 == cuts.size();
        const std::size_t end = alone ? i + 1 : std::min(i + longest_span, cuts.size() - 1);
        open.push_back(
            {{cuts.begin() + static_cast<std::ptrdiff_t>(i - 1), cuts.begin() + static_cast<std::ptrdiff_t>(end)},
             0,
             {},
             bvs,
             std::vector<bool>(all.size(), true),
             {},
             {},
             {},
             {}});
        i = end;
    }
    const std::size_t most_intervals = spare_intervals + intervals_per_piece * cuts.size();
    std::size_t intervals = 0;
    while (!open.empty()) {
        std::vector<Piece> doubtful; // until all instants are known
        for (Piece& piece : open) {
            ++intervals;
            if (Piece far = over.bound(std::move(piece)); far.bvs)
                doubtful.push_back(std::move(far));
        }
        open.clear();
        // A bound that exceeds the ends may be as near as wanted to what is between them.
        std::vector<Piece> seen;
        for (const Piece& piece : doubtful) {
            Piece far = over.left_of(piece);
            if (!far.bvs)
                continue;
            if (far.halvings < most_halvings && intervals + 2 * seen.size() < most_intervals &&
                far.middle_s() > far.first_s() && far.middle_s() < far.last_s()) {
                over.look(far);
                seen.push_back(std::move(far));
            } else {
                over.take_all(far);
            }
        }
        for (const Piece& piece : seen) {
            const Piece far = over.left_of(piece);
            if (!far.bvs)
                continue;
            Piece one{
                {far.first_s(), far.middle_s()}, far.halvings, {}, far.bvs, far.open, {}, far.first, far.middle, {}},
                other{
                    {far.middle_s(), far.last_s()}, far.halvings, {}, far.bvs, far.open, {}, far.middle, far.last, {}};
            if (far.has_keys()) {
                const auto key = static_cast<std::ptrdiff_t>((far.cuts.size() - 1) / 2);
                one.cuts.assign(far.cuts.begin(), far.cuts.begin() + key + 1);
                other.cuts.assign(far.cuts.begin() + key, far.cuts.end());
                one.inside.assign(far.inside.begin(), far.inside.begin() + key);
                other.inside.assign(far.inside.begin() + key, far.inside.end());
            } else {
                ++one.halvings;
                ++other.halvings;
            }
            open.push_back(std::move(one));
            open.push_back(std::move(other));
        }
    }
    return over.intervals();
}

} // namespace cinch
