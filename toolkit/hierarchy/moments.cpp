// SPDX-License-Identifier: Apache-2.0
#include "toolkit/hierarchy/moments.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "toolkit/bounds/rounding.hpp"
#include "toolkit/deform/parallel.hpp"
#include "toolkit/hierarchy/lifted_points.hpp"
#include "toolkit/hierarchy/packed_bvh.hpp"
#include "toolkit/hierarchy/spheres.hpp"

namespace cinch {
namespace {

// What one BV is made into.
struct OwnMoments {
    Vec3 centre = Vec3::Zero();
    std::vector<Lifted> point;
    Lifted least{}, greatest{};
};

// d of a vertex about the centre is off by u|d|: the box of all d, and u of its corners and 2u for its own centre and
// half on top.
class LocalBox {
public:
    void include(const Vec3& d)
    {
        low_ = any_ ? Vec3(low_.cwiseMin(d)) : d;
        high_ = any_ ? Vec3(high_.cwiseMax(d)) : d;
        any_ = true;
    }
    RestBox around() const
    {
        RestBox box;
        if (!any_)
            return box;
        for (int s = 0; s < 3; ++s) {
            const double most = std::max(std::abs(low_[s]), std::abs(high_[s]));
            box.centre[s] = 0.5 * low_[s] + 0.5 * high_[s];
            const double half = std::max(high_[s] - box.centre[s], box.centre[s] - low_[s]);
            if (most > 0)
                box.half[s] = succ(half + (4 * unit_roundoff * most + 4 * smallest_subnormal));
        }
        return box;
    }

private:
    Vec3 low_ = Vec3::Zero(), high_ = Vec3::Zero();
    bool any_ = false;
};

// Of a vertex, less the combination of points: as it is rounded, a sum of at most P products and the difference, P + 2
// roundings on leaves of at most the greatest of any point and of the vertex; and what its own components are off.
void include_in_slack(const LiftedVertex& vertex, std::span<const Lifted> point, std::span<const double> alpha,
                      const Lifted& most, OwnMoments& own)
{
    const double points = static_cast<double>(point.size());
    for (std::size_t c = 0; c < lifted_size; ++c) {
        double sum = 0;
        for (std::size_t i = 0; i < point.size(); ++i)
            sum += alpha[i] * point[i][c];
        const double left = vertex.value[c] - sum, leaves = most[c] + std::abs(vertex.value[c]),
                     off = leaves == 0 ? 0
                                       : succ(vertex.off[c] + ((points + 8) * unit_roundoff * leaves +
                                                               (points + 8) * smallest_subnormal));
        own.greatest[c] = std::max(own.greatest[c], left == 0 && off == 0 ? 0 : succ(left + off));
        own.least[c] = std::min(own.least[c], left == 0 && off == 0 ? 0 : -succ(off - left));
    }
}

// Covariance inverted where places spread, in units of the surface: the fit is linear along those directions alone.
Eigen::Matrix3d inverted(const Eigen::Matrix3d& covariance)
{
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance);
    const Vec3 values = eigen.eigenvalues();
    Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();
    for (int i = 0; i < 3; ++i)
        if (values[i] > 1e-6 * values[2] && values[i] > 1e-9)
            inverse += eigen.eigenvectors().col(i) * eigen.eigenvectors().col(i).transpose() / values[i];
    return inverse;
}

// To 24 bits; 0 for what is out of all proportion to 1.
double to_24_bits(double z)
{
    const double split = 0x1p29 * z + z, rounded = split - (split - z); // [Veltkamp 1968]
    return std::abs(z) < 0x1p20 && std::abs(z) > 0x1p-40 ? rounded : 0;
}

// Of the whole surface, by the root's box.
struct Frame {
    Vec3 origin, centre, half; // rest origin, and the box
    double unit;               // of length

    Frame(const Bvh& bvh, const DeformableSurface& surface) : origin(rest_extent(bvh, surface).origin)
    {
        const RestBox& box = bvh.bvs[0].box;
        centre = box.centre;
        half = box.half;
        const double most = half.maxCoeff();
        unit = most > 0 && most < 0x1p1000 ? std::exp2(std::clamp(std::round(std::log2(most)), -1000.0, 1000.0)) : 1;
    }
    // Any place is valid; one far outside the box would only cost room for rounding.
    Vec3 place(const Vec3& x) const
    {
        Vec3 out;
        for (int s = 0; s < 3; ++s)
            out[s] =
                std::isfinite(x[s]) ? std::clamp(x[s], centre[s] - 4 * half[s], centre[s] + 4 * half[s]) : centre[s];
        return out;
    }
    // Of 24 bits about the rest origin. Where the sum is rounded, it lies within 2^-28 of the origin, in its units; so
    // their difference is exact [Sterbenz 1974], as packing wants it.
    Vec3 near(const Vec3& mean) const
    {
        Vec3 out;
        for (int s = 0; s < 3; ++s)
            out[s] = origin[s] + unit * to_24_bits((mean[s] - origin[s]) / unit);
        return out;
    }
};

// Coefficients of the linear fit over the places, weighted by the mean weights: their mean is near 0.
void fit_places(std::span<MomentInfluence> influence, std::span<const WeightModel> model)
{
    Vec3 mean = Vec3::Zero();
    for (std::size_t j = 0; j < influence.size(); ++j)
        mean += model[j].mean * influence[j].place;
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (std::size_t j = 0; j < influence.size(); ++j) {
        const Vec3 from = influence[j].place - mean;
        covariance += model[j].mean * from * from.transpose();
    }
    const Eigen::Matrix3d inverse = inverted(covariance);
    for (std::size_t j = 0; j < influence.size(); ++j) {
        const Vec3 gradient = model[j].mean * (inverse * (influence[j].place - mean));
        if (std::isfinite(gradient.sum()))
            influence[j].gradient = gradient;
        influence[j].mean = model[j].mean;
    }
}

OwnMoments prepare(const DeformableSurface& surface, const Bvh& bvh, const Bv& bv, std::span<const Vec3> place,
                   const Frame& frame, std::span<MomentInfluence> influence)
{
    OwnMoments own;
    const auto nodes = std::span(bvh.node).subspan(bv.first_influence, bv.influence_count);
    const auto models = std::span(bvh.model).subspan(bv.first_influence, bv.influence_count);
    std::vector<std::uint32_t> at(place.size()); // of each simulation node among the BV's
    Vec3 mean = Vec3::Zero();
    for (std::size_t j = 0; j < nodes.size(); ++j) {
        mean += models[j].mean * place[nodes[j]];
        at[nodes[j]] = static_cast<std::uint32_t>(j);
    }
    own.centre = frame.near(mean);
    for (std::size_t j = 0; j < nodes.size(); ++j)
        for (int s = 0; s < 3; ++s) // what is rounded is another place, as good
            influence[j].place[s] = to_24_bits((place[nodes[j]][s] - own.centre[s]) / frame.unit);
    fit_places(influence, models);

    const std::vector<std::uint32_t> vertices = vertices_of(surface, bvh, bv);
    std::vector<LocalBox> local(nodes.size());
    std::vector<LiftedVertex> lifted;
    std::vector<Lifted> value;
    std::vector<Vec3> own_place;
    for (const std::uint32_t k : vertices) {
        const Vec3 d = surface.mesh.vertices[k] - own.centre;
        const Weights::Row row = surface.weights.of(k);
        own_place.clear();
        for (const std::uint32_t node : row.node) {
            own_place.push_back(influence[at[node]].place);
            local[at[node]].include(d);
        }
        lifted.push_back(lift(d, row, own_place, frame.unit));
        value.push_back(lifted.back().value);
    }
    for (std::size_t j = 0; j < nodes.size(); ++j)
        influence[j].local = local[j].around();

    const LiftedPoints points = choose_lifted(value, lifted_scale(frame.unit), lifted_points_of(value.size()));
    Lifted most{};
    for (const std::uint32_t k : points.chosen) {
        own.point.push_back(value[k]);
        for (std::size_t c = 0; c < lifted_size; ++c)
            most[c] = std::max(most[c], std::abs(value[k][c]));
    }
    for (std::size_t k = 0; k < lifted.size(); ++k)
        if (!points.combination[k].empty())
            include_in_slack(lifted[k], own.point, points.combination[k], most, own);
    for (const std::uint32_t k : points.chosen)
        for (std::size_t c = 0; c < lifted_size; ++c) {
            own.greatest[c] = std::max(own.greatest[c], lifted[k].off[c]);
            own.least[c] = std::min(own.least[c], -lifted[k].off[c]);
        }
    return own;
}

} // namespace

MomentData rest_moments(const Bvh& bvh, const DeformableSurface& surface, const std::function<bool(const Bv&)>& wanted)
{
    MomentData out;
    out.influence.assign(bvh.node.size(), {});
    out.first_point.push_back(0);
    if (bvh.bvs.empty())
        return out;
    const Frame frame(bvh, surface);
    out.unit = frame.unit;
    std::vector<Vec3> place = surface.place.size() == surface.weights.node_count ? surface.place : node_places(surface);
    for (Vec3& x : place)
        x = frame.place(x);
    std::vector<OwnMoments> own(bvh.bvs.size());
    parallel_blocks(bvh.bvs.size(), 4, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            const Bv& bv = bvh.bvs[i];
            if (wanted(bv))
                own[i] = prepare(surface, bvh, bv, place, frame,
                                 std::span(out.influence).subspan(bv.first_influence, bv.influence_count));
        }
    });
    for (OwnMoments& bv : own) {
        out.centre.push_back(bv.centre);
        out.point.insert(out.point.end(), bv.point.begin(), bv.point.end());
        out.first_point.push_back(out.point.size());
        out.least.push_back(bv.least);
        out.greatest.push_back(bv.greatest);
        bv = {};
    }
    return out;
}

} // namespace cinch
