// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <stdexcept>

#include "cinch/refit.hpp"
#include "toolkit/bounds/bound_vertex.hpp"
#include "toolkit/bounds/rounding.hpp"
#include "toolkit/hierarchy/bounder.hpp"

namespace cinch {

// The front is what was bounded and not opened: the BV's vertices are those of the front and of opened leaves, so the
// greatest support of these bounds it. One heap per direction holds the front by its supports, and what was opened
// since, which is dropped when it comes up. A BV opened for one direction is opened for all.
struct AnytimeBounder::Parts {
    struct Held {
        double support;
        std::uint32_t bv;
        std::size_t place; // of its k supports in `bounds`
    };
    static bool below(const Held& a, const Held& b) { return a.support < b.support; }

    const Bvh& bvh;
    const DeformableSurface& surface;
    std::size_t k;
    Rounding rounding;
    Bounder bounder;
    std::vector<std::vector<std::uint32_t>> vertices; // of each leaf; once it was opened
    std::span<const AffineMap> maps{};
    std::vector<std::vector<Held>> front = std::vector<std::vector<Held>>(k);
    std::vector<double> bounds{}; // of all that was bounded
    std::vector<bool> opened = std::vector<bool>(bvh.bvs.size());
    std::vector<std::uint32_t> all_opened{};
    std::vector<double> supports = std::vector<double>(k), reached = supports, closed = supports;

    // Bounds BVs from `first` on, no looser than `parent` at that place. Each has vertices no farther back than its
    // support in the opposite direction says.
    void bound(std::size_t first, std::size_t count, const std::size_t* parent)
    {
        const std::size_t at = bounds.size();
        bounds.resize(at + count * k);
        bounder.bound(first, first + count, std::span(bounds).subspan(at));
        for (std::size_t i = 0; i < count * k; ++i) {
            const std::size_t d = i % k;
            if (parent)
                bounds[at + i] = std::min(bounds[at + i], bounds[*parent + d]);
            reached[d ^ 1] = std::max(reached[d ^ 1], -bounds[at + i]);
            if (!(bounds[at + i] > closed[d]))
                continue;
            front[d].push_back({bounds[at + i], static_cast<std::uint32_t>(first + i / k), at + i - d});
            std::push_heap(front[d].begin(), front[d].end(), below);
        }
    }

    // A leaf's vertices; its own supports stay bounds of them.
    void close(const Held& leaf)
    {
        std::vector<std::uint32_t>& own = vertices[leaf.bv];
        if (own.empty())
            own = vertices_of(surface, bvh, bvh.bvs[leaf.bv]);
        double most[most_directions], vertex[most_directions];
        std::fill_n(most, k, -infinite);
        for (const std::uint32_t v : own) {
            bound_vertex(surface.mesh.vertices[v], surface.weights.of(v), maps, rounding, axes_of(static_cast<int>(k)),
                         std::span(vertex).first(k));
            for (std::size_t d = 0; d < k; ++d)
                most[d] = std::max(most[d], vertex[d]);
        }
        for (std::size_t d = 0; d < k; ++d) {
            reached[d] = std::max(reached[d], most[d]);
            closed[d] = std::max(closed[d], std::min(most[d], bounds[leaf.place + d]));
        }
    }

    void update()
    {
        for (std::size_t d = 0; d < k; ++d) {
            while (!front[d].empty() && opened[front[d].front().bv]) {
                std::pop_heap(front[d].begin(), front[d].end(), below);
                front[d].pop_back();
            }
            supports[d] = front[d].empty() ? closed[d] : std::max(closed[d], front[d].front().support);
        }
    }

    // Where the bound may lie furthest above the vertices; k where nothing is left above what is closed.
    std::size_t direction() const
    {
        std::size_t best = k;
        const auto gap = [&](std::size_t d) { return supports[d] - reached[d]; };
        for (std::size_t d = 0; d < k; ++d) {
            if (!(supports[d] > closed[d]))
                continue;
            if (best == k || gap(d) > gap(best))
                best = d;
        }
        return best;
    }
};

AnytimeBounder::AnytimeBounder(const Bvh& bvh, const DeformableSurface& surface, const RefitOptions& options)
    : parts_(new Parts{bvh, surface, static_cast<std::size_t>(options.kdop), options.rounding,
                       Bounder(bvh, surface, options, Bounder::Leaves::included),
                       std::vector<std::vector<std::uint32_t>>(bvh.bvs.size())})
{
}
AnytimeBounder::~AnytimeBounder() = default;
AnytimeBounder::AnytimeBounder(AnytimeBounder&&) noexcept = default;

void AnytimeBounder::begin(std::span<const AffineMap> maps)
{
    parts_->bounder.begin(maps);
    parts_->maps = maps;
}

void AnytimeBounder::begin(std::size_t bv)
{
    Parts& p = *parts_;
    if (bv >= p.bvh.bvs.size())
        throw std::out_of_range("AnytimeBounder: the BVH has no BV " + std::to_string(bv));
    for (const std::uint32_t other : p.all_opened)
        p.opened[other] = false;
    p.all_opened.clear();
    p.bounds.clear();
    for (auto& heap : p.front)
        heap.clear();
    std::fill(p.reached.begin(), p.reached.end(), -infinite);
    p.closed = p.reached;
    p.bound(bv, 1, nullptr);
    p.update();
}

bool AnytimeBounder::refine()
{
    Parts& p = *parts_;
    const std::size_t d = p.direction();
    if (d == p.k)
        return false;
    const Parts::Held top = p.front[d].front();
    const Bv& bv = p.bvh.bvs[top.bv];
    p.opened[top.bv] = true;
    p.all_opened.push_back(top.bv);
    if (bv.is_leaf())
        p.close(top);
    else
        p.bound(bv.first_child, 2, &top.place);
    p.update();
    return true;
}

std::size_t AnytimeBounder::refine_for(std::chrono::nanoseconds budget)
{
    const auto end = std::chrono::steady_clock::now() + budget;
    std::size_t steps = 0;
    while (std::chrono::steady_clock::now() < end && refine())
        ++steps;
    return steps;
}

std::size_t AnytimeBounder::refine_to(double tolerance)
{
    const Parts& p = *parts_;
    const auto is_within = [&] {
        for (std::size_t d = 0; d < p.k; ++d)
            if (!(p.supports[d] - p.reached[d] <= tolerance * (p.reached[d] + p.reached[d ^ 1])))
                return false;
        return true;
    };
    std::size_t steps = 0;
    while (!is_within() && refine())
        ++steps;
    return steps;
}

std::span<const double> AnytimeBounder::supports() const { return parts_->supports; }
std::span<const double> AnytimeBounder::reached() const { return parts_->reached; }

} // namespace cinch
