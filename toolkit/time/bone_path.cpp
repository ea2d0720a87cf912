// SPDX-License-Identifier: Apache-2.0
#include "toolkit/time/bone_path.hpp"

#include <Eigen/Eigenvalues>

namespace cinch {
namespace {

using Quad = std::array<double, 4>; // x, y, z, w

constexpr double infinity = std::numeric_limits<double>::infinity();

// Rounded sums and products of non-negative terms, a few hundred of them at most: 2^-40 covers them.
constexpr double rounded_up = 1 + 0x1p-40;

double dot(const Quad& x, const Quad& y) { return ((x[0] * y[0] + x[1] * y[1]) + x[2] * y[2]) + x[3] * y[3]; }

// Whether Σ x_i y_i < 0, exactly, where no product underflows: the products and their errors as a sum without rounding
// [Shewchuk], whose greatest part decides.
bool is_negative(const Quad& x, const Quad& y)
{
    const double sum = dot(x, y);
    double size = 0;
    for (std::size_t i = 0; i < 4; ++i)
        size += std::abs(x[i] * y[i]);
    if (std::abs(sum) > 0x1p-48 * size)
        return sum < 0;
    std::array<double, 8> part{};
    std::size_t count = 0;
    auto add = [&](double value) {
        for (std::size_t i = 0; i < count; ++i) { // two-sum, from the least part on
            const double a = part[i], total = a + value, b = total - a;
            part[i] = (a - (total - b)) + (value - b);
            value = total;
        }
        part[count++] = value;
    };
    for (std::size_t i = 0; i < 4; ++i) {
        const double p = x[i] * y[i];
        add(std::fma(x[i], y[i], -p));
        add(p);
    }
    for (std::size_t i = count; i-- > 0;)
        if (part[i] != 0)
            return part[i] < 0;
    return false;
}

// The polar form of H(q) = |q|² R(q): H(q) = polar(q, q).
Mat3 polar(const Quad& a, const Quad& b)
{
    auto s = [&](std::size_t i, std::size_t j) { return a[i] * b[j] + a[j] * b[i]; }; // 2 × the symmetric product
    const double xx = s(0, 0) / 2, yy = s(1, 1) / 2, zz = s(2, 2) / 2, ww = s(3, 3) / 2;
    Mat3 h;
    h << ((ww + xx) - yy) - zz, s(0, 1) - s(2, 3), s(0, 2) + s(1, 3), //
        s(0, 1) + s(2, 3), ((ww - xx) + yy) - zz, s(1, 2) - s(0, 3),  //
        s(0, 2) - s(1, 3), s(1, 2) + s(0, 3), ((ww - xx) - yy) + zz;
    return h;
}

Mat3 rotation(const Quad& of)
{
    double most = 0; // squares of tiny numbers vanish
    for (const double x : of)
        most = std::max(most, std::abs(x));
    const int down = most > 0 ? -std::ilogb(most) : 0;
    Quad q;
    for (std::size_t i = 0; i < 4; ++i)
        q[i] = std::scalbn(of[i], down);
    const double square = dot(q, q);
    return square > 0 ? Mat3(polar(q, q) / square) : Mat3::Identity();
}

Mat3 cross(const Vec3& n)
{
    Mat3 out;
    out << 0, -n[2], n[1], n[2], 0, -n[0], -n[1], n[0], 0;
    return out;
}

// A curve's piece as a path of its first N numbers.
template <std::size_t N> Polynomial<N> path_of(const Curve& curve, const CurvePiece& piece)
{
    return polynomial_of<N>(curve.time_s, curve.interpolation, piece, [&](std::size_t i) {
        std::array<double, N> out;
        std::copy_n(curve.value[i].begin(), N, out.begin());
        return out;
    });
}

// Whether a piece of LINEAR rotations does not end where the next one begins: a quaternion 0 has no rotation to go to
// or to come from (TurnPath::slerp), and is the identity itself.
bool jumps_after(const Curve& curve, const CurvePiece& piece)
{
    auto is_zero = [](const Quad& q) { return q == Quad{}; };
    return curve.target == Curve::Target::rotation && curve.interpolation == Curve::Interpolation::linear &&
           !piece.constant && (is_zero(curve.value[piece.key]) || is_zero(curve.value[piece.key + 1]));
}

double infinite_unless(double x) { return x < infinity ? x : infinity; }

} // namespace

TurnPath TurnPath::fixed(const Quad& q)
{
    TurnPath out;
    out.first_ = rotation(q);
    return out;
}

TurnPath TurnPath::slerp(const Quad& q0, const Quad& q1, double d)
{
    TurnPath out = fixed(q0);
    if (dot(q0, q0) == 0 || dot(q1, q1) == 0)
        return out; // no rotation to go to
    // q̄₀ q₁ = (v, c): the turn from the one to the other, in the frame of the first.
    Vec3 a(q0[0], q0[1], q0[2]), b(q1[0], q1[1], q1[2]);
    Vec3 v = (q0[3] * b - q1[3] * a) - cross(a) * b;
    double c = dot(q0, q1);
    if (is_negative(q0, q1)) {
        v = -v;
        c = -c;
    }
    const double length = v.norm();
    if (!(length > 0))
        return out;
    out.kind_ = Kind::slerp;
    out.axis_ = cross(v / length);
    const double angle = std::atan2(length, std::max(c, 0.0)), ratio = dot(q1, q1) / dot(q0, q0);
    out.rate_ = 2 * angle / d;
    out.between_ = {angle * rounded_up, std::sqrt(std::max(ratio, 1 / ratio)) * rounded_up, c <= 0x1p-20 * length};
    return out;
}

TurnPath TurnPath::cubic(Polynomial<4> path, double d)
{
    TurnPath out;
    out.length_ = d;
    out.kind_ = Kind::cubic;
    out.path_ = std::move(path);
    return out;
}

Mat3 TurnPath::place_at(double u) const
{
    if (kind_ == Kind::fixed)
        return first_;
    if (kind_ == Kind::slerp) {
        const double half = rate_ * u / 2, s = std::sin(half), sine = 2 * s * std::cos(half); // 1 − cos = 2 sin²
        const Mat3 square = axis_ * axis_;
        return first_ * (Mat3::Identity() + sine * axis_ + 2 * s * s * square);
    }
    const Quad q = path_.derivative(0, u);
    const double n = dot(q, q);
    return n > 0 ? Mat3(polar(q, q) / n) : Mat3::Identity();
}

std::array<Mat3, 3> TurnPath::at(double u) const
{
    const Mat3 r = place_at(u);
    if (kind_ == Kind::fixed)
        return {r, Mat3::Zero(), Mat3::Zero()};
    if (kind_ == Kind::slerp) {
        const Mat3 first = rate_ * (r * axis_);
        return {r, first, rate_ * (first * axis_)};
    }
    const Quad q = path_.derivative(0, u), q1 = path_.derivative(1, u), q2 = path_.derivative(2, u);
    const double n = dot(q, q), n1 = 2 * dot(q, q1), n2 = 2 * (dot(q1, q1) + dot(q, q2));
    if (!(n > 0))
        return {Mat3::Identity(), Mat3::Zero(), Mat3::Zero()}; // over() is infinite
    const Mat3 r1 = (2 * polar(q, q1) - n1 * r) / n;
    return {r, r1, (2 * (polar(q1, q1) + polar(q, q2)) - 2 * n1 * r1 - n2 * r) / n};
}

TurnPath::Limits TurnPath::over(double a, double b) const
{
    Limits out;
    if (kind_ == Kind::fixed)
        return out;
    if (kind_ == Kind::slerp) {
        for (std::size_t k = 1; k < 4; ++k)
            out.norm[k] = out.norm[k - 1] * rate_ * rounded_up;
        out.magnitude = {1, out.norm[1], out.norm[2]};
        return out;
    }
    // R = H/N with N = |q|²; its spatial angular velocity is ω = 2W/N, W = Im(q′ q̄). (time: w in [0, 1], u = a + h w.)
    const double h = b - a;
    const Polynomial<4> q = path_.over(a, b), slope = q.slope();
    const auto n = product<1>(q, q, [](const Quad& x, const Quad& y) { return std::array{dot(x, y)}; });
    const auto w = product<3>(slope, q, [](const Quad& x, const Quad& y) { // Im(x ȳ)
        return std::array{y[3] * x[0] - x[3] * y[0] - (x[1] * y[2] - x[2] * y[1]),
                          y[3] * x[1] - x[3] * y[1] - (x[2] * y[0] - x[0] * y[2]),
                          y[3] * x[2] - x[3] * y[2] - (x[0] * y[1] - x[1] * y[0])};
    });
    std::array<double, 3> size; // of the path's derivatives, without cancellation; coefficients are rounded against
    for (std::size_t k = 0; k < 3; ++k) // what they are at the piece's end
        size[k] = path_.magnitude(k, length_);
    double least = infinity;
    for (const auto& c : n.control())
        least = std::min(least, c[0]);
    least -= 0x1p-44 * size[0] * size[0];
    if (!(least > 0x1p-30 * size[0] * size[0])) {
        out.norm = {1, infinity, infinity, infinity};
        out.magnitude = {infinity, infinity, infinity};
        return out;
    }
    if (!(h > 0)) { // an instant, for which nothing is asked of derivatives
        out.norm = {1, infinity, infinity, infinity};
        const double h0 = size[0] * size[0];
        out.magnitude = {2 * h0 / least, infinity, infinity};
        return out;
    }
    // Suprema of derivatives, back in units of time; what cancels in them is rounded against the sizes.
    const double third = path_.magnitude(3, length_), s0 = size[0], s1 = size[1], s2 = size[2], round = 0x1p-42;
    const double w0 = w.greatest_norm() / h + round * s1 * s0,
                 w1 = w.slope().greatest_norm() / h / h + round * (s2 * s0 + s1 * s1),
                 w2 = w.slope().slope().greatest_norm() / h / h / h + round * (third * s0 + 3 * s2 * s1),
                 n1 = n.slope().greatest_norm() / h + round * 2 * s1 * s0,
                 n2 = n.slope().slope().greatest_norm() / h / h + round * 2 * (s2 * s0 + s1 * s1);
    const double o0 = 2 * w0 / least, o1 = 2 * (w1 / least + w0 * n1 / least / least),
                 o2 = 2 * (w2 / least + 2 * w1 * n1 / least / least + w0 * n2 / least / least +
                           2 * w0 * n1 * n1 / least / least / least);
    out.norm = {1, infinite_unless(o0 * rounded_up), infinite_unless((o1 + o0 * o0) * rounded_up),
                infinite_unless((o2 + 3 * o0 * o1 + o0 * o0 * o0) * rounded_up)};
    // at(): running errors of (H^(k) − Σ N^(l) R^(k−l))/N, with the relative error of N itself as a second one.
    const double h0 = s0 * s0, h1 = 2 * s1 * s0, h2 = 2 * (s1 * s1 + s2 * s0);
    const double m0 = 2 * h0 / least, m1 = 2 * (h1 + h1 * m0) / least, m2 = 2 * (h2 + 2 * h1 * m1 + h2 * m0) / least;
    out.magnitude = {m0, m1, m2};
    return out;
}

BonePath::BonePath(const Bone& bone, const std::vector<const Curve*>& curves, double middle_s,
                   std::optional<double> end_s)
{
    p_.path.c = bone.translation;
    s_.path.c = bone.scale;
    r_.path = TurnPath::fixed(bone.rotation);
    is_matrix_ = bone.is_matrix && curves.empty(); // else it was taken apart when the file was read
    if (is_matrix_) {
        const Eigen::Map<const Eigen::Matrix4d> m(bone.matrix.data());
        matrix_ = m.topLeftCorner<3, 3>();
        p_.path.c = std::array<double, 3>{m(0, 3), m(1, 3), m(2, 3)};
        matrix_magnitude_ = norm_of(matrix_);
        const double scale = matrix_magnitude_ < 0x1p-450 ? 0x1p600 : 1; // squares must not vanish
        const Mat3 scaled = scale * matrix_;
        const Eigen::SelfAdjointEigenSolver<Mat3> squared(scaled.transpose() * scaled, Eigen::EigenvaluesOnly);
        matrix_norm_ = std::sqrt(std::max(squared.eigenvalues()[2], 0.0)) / scale + 0x1p-40 * matrix_magnitude_;
    }
    for (const Curve* curve : curves) {
        CurvePiece piece = piece_of(curve->time_s, curve->interpolation, middle_s);
        if (end_s && !jumps_after(*curve, piece))
            piece = piece_of(curve->time_s, curve->interpolation,
                             end_of(curve->time_s, curve->interpolation, middle_s, *end_s));
        const double key_s = curve->time_s[piece.key],
                     length_s = piece.constant ? 0 : curve->time_s[piece.key + 1] - key_s;
        switch (curve->target) {
        case Curve::Target::translation:
            p_ = {key_s, length_s, path_of<3>(*curve, piece)};
            break;
        case Curve::Target::scale:
            s_ = {key_s, length_s, path_of<3>(*curve, piece)};
            break;
        case Curve::Target::rotation:
            r_.key_s = key_s;
            if (curve->interpolation == Curve::Interpolation::cubic_spline)
                r_.path = piece.constant ? TurnPath::fixed(curve->value[3 * piece.key + 1])
                                         : TurnPath::cubic(path_of<4>(*curve, piece), length_s);
            else
                r_.path = piece.constant
                              ? TurnPath::fixed(curve->value[piece.key])
                              : TurnPath::slerp(curve->value[piece.key], curve->value[piece.key + 1], length_s);
        }
    }
}

BonePath::Jet BonePath::at(double t_s) const
{
    Jet out;
    std::array<Vec3, 3> s;
    for (std::size_t k = 0; k < 3; ++k) {
        out.p[k] = Vec3(p_.path.derivative(k, t_s - p_.key_s).data());
        s[k] = Vec3(s_.path.derivative(k, t_s - s_.key_s).data());
    }
    if (is_matrix_) {
        out.m = {matrix_, Mat3::Zero(), Mat3::Zero()};
        return out;
    }
    const auto r = r_.path.at(t_s - r_.key_s);
    out.m[0] = r[0] * s[0].asDiagonal();
    out.m[1] = r[1] * s[0].asDiagonal();
    out.m[1] += r[0] * s[1].asDiagonal();
    out.m[2] = r[2] * s[0].asDiagonal();
    out.m[2] += 2 * (r[1] * s[1].asDiagonal());
    out.m[2] += r[0] * s[2].asDiagonal();
    return out;
}

BonePath::Place BonePath::place_at(double t_s) const
{
    const Vec3 p(p_.path.derivative(0, t_s - p_.key_s).data());
    if (is_matrix_)
        return {matrix_, p};
    const Vec3 s(s_.path.derivative(0, t_s - s_.key_s).data());
    return {r_.path.place_at(t_s - r_.key_s) * s.asDiagonal(), p};
}

BonePath::Limits BonePath::over(double a_s, double b_s) const
{
    Limits out;
    suprema(
        p_, a_s, b_s, [](const Polynomial<3>& p) { return p.greatest_norm(); }, out.p, out.p_magnitude);
    if (is_matrix_) {
        out.m = {matrix_norm_, 0, 0, 0};
        out.m_magnitude = {matrix_magnitude_, 0, 0};
        return out;
    }
    std::array<double, 4> s;
    std::array<double, 3> s_magnitude;
    auto greatest_entry = [](const Polynomial<3>& p) { // ‖diag(s)‖₂
        double most = 0;
        for (const auto& point : p.control())
            for (const double x : point)
                most = std::max(most, std::abs(x));
        return most;
    };
    suprema(s_, a_s, b_s, greatest_entry, s, s_magnitude);
    const TurnPath::Limits r = r_.path.over(a_s - r_.key_s, b_s - r_.key_s);
    static constexpr double choose[4][4] = {{1}, {1, 1}, {1, 2, 1}, {1, 3, 3, 1}};
    auto times = [](double x, double y) { return x == 0 || y == 0 ? 0 : x * y; }; // ∞·0 is 0 here
    for (std::size_t k = 0; k < 4; ++k)
        for (std::size_t l = 0; l <= k; ++l) {
            out.m[k] += choose[k][l] * times(r.norm[k - l], s[l]) * rounded_up;
            if (k < 3)
                out.m_magnitude[k] += choose[k][l] * times(r.magnitude[k - l], s_magnitude[l]);
        }
    return out;
}

} // namespace cinch
