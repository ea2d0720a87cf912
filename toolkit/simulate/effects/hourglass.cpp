// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/body_builder.hpp"
#include "toolkit/simulate/effects/effects.hpp"
#include "toolkit/simulate/json_fields.hpp"

namespace cinch {
namespace {

constexpr const char* hourglass_name = "hourglass";

// A fit that keeps every direction in which the neighbours extend by more than rounding: unlike the gradient of the
// stresses, the residual is well conditioned in all of them, and must be 0 at rest.
constexpr double rounding_only = 1e-12;

// With k_i = α E v_i / Σ_j w_ij ‖x_ij‖² the force on neighbour j is −k_i w_ij (X_j − X_i − G_i x_ij). As w_ij x_ij =
// M_i d_ij, M_i the moments Σ_j w_ij x_ij x_ijᵀ, that is a spring k_i to the neighbour and a stress k_i G_i M_i, both
// carried with all other stresses. Of the reference, an affine map of the rest shape, nothing is left in either:
// displacements stand for positions, D_i for G_i.
class Hourglass : public Effect {
public:
    Hourglass(const MeshlessBody& body, double alpha, double young)
        : Effect(hourglass_name), offset_(4 * body.neighbour.size(), 0), spring_(body.size(), 0),
          moments_(12 * body.size(), 0), weight_sum_(body.size(), 0)
    {
        for (std::size_t i = 0, d = 0; i < body.size(); ++i) {
            const std::size_t first = body.row[i], count = body.row[i + 1] - first;
            Eigen::Matrix3Xd offsets(3, count);
            Eigen::VectorXd weights(count);
            for (std::size_t k = 0; k < count; ++k) {
                const auto column = static_cast<Eigen::Index>(k);
                offsets.col(column) = body.rest[body.neighbour[first + k]] - body.rest[i];
                weights[column] = body.kernel(first + k);
                Eigen::Map<Vec3>(offset_.data() + 4 * (first + k)) = offsets.col(column);
            }
            const Mat3 moments = offsets * weights.asDiagonal() * offsets.transpose();
            const double stiffness = moments.trace() > 0 ? alpha * young * body.volume[i] / moments.trace() : 0;
            for (std::size_t k = 0; k < count; ++k) {
                weight_sum_[i] += stiffness * body.kernel(first + k);
                weight_sum_[body.neighbour[first + k]] += stiffness * body.kernel(first + k);
            }
            if (d < body.deficient.size() && body.deficient[d] == i) {
                flats_.push_back({static_cast<std::uint32_t>(i), offsets,
                                  fit_gradient(offsets, weights, rounding_only).d, stiffness * weights});
                ++d;
            } else {
                spring_[i] = stiffness;
                matrix_at(moments_, i) = stiffness * moments;
            }
        }
    }

    bool needs_deformation() const override { return true; }
    bool has_springs() const override { return true; }
    bool couples_nodes() const override { return true; }
    double energy(const Configuration& c) const override
    {
        double sum = residual_energy(lists_of(c.body), offset_, spring_, c.u, c.gradient);
        each_flat_residual(c.body, c.u,
                           [&](const Flat&, std::size_t, const Vec3& r, const Vec3& t) { sum += 0.5 * r.dot(t); });
        return sum;
    }
    void add_forces(const Configuration& c, Forces out) const override { run(c.body, c.u, c.gradient, out); }
    void add_product(const Configuration& c, std::span<const Touch>, const Field& dx, const MatrixField& dj,
                     Forces out) const override
    {
        run(c.body, dx, dj, out);
    }
    void add_diagonal(const Configuration&, std::span<const Touch>, std::vector<Mat3>& block) const override
    {
        for (std::size_t i = 0; i < weight_sum_.size(); ++i)
            block[i].diagonal().array() += weight_sum_[i];
    }

private:
    struct Flat { ///< a node whose neighbours span less than space: its own, tighter fit
        std::uint32_t node;
        Eigen::Matrix3Xd offset, fit;
        Eigen::VectorXd stiffness;
    };

    void run(const MeshlessBody& body, const Field& x, const MatrixField& gradient, Forces out) const
    {
        add_matrix_products(gradient, moments_, out.stress);
        for (std::size_t i = 0; i < body.size(); ++i)
            out.spring[i] += spring_[i];
        each_flat_residual(body, x, [&](const Flat& f, std::size_t j, const Vec3&, const Vec3& t) {
            at(out.force, j) -= t;
            at(out.force, f.node) += t;
        });
    }
    template <class Visit> void each_flat_residual(const MeshlessBody& body, const Field& x, const Visit& visit) const
    {
        for (const Flat& f : flats_) {
            const std::uint32_t* neighbour = body.neighbour.data() + body.row[f.node];
            Mat3 g = Mat3::Zero();
            for (Eigen::Index k = 0; k < f.fit.cols(); ++k)
                g += (at(x, neighbour[k]) - at(x, f.node)) * f.fit.col(k).transpose();
            for (Eigen::Index k = 0; k < f.fit.cols(); ++k) {
                const Vec3 r = at(x, neighbour[k]) - at(x, f.node) - g * f.offset.col(k);
                visit(f, neighbour[k], r, f.stiffness[k] * r);
            }
        }
    }

    AlignedVector<double> offset_; ///< per entry x_ij, in records of 4
    std::vector<double> spring_;   ///< k_i
    MatrixField moments_;          ///< k_i M_i
    std::vector<double> weight_sum_;
    std::vector<Flat> flats_;
};

EffectPlan read_hourglass(JsonFields& f)
{
    const double alpha = f.number("alpha", JsonFields::not_negative(), 1),
                 given = f.number("young", JsonFields::positive(), 0);
    return {[alpha, given](BodyBuilder& body) {
        const double young = given > 0 ? given : body.young();
        if (!(young > 0))
            body.complain("needs 'young', or an effect 'elastic' on the same body");
        body.add(make_hourglass(body.body(), alpha, young));
    }};
}

} // namespace

namespace effects {
extern const EffectKind hourglass{hourglass_name, read_hourglass, R"json([{
    "description": "keeps neighbours where the gradient says that they are",
    "properties": {
        "alpha": {"type": "number", "minimum": 0, "description": "[1]"},
        "young": {"type": "number", "exclusiveMinimum": 0, "description": "[that of the elastic effect]"}
    },
    "example": {"alpha": 0.5, "young": 10}
}])json"};
}

std::unique_ptr<Effect> make_hourglass(const MeshlessBody& body, double alpha, double young)
{
    return std::make_unique<Hourglass>(body, alpha, young);
}

} // namespace cinch
