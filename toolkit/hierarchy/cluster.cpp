// SPDX-License-Identifier: Apache-2.0
#include "toolkit/hierarchy/cluster.hpp"

#include <algorithm>
#include <limits>

namespace cinch {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t most_of_a_fan =
    32; // free triangles of a vertex that are looked at: keeps huge fans from taking quadratic time

// The free triangles at every vertex.
class Fans {
public:
    explicit Fans(const TriangleMesh& mesh)
        : free_(mesh.vertices.size(), 0), begin_(mesh.vertices.size() + 1, 0), triangle_(3 * mesh.triangles.size())
    {
        for (const Triangle& t : mesh.triangles)
            for (std::uint32_t v : t)
                ++free_[v];
        for (std::size_t v = 0; v < free_.size(); ++v)
            begin_[v + 1] = begin_[v] + free_[v];
        end_.assign(begin_.begin() + 1, begin_.end());
        std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
        for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
            for (std::uint32_t v : mesh.triangles[t])
                triangle_[next[v]++] = t;
    }
    void take(const Triangle& t)
    {
        for (std::uint32_t v : t)
            --free_[v];
    }
    std::size_t free(const Triangle& t) const { return std::size_t{free_[t[0]]} + free_[t[1]] + free_[t[2]]; }
    template <class Visit> void visit(std::uint32_t v, const std::vector<bool>& taken, Visit&& see)
    {
        while (begin_[v] < end_[v] && taken[triangle_[begin_[v]]])
            ++begin_[v];
        std::size_t seen = 0;
        for (std::uint32_t i = begin_[v]; i < end_[v] && seen < most_of_a_fan; ++i)
            if (!taken[triangle_[i]]) {
                see(triangle_[i]);
                ++seen;
            }
    }

private:
    std::vector<std::uint32_t> free_, begin_, end_, triangle_;
};

class Grower {
public:
    Grower(const TriangleMesh& mesh, const std::vector<std::uint32_t>& order, ClusterSize most)
        : mesh_(mesh), order_(order), most_(most), fans_(mesh), taken_(mesh.triangles.size(), false),
          candidate_(mesh.triangles.size(), false), inside_(mesh.vertices.size(), false)
    {
        centroid_.reserve(mesh.triangles.size());
        for (const Triangle& t : mesh.triangles)
            centroid_.push_back(mesh.vertices[t[0]] / 3 + mesh.vertices[t[1]] / 3 + mesh.vertices[t[2]] / 3);
    }

    Clusters grow()
    {
        Clusters out;
        out.triangle.reserve(mesh_.triangles.size());
        for (std::uint32_t seed = next_in_order(); seed != none;) {
            for (std::uint32_t t = seed; t != none; t = next_of_cluster()) {
                take(t);
                out.triangle.push_back(t);
            }
            out.first.push_back(static_cast<std::uint32_t>(out.triangle.size()));
            const std::uint32_t neighbour = free_neighbour();
            seed = neighbour != none ? neighbour : next_in_order();
            leave();
        }
        return out;
    }

private:
    void take(std::uint32_t t)
    {
        taken_[t] = true;
        ++count_;
        sum_ += centroid_[t];
        fans_.take(mesh_.triangles[t]);
        for (std::uint32_t v : mesh_.triangles[t]) {
            reach_ = std::max(reach_, 2 * (mesh_.vertices[v] - centroid_[t]).lpNorm<Eigen::Infinity>());
            if (inside_[v])
                continue;
            inside_[v] = true;
            vertices_.push_back(v);
            fans_.visit(v, taken_, [&](std::uint32_t n) {
                if (!candidate_[n])
                    candidates_.push_back(n);
                candidate_[n] = true;
            });
        }
    }
    void leave()
    {
        for (std::uint32_t v : vertices_)
            inside_[v] = false;
        for (std::uint32_t t : candidates_)
            candidate_[t] = false;
        vertices_.clear();
        candidates_.clear();
        count_ = 0;
        sum_ = Vec3::Zero();
        reach_ = 0;
    }

    std::size_t new_vertices(std::uint32_t t) const
    {
        const auto& [a, b, c] = mesh_.triangles[t];
        return static_cast<std::size_t>(!inside_[a]) + (!inside_[b] && b != a) + (!inside_[c] && c != a && c != b);
    }
    bool fits(std::uint32_t t) const { return vertices_.size() + new_vertices(t) <= most_.vertices; }

    std::uint32_t next_of_cluster()
    {
        if (count_ >= most_.triangles)
            return none;
        const Vec3 mean = sum_ / static_cast<double>(count_);
        std::uint32_t best = none;
        std::pair<std::size_t, double> least{};
        for (std::uint32_t t : candidates_) {
            if (taken_[t] || !fits(t))
                continue;
            const std::pair key(new_vertices(t), (centroid_[t] - mean).squaredNorm());
            if (best == none || key < least) {
                best = t;
                least = key;
            }
        }
        if (best != none)
            return best;
        const std::uint32_t other = next_in_order();
        return other != none && fits(other) && (centroid_[other] - mean).lpNorm<Eigen::Infinity>() <= reach_ ? other
                                                                                                             : none;
    }
    // Where the next cluster begins: beside this one, where the fewest free triangles are left, so that no crumbs stay
    // behind.
    std::uint32_t free_neighbour() const
    {
        std::uint32_t best = none;
        for (std::uint32_t t : candidates_)
            if (!taken_[t] && (best == none || fans_.free(mesh_.triangles[t]) < fans_.free(mesh_.triangles[best])))
                best = t;
        return best;
    }
    std::uint32_t next_in_order()
    {
        while (place_ < order_.size() && taken_[order_[place_]])
            ++place_;
        return place_ < order_.size() ? order_[place_] : none;
    }

    const TriangleMesh& mesh_;
    const std::vector<std::uint32_t>& order_;
    const ClusterSize most_;
    Fans fans_;
    std::vector<Vec3> centroid_;
    std::vector<bool> taken_, candidate_, inside_; // inside_: of the present cluster
    std::vector<std::uint32_t> candidates_, vertices_;
    std::size_t place_ = 0; // in order_

    std::size_t count_ = 0; // of the present cluster: triangles, sum of centroids, size of the largest
    Vec3 sum_ = Vec3::Zero();
    double reach_ = 0;
};

} // namespace

Clusters cluster_triangles(const TriangleMesh& mesh, const std::vector<std::uint32_t>& order, ClusterSize most)
{
    return Grower(mesh, order, most).grow();
}

} // namespace cinch
