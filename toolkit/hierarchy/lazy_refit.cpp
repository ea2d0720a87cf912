// SPDX-License-Identifier: Apache-2.0
#include "toolkit/hierarchy/lazy_refit.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

#include <hwy/cache_control.h>

#include "cinch/bounds.hpp"
#include "cinch/deform.hpp"
#include "cinch/environment.hpp"
#include "toolkit/bounds/rounding.hpp"
#include "toolkit/deform/parallel.hpp"
#include "toolkit/surface/length.hpp"

namespace cinch {
namespace {

constexpr float last_stamp = 0x1p24f; // floats count by ones up to here
constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float most_known = 0x1p120f; // of a given position, relative to the origin: sums of a few do not overflow

RefitOptions refit_options(const LazyOptions& o)
{
    return {o.methods, o.kdop, Rounding::proven, o.precision, 1, o.rest_shape};
}

bool is_known(const AffineMap& map, const Vec3& absolute)
{
    for (const auto& row : map.m) {
        const double most =
            ((std::abs(row[0]) * absolute[0] + std::abs(row[1]) * absolute[1]) + std::abs(row[2]) * absolute[2]) +
            std::abs(row[3]);
        if (!(most + std::abs(row[0]) + std::abs(row[1]) + std::abs(row[2]) <
              0x1p1020)) // room for the sum over the nodes; false for NaN
            return false;
    }
    return true;
}

} // namespace

LazyRefit::LazyRefit(const Bvh& bvh, const DeformableSurface& surface, const LazyOptions& options,
                     std::span<const MorphTarget> targets)
    : surface_(surface), options_(options), bounder_(bvh, surface, refit_options(options), Bounder::Leaves::left_out),
      leaves_(pack_leaves(bvh, surface, bounder_.rest().origin, options.lanes)), triangle_(bvh.triangle),
      targets_(targets)
{
    links_.resize(bvh.bvs.size());
    std::uint32_t leaf = 0;
    for (std::size_t i = 0; i < links_.size(); ++i) {
        const Bv& bv = bvh.bvs[i];
        const auto size = static_cast<float>(std::min(length(bv.box.half), 1e38));
        links_[i] = bv.is_leaf() ? Link{leaf++, -1 - size, 0} : Link{bv.first_child, size, 0};
    }
    slot_of_.assign(leaves_.leaves.size(), no_slot);
    dops_.assign(links_.size() * dop_floats(options.kdop), 0.0f);
    std::vector<bool> has_weight(surface.weights.node_count, false);
    for (const std::uint32_t j : surface.weights.node)
        has_weight[j] = true;
    for (std::uint32_t j = 0; j < surface.weights.node_count; ++j)
        if (has_weight[j])
            influencing_.push_back(j);
}

std::size_t LazyRefit::bytes() const
{
    auto size = [](const auto& all) { return all.capacity() * sizeof(all[0]); };
    return bounder_.bytes() + leaves_.bytes() + size(links_) + size(triangle_) + size(influencing_) + size(dops_) +
           size(slots_) + size(slot_of_) + size(expanded_) + size(before_) + size(wanted_) + size(jobs_) +
           size(wanted_leaves_) + size(displaced_) + size(placed_);
}

void LazyRefit::begin(const BodyFrame& frame)
{
    now_ = frame;
    if (frame.positions.empty() && frame.weights.size() != targets_.size())
        throw std::invalid_argument("LazyRefit::begin: one weight per morph target is needed");
    if (frame.positions.empty() &&
        std::any_of(frame.weights.begin(), frame.weights.end(), [](double a) { return a != 0; }))
        displace_all();
    if (now_.positions.empty()) {
        const std::size_t unbounded = bounder_.begin(frame.maps);
        origin_ = bounder_.maps().origin;
        known_ = unbounded == 0 || std::all_of(influencing_.begin(), influencing_.end(), [&](std::uint32_t j) {
                     return is_known(frame.maps[j], bounder_.rest().absolute);
                 });
    } else {
        begin_with(now_.positions);
    }
    counts_ = {};
    slots_used_ = 0;
    std::swap(before_, expanded_);
    expanded_.clear();
    ++frame_;
    stamp_ += 1;
    if (stamp_ == last_stamp) { // both counts begin anew
        for (std::uint32_t bv = 0; bv < links_.size(); ++bv) {
            links_[bv].expanded = was_expanded(bv) ? 1 : 0;
            dop(bv)[dop_side(options_.kdop) - 1] = 0;
        }
        frame_ = 2;
        stamp_ = 1;
    }
    full_ = false;
    if (links_.empty() || !known_)
        return;
    std::size_t touched = 0; // leaves that the last query looked at
    for (const std::uint32_t bv : before_)
        for (std::uint32_t c = links_[bv].child; c < links_[bv].child + 2; ++c)
            touched += links_[c].is_leaf();
    full_ = !now_.positions.empty() || options_.update == Update::full ||
            (options_.update == Update::automatic && 2 * touched > leaves_.leaves.size());
    if (full_)
        return refit_all();
    if (!options_.keep_cut)
        before_.clear();
    if (before_.empty())
        note(0);
    for (const std::uint32_t bv : before_)
        for (std::uint32_t c = links_[bv].child; c < links_[bv].child + 2; ++c)
            if (!was_expanded(c))
                note(c);
    supply();
    std::for_each(before_.rbegin(), before_.rend(), [&](std::uint32_t bv) { merge(bv); }); // children before parents
}

// From here on the frame is one of given positions.
void LazyRefit::displace_all()
{
    if (now_.maps.size() != surface_.weights.node_count)
        throw std::invalid_argument("LazyRefit::begin: one transform per simulation node is needed");
    displaced_ = surface_.mesh.vertices;
    displace(targets_, now_.weights, displaced_);
    placed_.resize(displaced_.size());
    evaluate(displaced_, surface_.weights, now_.maps, placed_);
    now_.positions = placed_;
}

// Relative to the first vertex, on the grid of projected maps.
void LazyRefit::begin_with(std::span<const Vec3> positions)
{
    if (positions.size() != surface_.mesh.vertices.size())
        throw std::invalid_argument("LazyRefit::begin: one position per vertex is needed");
    require_default_arithmetic();
    known_ = std::all_of(positions.begin(), positions.end(), [](const Vec3& x) { return x.allFinite(); });
    origin_ = Vec3::Zero();
    if (known_)
        origin_ = on_grid(positions[0], bounder_.rest());
}

void LazyRefit::refit_all()
{
    for (std::uint32_t bv = 0; bv < links_.size(); ++bv)
        if (links_[bv].is_leaf())
            note(bv);
    supply();
    for (std::uint32_t bv = static_cast<std::uint32_t>(links_.size()); bv-- > 0;)
        if (!links_[bv].is_leaf())
            merge(bv);
}

void LazyRefit::merge(std::uint32_t bv)
{
    const std::size_t floats = dop_floats(options_.kdop);
    float* const own = dop(bv);
    const float* const left = dop(links_[bv].child);
    const float* const right = left + floats;
    for (std::size_t i = 0; i < floats; ++i)
        own[i] = std::max(left[i], right[i]); // of the children's stamps too, which are this frame's
    ++counts_.merged;
}

void LazyRefit::note(std::uint32_t bv)
{
    stamp(bv);
    if (links_[bv].is_leaf()) {
        hwy::Prefetch(&leaves_.leaves[links_[bv].child]);
        slot_of_[links_[bv].child] = full_ ? no_slot : static_cast<std::uint32_t>(slots_used_++);
        wanted_leaves_.emplace_back(bv, slot_of_[links_[bv].child]);
    } else {
        bounder_.prefetch(bv);
        wanted_.push_back(bv);
    }
}

void LazyRefit::expand(std::uint32_t bv)
{
    Link& link = links_[bv];
    if (link.expanded == frame_)
        return;
    link.expanded = frame_;
    expanded_.push_back(bv);
    for (std::uint32_t c = link.child; c < link.child + 2; ++c)
        if (!current(c))
            note(c);
}

void LazyRefit::want(std::uint32_t bv)
{
    if (!current(bv))
        note(bv);
}

void LazyRefit::want_slot(std::uint32_t leaf)
{
    std::uint32_t& slot = slot_of_[links_[leaf].child];
    if (slot != no_slot)
        return;
    slot = static_cast<std::uint32_t>(slots_used_++);
    wanted_leaves_.emplace_back(leaf, slot);
}

void LazyRefit::supply()
{
    if (!wanted_.empty()) {
        parallel_blocks(wanted_.size(), 64, [&](std::size_t first, std::size_t last) {
            bounder_.bound(std::span(wanted_).subspan(first, last - first), dops_.data());
        });
        counts_.bounds += wanted_.size();
        wanted_.clear();
    }
    if (wanted_leaves_.empty())
        return;
    const std::size_t slot_floats = leaf_slot_floats(leaves_.lanes);
    if (slots_.size() < slots_used_ * slot_floats)
        slots_.resize(
            std::min(std::max(2 * slots_.size(), slots_used_ * slot_floats), leaves_.leaves.size() * slot_floats));
    jobs_.clear();
    for (const auto& [bv, slot] : wanted_leaves_) {
        jobs_.push_back({links_[bv].child, slot == no_slot ? nullptr : slots_.data() + slot * slot_floats, dop(bv)});
        counts_.vertices += leaves_.leaves[links_[bv].child].vertices;
    }
    counts_.leaves += jobs_.size();
    if (!now_.positions.empty())
        return place_leaves();
    const LeafInput input{leaves_.lanes,
                          leaves_.leaves,
                          leaves_.value.data(),
                          bounder_.maps().value.data(),
                          4 * projected_rows(static_cast<std::size_t>(options_.kdop / 2)),
                          options_.kdop,
                          bounder_.maps().vertex_error};
    parallel_blocks(jobs_.size(), 64, [&](std::size_t first, std::size_t last) {
        evaluate_leaves(input, std::span(jobs_).subspan(first, last - first));
    });
    wanted_leaves_.clear();
}

// The leaves' vertices from the positions, relative to the first: (x − O) − R passes two roundings of doubles, and one
// to float.
void LazyRefit::place_leaves()
{
    const std::size_t lanes = leaves_.lanes, side = dop_side(options_.kdop);
    const auto axes = axes_of(options_.kdop);
    parallel_blocks(jobs_.size(), 64, [&](std::size_t first, std::size_t last) {
        float unwanted[leaf_slot_floats(16)];
        for (const LeafJob& job : std::span(jobs_).subspan(first, last - first)) {
            const PackedLeaf& leaf = leaves_.leaves[job.leaf];
            float* const slot = job.slot ? job.slot : unwanted;
            LeafPlace& place = place_of(slot, lanes);
            const Vec3& start = now_.positions[surface_.mesh.triangles[triangle_[leaf.first_triangle]][0]];
            float far = 0, out = 0;
            for (int r = 0; r < 3; ++r) {
                place.reference[r] = static_cast<float>(start[r] - origin_[r]);
                out = std::max(out, std::abs(place.reference[r]));
            }
            const std::uint8_t* const corner = reinterpret_cast<const std::uint8_t*>(
                leaves_.value.data() + leaf.first + LeafRun{lanes, leaf.nodes}.corners());
            std::memcpy(slot + 3 * lanes, corner, 3 * lanes);
            for (std::size_t t = 0; t < lanes; ++t) { // every vertex is a corner
                const Triangle& triangle =
                    surface_.mesh
                        .triangles[triangle_[leaf.first_triangle + std::min<std::size_t>(t, leaf.triangles - 1)]];
                for (std::size_t c = 0; c < 3; ++c)
                    for (std::size_t r = 0; r < 3; ++r) {
                        const int row = static_cast<int>(r);
                        const auto x = static_cast<float>((now_.positions[triangle[c]][row] - origin_[row]) -
                                                          static_cast<double>(place.reference[r]));
                        slot[r * lanes + corner[c * lanes + t]] = x;
                        far = std::max(far, std::abs(x));
                    }
            }
            for (std::size_t r = 0; r < 3; ++r)
                std::fill_n(slot + r * lanes + leaf.vertices, lanes - leaf.vertices, slot[r * lanes]);
            if (!(far < most_known && out < most_known)) { // as in evaluate_leaf
                std::fill_n(slot, 3 * lanes, 0.0f);
                place = {{0, 0, 0}, infinity, infinity};
                std::fill_n(job.dop, axes.size(), infinity);
                std::fill_n(job.dop + side, axes.size(), infinity);
                continue;
            }
            place.error = succ(2 * unit_roundoff_of<float> * far + 0x1p-50f * (far + out));
            place.difference = 2 * place.error;
            for (std::size_t a = 0; a < axes.size(); ++a) {
                float most = -infinity, least = infinity, middle = 0;
                for (std::size_t v = 0; v < lanes; ++v) {
                    float along = 0;
                    for (std::size_t r = 0; r < 3; ++r)
                        along += static_cast<float>(axes[a][r]) * slot[r * lanes + v];
                    most = std::max(most, along);
                    least = std::min(least, along);
                }
                for (std::size_t r = 0; r < 3; ++r)
                    middle += static_cast<float>(axes[a][r]) * place.reference[r];
                const float wider = succ(3 * place.error + 16 * unit_roundoff_of<float> *
                                                               (far + out)); // sums of up to three pass 2 roundings
                job.dop[a] = succ(succ(most + middle) + wider);
                job.dop[side + a] = succ(succ(-least - middle) + wider);
            }
        }
    });
    wanted_leaves_.clear();
}

} // namespace cinch
