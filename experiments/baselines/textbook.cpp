// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/baselines/textbook.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cinch {

Textbook::Textbook(const Bvh& bvh, std::size_t bv, std::span<const AffineMap> maps)
{
    for (const AffineMap& map : maps) {
        SimulationNode node;
        for (int r = 0; r < 3; ++r) {
            for (int s = 0; s < 3; ++s)
                node.a(r, s) = map.m[r][s];
            node.t[r] = map.m[r][3];
        }
        nodes_.push_back(node);
    }
    const RestBv rest = bvh.rest(bv);
    for (std::size_t j = 0; j < rest.node.size(); ++j)
        influences_.push_back({rest.node[j], rest.space.l[j], rest.space.h[j]});
    extents_.resize(influences_.size());
    centre_ = rest.box.centre;
    half_ = rest.box.half;
}

namespace {

const Eigen::Vector3d directions[6] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};

} // namespace

// (1) and (2): the box of every influencing node, transformed, and the k-DOP around it.
void Textbook::bound_by_corners()
{
    for (std::size_t j = 0; j < influences_.size(); ++j) {
        const SimulationNode& node = nodes_[influences_[j].node];
        Eigen::Vector3d corner[8];
        for (int c = 0; c < 8; ++c) {
            const Eigen::Vector3d rest(centre_[0] + (c & 1 ? half_[0] : -half_[0]),
                                       centre_[1] + (c & 2 ? half_[1] : -half_[1]),
                                       centre_[2] + (c & 4 ? half_[2] : -half_[2]));
            corner[c] = node.a * rest + node.t;
        }
        for (std::size_t d = 0; d < 6; ++d) {
            double most = directions[d].dot(corner[0]);
            for (int c = 1; c < 8; ++c)
                most = std::max(most, directions[d].dot(corner[c]));
            extents_[j].of[d] = most;
        }
    }
}

void Textbook::bound_by_axes()
{
    for (std::size_t j = 0; j < influences_.size(); ++j) {
        const SimulationNode& node = nodes_[influences_[j].node];
        const Eigen::Vector3d centre = node.a * centre_ + node.t;
        const Eigen::Vector3d axis[3] = {node.a.col(0) * half_[0], node.a.col(1) * half_[1], node.a.col(2) * half_[2]};
        for (std::size_t d = 0; d < 6; ++d)
            extents_[j].of[d] = directions[d].dot(centre) + std::abs(directions[d].dot(axis[0])) +
                                std::abs(directions[d].dot(axis[1])) + std::abs(directions[d].dot(axis[2]));
    }
}

void Textbook::bound(TransformedBox box, std::span<double> supports)
{
    if (box == TransformedBox::corners)
        bound_by_corners();
    else
        bound_by_axes();
    // (3): per direction the nodes with the two largest extrema, and Eq. 12.
    for (std::size_t d = 0; d < 6; ++d) {
        std::size_t first = 0, second = influences_.size() > 1 ? 1 : 0;
        if (extents_[second].of[d] > extents_[first].of[d])
            std::swap(first, second);
        for (std::size_t j = 2; j < influences_.size(); ++j) {
            if (extents_[j].of[d] > extents_[first].of[d]) {
                second = first;
                first = j;
            } else if (extents_[j].of[d] > extents_[second].of[d]) {
                second = j;
            }
        }
        double least = 0, rest = 0;
        for (std::size_t j = 0; j < influences_.size(); ++j)
            if (j != first && j != second) {
                least += influences_[j].l;
                rest += influences_[j].l * extents_[j].of[d];
            }
        const double h = influences_[first].h;
        supports[d] = h * extents_[first].of[d] + (1 - h - least) * extents_[second].of[d] + rest;
    }
}

} // namespace cinch
