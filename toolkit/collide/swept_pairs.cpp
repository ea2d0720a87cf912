// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <stdexcept>
#include <string>

#include "cinch/collider.hpp"

namespace cinch {
namespace {

class Traversal {
public:
    Traversal(const SweptBody& a, const SweptBody& b, std::size_t k) : a_(a), b_(b), k_(k) {}

    template <class Use> void operator()(const Use& use)
    {
        open_.clear();
        if (!a_.bvh->bvs.empty() && !b_.bvh->bvs.empty()) // meshes without triangles have no tree
            open_.push_back({0, 0});
        while (!open_.empty()) {
            const auto [i, j] = open_.back();
            open_.pop_back();
            if (!meet(i, j))
                continue;
            const Bv &first = a_.bvh->bvs[i], &second = b_.bvh->bvs[j];
            if (first.is_leaf() && second.is_leaf())
                use(i, j);
            else if (second.is_leaf() || (!first.is_leaf() && extent(a_, i) >= extent(b_, j)))
                open_.insert(open_.end(), {{first.first_child, j}, {first.first_child + 1, j}});
            else
                open_.insert(open_.end(), {{i, second.first_child}, {i, second.first_child + 1}});
        }
    }

private:
    // Along no axis the one lies beyond the other.
    bool meet(std::uint32_t i, std::uint32_t j) const
    {
        const double *s = a_.supports.data() + i * k_, *t = b_.supports.data() + j * k_;
        for (std::size_t d = 0; d < k_; d += 2)
            if (s[d] < -t[d + 1] || t[d] < -s[d + 1])
                return false;
        return true;
    }
    double extent(const SweptBody& of, std::uint32_t bv) const
    {
        const double* s = of.supports.data() + bv * k_;
        return std::max({s[0] + s[1], s[2] + s[3], s[4] + s[5]});
    }

    const SweptBody &a_, &b_;
    std::size_t k_;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> open_;
};

} // namespace

std::vector<LeafPair> swept_leaf_pairs(std::span<const SweptBody> bodies, int kdop)
{
    if (std::find(kdops.begin(), kdops.end(), kdop) == kdops.end())
        throw std::invalid_argument("there is no " + std::to_string(kdop) + "-DOP");
    const auto k = static_cast<std::size_t>(kdop);
    for (std::size_t i = 0; i < bodies.size(); ++i)
        if (bodies[i].supports.size() != bodies[i].bvh->bvs.size() * k)
            throw std::invalid_argument("body " + std::to_string(i) + " has " +
                                        std::to_string(bodies[i].supports.size()) + " supports; its BVs need " +
                                        std::to_string(bodies[i].bvh->bvs.size() * k));
    std::vector<LeafPair> out;
    for (std::uint32_t a = 0; a < bodies.size(); ++a)
        for (std::uint32_t b = a + 1; b < bodies.size(); ++b)
            Traversal(bodies[a], bodies[b], k)([&](std::uint32_t i, std::uint32_t j) { out.push_back({a, i, b, j}); });
    std::sort(out.begin(), out.end());
    return out;
}

void swept(std::span<const double> first, std::span<const double> last, std::span<double> supports)
{
    if (first.size() != last.size() || first.size() != supports.size())
        throw std::invalid_argument("swept: " + std::to_string(first.size()) + ", " + std::to_string(last.size()) +
                                    " and " + std::to_string(supports.size()) + " supports");
    for (std::size_t i = 0; i < first.size(); ++i)
        supports[i] = std::max(first[i], last[i]);
}

} // namespace cinch
