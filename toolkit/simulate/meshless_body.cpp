// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/meshless_body.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <Eigen/LU>
#include <Eigen/SVD>

#include "cinch/environment.hpp"
#include "toolkit/deform/parallel.hpp"
#include "toolkit/deform/sample_nodes.hpp"
#include "toolkit/surface/length.hpp"
#include "toolkit/surface/triangle_mesh.hpp"

namespace cinch {
namespace {

// An extent a thousandth of the greatest: moments 1e-6 of the greatest, below which the inverse would amplify noise
// (models of the field call this the safe inversion).
constexpr double flat = 1e-3;

constexpr std::size_t most_neighbours = 400; // the nearest ones

struct Near {
    double distance;
    std::uint32_t node;
};

// All nodes but i, by distance, then index.
std::vector<Near> by_distance(std::span<const Vec3> nodes, std::size_t i)
{
    std::vector<Near> near;
    near.reserve(nodes.size());
    for (std::size_t j = 0; j < nodes.size(); ++j)
        if (j != i)
            near.push_back({length(nodes[j] - nodes[i]), static_cast<std::uint32_t>(j)});
    std::sort(near.begin(), near.end(), [](const Near& a, const Near& b) {
        return a.distance != b.distance ? a.distance < b.distance : a.node < b.node;
    });
    return near;
}

struct Neighbourhood {
    std::vector<std::uint32_t> node;
    Eigen::Matrix3Xd offset;
    Eigen::VectorXd weight;
    Fit fit;
};

Neighbourhood within(std::span<const Vec3> nodes, std::size_t i, const std::vector<Near>& near, double h)
{
    Neighbourhood n;
    for (const Near& other : near)
        if (other.distance < h && n.node.size() < most_neighbours)
            n.node.push_back(other.node);
    std::sort(n.node.begin(), n.node.end());
    const auto count = static_cast<Eigen::Index>(n.node.size());
    n.offset.resize(3, count);
    n.weight.resize(count);
    for (Eigen::Index j = 0; j < count; ++j) {
        n.offset.col(j) = nodes[n.node[static_cast<std::size_t>(j)]] - nodes[i];
        const double r = (n.offset.col(j) / h).norm(), s = 1 - r * r;
        n.weight[j] = s * s * s;
    }
    n.fit = fit_gradient(n.offset, n.weight, flat);
    return n;
}

// Müller et al. 2004: m_i = s r̄_i³ ρ, ρ_i = Σ_j m_j w_ij, v_i = m_i / ρ_i, s such that the densities are right on
// average.
std::vector<double> density_volumes(const MeshlessBody& body, const std::vector<double>& mean_distance)
{
    const std::size_t n = body.size();
    auto kernel = [](double w, double h) { return 315 / (64 * std::numbers::pi) * w / (h * h * h); };
    std::vector<double> volume(n), sum(n);
    double s = 0;
    for (std::size_t i = 0; i < n; ++i) {
        auto cube = [&](std::size_t j) { return mean_distance[j] * mean_distance[j] * mean_distance[j]; };
        sum[i] = cube(i) * kernel(1, body.support[i]);
        for (std::uint32_t e = body.row[i]; e < body.row[i + 1]; ++e)
            sum[i] += cube(body.neighbour[e]) * kernel(body.kernel(e), body.support[i]);
        s += 1 / sum[i] / static_cast<double>(n);
    }
    for (std::size_t i = 0; i < n; ++i)
        volume[i] = mean_distance[i] * mean_distance[i] * mean_distance[i] / sum[i];
    return volume;
}

void scale_to(double total, std::vector<double>& volume)
{
    double sum = 0;
    for (const double v : volume)
        sum += v;
    for (double& v : volume)
        v *= total / sum;
}

} // namespace

Fit fit_gradient(const Eigen::Matrix3Xd& offsets, const Eigen::VectorXd& weights, double threshold)
{
    Fit fit;
    fit.d = Eigen::Matrix3Xd::Zero(3, offsets.cols());
    const double scale = offsets.cols() ? offsets.cwiseAbs().maxCoeff() : 0;
    if (!(scale > 0))
        return fit;
    const Eigen::VectorXd root = weights.cwiseSqrt();
    Eigen::MatrixX3d a = (offsets / scale).transpose();
    a = root.asDiagonal() * a;
    if (a.rows() < 3)
        a.conservativeResizeLike(Eigen::MatrixX3d::Zero(3, 3));
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(a, Eigen::ComputeThinU | Eigen::ComputeThinV);
    const Eigen::Vector3d sigma = svd.singularValues();
    while (fit.rank < 3 && sigma[fit.rank] > threshold * sigma[0])
        ++fit.rank;
    fit.frame = svd.matrixV();
    if (fit.frame.determinant() < 0)
        fit.frame.col(2) *= -1;
    for (Eigen::Index j = 0; j < offsets.cols(); ++j)
        for (int s = 0; s < fit.rank; ++s)
            fit.d.col(j) += svd.matrixV().col(s) * (svd.matrixU()(j, s) / sigma[s] * root[j] / scale);
    return fit;
}

MeshlessBody discretise(std::span<const Vec3> nodes, std::span<const double> volume, const MeshlessOptions& options)
{
    require_default_arithmetic();
    auto positive = [](double x) { return x > 0 && std::isfinite(x); };
    if (nodes.empty() || !positive(options.support_factor) || options.nearest < 1 || !positive(options.density) ||
        !(options.support_radius >= 0) || !(options.total_volume >= 0) ||
        (!volume.empty() && volume.size() != nodes.size()) || !std::all_of(volume.begin(), volume.end(), positive) ||
        !std::all_of(nodes.begin(), nodes.end(), [](const Vec3& x) { return x.allFinite(); }))
        throw std::invalid_argument("discretise: at least one node, everything finite and positive is needed");

    MeshlessBody body;
    body.rest.assign(nodes.begin(), nodes.end());
    const std::size_t n = nodes.size();
    std::vector<double> mean_distance(n, 1);
    std::size_t coincident = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const std::vector<Near> near = by_distance(nodes, i);
        if (!near.empty() && !std::isfinite(near.back().distance))
            throw std::invalid_argument("discretise: simulation nodes are too far apart for doubles");
        const std::size_t k = std::min(static_cast<std::size_t>(options.nearest), near.size());
        double mean = 0;
        for (std::size_t j = 0; j < k; ++j)
            mean += near[j].distance / static_cast<double>(k);
        coincident += k > 0 && near.front().distance == 0;
        if (!(mean > 0)) // alone, or all coincide
            mean = near.empty() || !(near.back().distance > 0) ? 1 : near.back().distance;
        mean_distance[i] = mean;
        double h = options.support_radius > 0 ? options.support_radius : options.support_factor * mean;
        Neighbourhood chosen = within(nodes, i, near, h);
        if (options.support_radius == 0) {
            for (double wider = 1.25 * h; chosen.fit.rank < 3 && wider <= 4 * h; wider *= 1.25) {
                Neighbourhood more = within(nodes, i, near, wider);
                if (more.fit.rank == 3) {
                    chosen = std::move(more);
                    h = wider;
                }
            }
        }
        body.support.push_back(h);
        body.neighbour.insert(body.neighbour.end(), chosen.node.begin(), chosen.node.end());
        for (Eigen::Index j = 0; j < chosen.weight.size(); ++j)
            for (const double value : {chosen.fit.d(0, j), chosen.fit.d(1, j), chosen.fit.d(2, j), chosen.weight[j]})
                body.record.push_back(value);
        body.row.push_back(static_cast<std::uint32_t>(body.neighbour.size()));
        body.rank.push_back(static_cast<std::uint8_t>(chosen.fit.rank));
        if (chosen.fit.rank < 3) {
            body.deficient.push_back(static_cast<std::uint32_t>(i));
            body.frame.push_back(chosen.fit.frame);
        }
    }
    body.spacing = n > 1 ? *std::min_element(mean_distance.begin(), mean_distance.end()) : 0;
    if (volume.empty()) {
        body.volume = density_volumes(body, mean_distance);
        if (options.total_volume > 0)
            scale_to(options.total_volume, body.volume);
    } else {
        body.volume.assign(volume.begin(), volume.end());
    }
    for (const double v : body.volume) {
        if (!positive(v) || !positive(options.density * v))
            throw std::invalid_argument("discretise: a node's volume or mass is no positive double");
        body.mass.push_back(options.density * v);
    }
    if (coincident)
        body.notes.push_back(std::to_string(coincident) + " simulation nodes coincide with others");
    if (!body.deficient.empty())
        body.notes.push_back(std::to_string(body.deficient.size()) +
                             " simulation nodes have neighbours in a plane, on a line, or none");
    return body;
}

std::vector<double> cell_volumes(const TriangleMesh& mesh, std::span<const Vec3> nodes)
{
    const std::vector<Vec3> points =
        interior_points(mesh, std::clamp(200.0 * static_cast<double>(nodes.size()), 5e4, 3e5));
    const double enclosed = std::abs(signed_volume(mesh));
    if (points.empty() || !(enclosed > 0))
        return {};
    std::vector<double> share(nodes.size(), 0);
    std::vector<std::uint32_t> nearest(points.size());
    parallel_blocks(points.size(), 1024, [&](std::size_t first, std::size_t last) {
        for (std::size_t p = first; p < last; ++p) {
            double least = std::numeric_limits<double>::infinity();
            for (std::size_t j = 0; j < nodes.size(); ++j)
                if (const double squared = (points[p] - nodes[j]).squaredNorm(); squared < least) {
                    least = squared;
                    nearest[p] = static_cast<std::uint32_t>(j);
                }
        }
    });
    for (const std::uint32_t j : nearest)
        share[j] += 1;
    double sum = 0;
    for (double& s : share)
        sum += s =
            std::max(s, 1.0); // a node that is nearest to no point of the grid: coincident ones, or finer than the grid
    for (double& s : share)
        s *= enclosed / sum;
    return share;
}

} // namespace cinch
