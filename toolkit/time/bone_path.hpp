// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

#include "cinch/io.hpp"
#include "toolkit/time/curve_piece.hpp"

namespace cinch {

using Mat3 = Eigen::Matrix3d;

/// The turn of a bone between two keys of its rotation, as a function of u, the time since the first of them. A
/// rotation is that of a quaternion of any length, R(q) = H(q)/|q|², so that nobody has to normalise keys.
class TurnPath {
public:
    /// Always R(q); the identity for q = 0, as glTF viewers have it.
    static TurnPath fixed(const std::array<double, 4>& q);
    /// glTF's LINEAR, spherical: R(q₀) exp(u/d θ [n]×), the shorter way from q₀ to q₁ (their dot product's exact sign
    /// decides; 0 counts as positive).
    static TurnPath slerp(const std::array<double, 4>& q0, const std::array<double, 4>& q1, double d);
    /// R(p(u)), u up to d: glTF's CUBICSPLINE.
    static TurnPath cubic(Polynomial<4> path, double d);

    /// R, R′ and R″ at u.
    std::array<Mat3, 3> at(double u) const;
    Mat3 place_at(double u) const; ///< R alone

    /// ρ_k ≥ sup ‖R^(k)‖₂ on [a, b], k = 0 to 3; +∞ where the path may pass near 0. And what the derivatives 0 to 2 of
    /// at() are rounded against.
    struct Limits {
        std::array<double, 4> norm{1, 0, 0, 0};
        std::array<double, 3> magnitude{1, 0, 0};
    };
    Limits over(double a, double b) const;

    /// Of slerp(): the angle between the quaternions, whether it is half a turn but for a rounding of binary32, and the
    /// ratio of their lengths, at least 1. Of others an angle of 0.
    struct Between {
        double angle = 0, length_ratio = 1;
        bool is_half = false;
    };
    const Between& between() const { return between_; }

private:
    enum class Kind { fixed, slerp, cubic } kind_ = Kind::fixed;
    Mat3 first_ = Mat3::Identity(), axis_ = Mat3::Zero(); // [n]×
    double rate_ = 0;                                     // θ/d
    Polynomial<4> path_;
    double length_ = 0;
    Between between_;
};

/// A bone's transform to its parent, x ↦ p(t) + R(t) S(t) x, on a closed interval of time within which no curve of it
/// has a key.
class BonePath {
public:
    /// `curves`: those of the bone; the piece of each is that of the interval's middle. `end_s`: only for values there,
    /// the same as those at the beginning of the next interval where curves do not jump.
    BonePath(const Bone& bone, const std::vector<const Curve*>& curves, double middle_s, std::optional<double> end_s);

    /// The linear part and the translation, and their first two derivatives.
    struct Jet {
        std::array<Mat3, 3> m;
        std::array<Vec3, 3> p;
    };
    Jet at(double t_s) const;
    /// Without derivatives, in the same bits.
    struct Place {
        Mat3 m;
        Vec3 p;
    };
    Place place_at(double t_s) const;

    /// Suprema on [a, b] of the norms of derivatives 0 to 3 of p and M = RS, and what derivatives 0 to 2 of at() are
    /// rounded against.
    struct Limits {
        std::array<double, 4> p{}, m{};
        std::array<double, 3> p_magnitude{}, m_magnitude{};
    };
    Limits over(double a_s, double b_s) const;
    /// Of its rotation.
    const TurnPath::Between& between() const { return r_.path.between(); }

private:
    bool is_matrix_ = false;
    Mat3 matrix_ = Mat3::Identity();
    double matrix_norm_ = 1, matrix_magnitude_ = 1;
    Since<Polynomial<3>> p_, s_;
    Since<TurnPath> r_;
};

} // namespace cinch
