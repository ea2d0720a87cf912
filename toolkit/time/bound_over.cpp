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

using Instant = std::shared_ptr<const InstantBounds>;

struct Piece {
    double first_s, last_s;
    int halvings = 0;
    std::shared_ptr<const std::vector<std::uint32_t>> bvs;
    std::vector<bool> open;      // which of them the piece is there for; the others are below these
    std::vector<double> bound;   // their supports
    Instant first, last, middle; // of the same list
};

double middle_of(const Piece& piece) { return piece.first_s + (piece.last_s - piece.first_s) / 2; }

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

    // Bounds a piece; what of it exceeds its own ends, the times looked at so far.
    Piece bound(Piece piece)
    {
        const BvList bvs = *piece.bvs;
        const MotionInterval motion = motion_.over(piece.first_s, piece.last_s);
        // The last piece's end, where it is this one's beginning and of the same BVs.
        const bool follows = last_bvs_ == piece.bvs && is_of(last_, motion.first, motion.morph.first);
        if (!is_of(piece.first, motion.first, motion.morph.first))
            piece.first = follows ? last_ : at(bvs, motion.first, motion.morph.first);
        if (!is_of(piece.last, motion.last, motion.morph.last))
            piece.last = is_of(piece.first, motion.last, motion.morph.last) ? piece.first
                                                                            : at(bvs, motion.last, motion.morph.last);
        last_ = piece.last;
        last_bvs_ = piece.bvs;
        piece.bound.resize(bvs.size() * k_);
        refit_(bvs, motion, *piece.first, *piece.last, share_of_norms * tolerance_, piece.bound);
        if (piece.first_s < piece.last_s)
            bounded_ += static_cast<double>(bvs.size());
        std::vector<double> ends(k_);
        std::vector<bool> far(bvs.size());
        for (std::size_t n = 0; n < bvs.size(); ++n) {
            const std::size_t bv = bvs[n] * k_;
            std::copy_n(&piece.first->supports[n * k_], k_, ends.begin());
            take(ends, std::span(piece.last->supports).subspan(n * k_, k_));
            take(std::span(instant_).subspan(bv, k_), ends);
            if (piece.open[n] && !accept(piece, n, ends))
                far[n] = true;
        }
        return part(piece, far);
    }

    // What of it exceeds all times looked at; takes the rest.
    Piece left_of(const Piece& piece)
    {
        std::vector<bool> far(piece.bvs->size());
        for (std::size_t n = 0; n < far.size(); ++n)
            if (piece.open[n] && !accept(piece, n, std::span(instant_).subspan((*piece.bvs)[n] * k_, k_)))
                far[n] = true;
        return part(piece, far);
    }

    // Looks at a time in between.
    void look(Piece& piece, double t_s)
    {
        const MotionInterval motion = motion_.over(piece.first_s, t_s);
        piece.middle = at(*piece.bvs, motion.last, motion.morph.last);
        for (std::size_t n = 0; n < piece.bvs->size(); ++n)
            take(std::span(instant_).subspan((*piece.bvs)[n] * k_, k_),
                 std::span(piece.middle->supports).subspan(n * k_, k_));
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
    Instant at(BvList bvs, const std::vector<AffineMap>& maps, const std::vector<double>& weights)
    {
        return std::make_shared<const InstantBounds>(refit_.at(bvs, maps, weights));
    }

    // Takes the n-th BV's bound if it is near enough to those at instants, or nothing beside what has been taken.
    bool accept(const Piece& piece, std::size_t n, std::span<const double> instants)
    {
        const auto mine = std::span(piece.bound).subspan(n * k_, k_);
        const auto taken = supports_.subspan((*piece.bvs)[n] * k_, k_);
        std::vector<double>& beside = scratch_;
        beside.resize(k_);
        for (std::size_t d = 0; d < k_; ++d)
            beside[d] = mine[d] > taken[d] ? mine[d] : -std::numeric_limits<double>::infinity();
        if (!is_near(beside, instants, tolerance_))
            return false;
        take(taken, mine);
        return true;
    }

    // The same piece for these of its BVs, and all below them.
    Piece part(const Piece& piece, const std::vector<bool>& open)
    {
        Piece out{piece.first_s, piece.last_s, piece.halvings, {}, {}, {}, {}, {}, {}};
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
    // Pieces between keys; bounds of what is loose are kept until all their ends are known, as it depends on them.
    std::vector<double> cuts{a_s};
    for (const double key : motion.keys)
        if (key > a_s && key < b_s)
            cuts.push_back(key);
    cuts.push_back(b_s);
    cuts.push_back(b_s); // where a curve may jump to what no interval before it has
    const auto bvs = std::make_shared<const std::vector<std::uint32_t>>(all.begin(), all.end());
    std::vector<Piece> open;
    for (std::size_t i = 1; i < cuts.size(); ++i)
        open.push_back({cuts[i - 1], cuts[i], 0, bvs, std::vector<bool>(all.size(), true), {}, {}, {}, {}});
    const std::size_t most_intervals = spare_intervals + intervals_per_piece * open.size();
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
                middle_of(far) > far.first_s && middle_of(far) < far.last_s) {
                over.look(far, middle_of(far));
                seen.push_back(std::move(far));
            } else {
                over.take_all(far);
            }
        }
        for (const Piece& piece : seen) {
            const Piece far = over.left_of(piece);
            if (!far.bvs)
                continue;
            const double middle = middle_of(far);
            const int halvings = far.halvings + 1;
            open.push_back({far.first_s, middle, halvings, far.bvs, far.open, {}, far.first, far.middle, {}});
            open.push_back({middle, far.last_s, halvings, far.bvs, far.open, {}, far.middle, far.last, {}});
        }
    }
    return over.intervals();
}

} // namespace cinch
