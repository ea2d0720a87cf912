// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/effects/effects.hpp"

namespace cinch {
namespace {

// A fit that keeps every direction in which the neighbours extend by more than rounding: unlike the gradient of the stresses,
// the residual is well conditioned in all of them, and must be 0 at rest.
constexpr double rounding_only = 1e-12;

class Hourglass : public Effect {
public:
    Hourglass(const MeshlessBody& body, double alpha, double young) : Effect("hourglass"), record_(4 * body.neighbour.size()), weight_sum_(body.size(), 0)
    {
        for (std::size_t i = 0, d = 0; i < body.size(); ++i) {
            const std::size_t first = body.row[i], count = body.row[i + 1] - first;
            Eigen::Matrix3Xd offsets(3, count);
            Eigen::VectorXd weights(count);
            double moment = 0;
            for (std::size_t k = 0; k < count; ++k) {
                const auto column = static_cast<Eigen::Index>(k);
                offsets.col(column) = body.rest[body.neighbour[first + k]] - body.rest[i];
                weights[column] = body.kernel[first + k];
                moment += weights[column] * offsets.col(column).squaredNorm();
            }
            const bool deficient = d < body.deficient.size() && body.deficient[d] == i;
            Flat flat{static_cast<std::uint32_t>(i), offsets, {}, {}};
            for (std::size_t k = 0; k < count; ++k) {
                const auto column = static_cast<Eigen::Index>(k);
                const double c = moment > 0 ? alpha * young * body.volume[i] * weights[column] / moment : 0;
                for (int r = 0; r < 3; ++r)
                    record_[4 * (first + k) + static_cast<std::size_t>(r)] = offsets(r, column);
                record_[4 * (first + k) + 3] = deficient ? 0 : c;
                flat.c.push_back(c);
                weight_sum_[i] += c;
                weight_sum_[body.neighbour[first + k]] += c;
            }
            if (deficient) {
                flat.fit = fit_gradient(offsets, weights, rounding_only).d;
                flats_.push_back(std::move(flat));
                ++d;
            }
        }
    }

    bool needs_deformation() const override { return true; }
    double energy(const Configuration& c) const override
    {
        Field scratch(c.x.size(), 0);
        return run(c.body, c.x, c.gradient, scratch);
    }
    void add_forces(const Configuration& c, Forces out) const override { run(c.body, c.x, c.gradient, out.force); }
    bool couples_nodes() const override { return true; }
    void add_product(const Configuration& c, const Field& dx, const MatrixField& dj, Forces out) const override { run(c.body, dx, dj, out.force); }
    void add_diagonal(const Configuration&, std::vector<Mat3>& block) const override
    {
        for (std::size_t i = 0; i < weight_sum_.size(); ++i)
            block[i].diagonal().array() += weight_sum_[i];
    }

private:
    struct Flat { ///< a node whose neighbours span less than space
        std::uint32_t node;
        Eigen::Matrix3Xd offset, fit;
        std::vector<double> c;
    };

    double run(const MeshlessBody& body, const Field& x, const MatrixField& gradient, Field& force) const
    {
        double energy = scatter_residuals({body.row, body.neighbour, record_}, x, gradient, force);
        for (const Flat& f : flats_) {
            const std::uint32_t* neighbour = body.neighbour.data() + body.row[f.node];
            Mat3 g = Mat3::Zero();
            for (std::size_t k = 0; k < f.c.size(); ++k)
                g += (at(x, neighbour[k]) - at(x, f.node)) * f.fit.col(static_cast<Eigen::Index>(k)).transpose();
            for (std::size_t k = 0; k < f.c.size(); ++k) {
                const Vec3 r = at(x, neighbour[k]) - at(x, f.node) - g * f.offset.col(static_cast<Eigen::Index>(k)), t = f.c[k] * r;
                at(force, neighbour[k]) -= t;
                at(force, f.node) += t;
                energy += 0.5 * r.dot(t);
            }
        }
        return energy;
    }

    AlignedVector<double> record_; ///< per entry x_ij and c_ij
    std::vector<double> weight_sum_;
    std::vector<Flat> flats_;
};

} // namespace

std::unique_ptr<Effect> make_hourglass(const MeshlessBody& body, double alpha, double young) { return std::make_unique<Hourglass>(body, alpha, young); }

} // namespace cinch
