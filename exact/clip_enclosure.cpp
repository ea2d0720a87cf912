// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/clip_enclosure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include <boost/multiprecision/mpfi.hpp>

#include "exact/sin_cos.hpp"

namespace cinch::exact {
namespace {

namespace mp = boost::multiprecision;
using Real = mp::number<mp::mpfi_float_backend<77>, mp::et_off>; // an interval; 256 bits
using LongQuad = std::array<Real, 4>;                            // x, y, z, w
using Quad = std::array<Interval, 4>;                            // x, y, z, w
using Rows = std::array<std::array<Interval, 4>, 3>;             // a row (0 0 0 1), or of a derivative (0 0 0 0), below

// A value with its derivative by time.
void clear(Interval& x) { x = Interval(0); }
template <class T, std::size_t n> void clear(std::array<T, n>& x)
{
    for (T& entry : x)
        clear(entry);
}
template <class T> struct WithSlope {
    T value, slope;

    WithSlope() // an Interval by itself is none
    {
        clear(value);
        clear(slope);
    }
    explicit WithSlope(const T& still) : value(still) { clear(slope); }
    WithSlope(const T& at, const T& rate) : value(at), slope(rate) {}
};

Quad combined(const Interval& a, const Quad& x, const Interval& b, const Quad& y)
{
    Quad out;
    for (std::size_t i = 0; i < 4; ++i)
        out[i] = a * x[i] + b * y[i];
    return out;
}

template <class Q> auto dot(const Q& x, const Q& y)
{
    auto sum = x[0] * y[0];
    for (std::size_t i = 1; i < 4; ++i)
        sum += x[i] * y[i];
    return sum;
}

Quad exactly(const std::array<double, 4>& x)
{
    return {Interval(x[0]), Interval(x[1]), Interval(x[2]), Interval(x[3])};
}

Interval interval_of(const Real& x)
{
    const double low = mpfr_get_d(&x.backend().data()->left, MPFR_RNDD),
                 high = mpfr_get_d(&x.backend().data()->right, MPFR_RNDU);
    return low <= high ? Interval(low, high) : Interval::largest();
}
Quad interval_of(const LongQuad& x)
{
    return {interval_of(x[0]), interval_of(x[1]), interval_of(x[2]), interval_of(x[3])};
}

// Where curves stand: the key before a time and whether they wait there.
struct Place {
    std::size_t key = 0;
    bool waits = true;
};
Place place_in(const Curve& curve, double t)
{
    Place out;
    for (std::size_t i = 0; i < curve.time_s.size() && curve.time_s[i] <= t; ++i)
        out = {i, i + 1 == curve.time_s.size() || curve.interpolation == Curve::Interpolation::step};
    return out;
}

// What spherical interpolation between two keys knows before there is a time: the ends as unit quaternions, on the same
// side, and the angle between them.
struct Arc {
    bool parallel = true;
    Quad from, to;
    Interval angle, sine;
};
Arc arc_between(const std::array<double, 4>& first, const std::array<double, 4>& second)
{
    const LongQuad from{Real(first[0]), Real(first[1]), Real(first[2]), Real(first[3])},
        to{Real(second[0]), Real(second[1]), Real(second[2]), Real(second[3])};
    auto unit = [](const LongQuad& q) {
        const Real size = sqrt(dot(q, q));
        return LongQuad{q[0] / size, q[1] / size, q[2] / size, q[3] / size};
    };
    Arc out;
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < i; ++j) // products of doubles are exact at 256 bits
            out.parallel = out.parallel && from[i] * to[j] == from[j] * to[i];
    out.from = exactly(first);
    if (out.parallel)
        return out;
    const LongQuad a = unit(from);
    LongQuad b = unit(to);
    const Real stored = dot(from, to); // exact too, unless exponents are far apart
    if (mp::upper(stored) < 0)
        for (Real& x : b)
            x = -x;
    else if (mp::lower(stored) < 0)
        throw InputError("two rotations half a turn apart cannot be told from their neighbours; nothing is proven");
    const Real angle = acos(mp::intersect(dot(a, b), mp::hull(Real(-1), Real(1))));
    out.from = interval_of(a);
    out.to = interval_of(b);
    out.angle = interval_of(angle);
    out.sine = interval_of(sin(angle));
    return out;
}

// A place on it, and its derivative.
WithSlope<Quad> spherical(const Arc& arc, const Interval& s, const Interval& length_s)
{
    if (arc.parallel)
        return WithSlope<Quad>(arc.from);
    const Interval rate = arc.angle / arc.sine / length_s;
    const SinCos gone = sin_cos(s * arc.angle), left = sin_cos((1 - s) * arc.angle);
    return {combined(left.sin / arc.sine, arc.from, gone.sin / arc.sine, arc.to),
            combined(-left.cos * rate, arc.from, gone.cos * rate, arc.to)};
}

// A curve on an interval of time.
WithSlope<Quad> evaluate(const Curve& curve, const std::vector<Arc>& arcs, const Interval& t, double piece_middle)
{
    const bool cubic = curve.interpolation == Curve::Interpolation::cubic_spline;
    const Place place = place_in(curve, piece_middle);
    auto value = [&](std::size_t key) { return exactly(curve.value[cubic ? 3 * key + 1 : key]); };
    const Quad from = value(place.key);
    if (place.waits || curve.time_s.front() > piece_middle)
        return WithSlope<Quad>(from);
    const Quad to = value(place.key + 1);
    const Interval length = Interval(curve.time_s[place.key + 1]) - Interval(curve.time_s[place.key]),
                   s = (t - Interval(curve.time_s[place.key])) / length;
    if (cubic) { // Hermite's basis
        const Quad out = exactly(curve.value[3 * place.key + 2]), in = exactly(curve.value[3 * place.key + 3]);
        const Interval rest = 1 - s;
        const Quad ends = combined((1 + 2 * s) * rest * rest, from, s * s * (3 - 2 * s), to),
                   tangents = combined(length * s * rest * rest, out, -length * s * s * rest, in);
        const Quad ends_slope = combined(-6 * s * rest / length, from, 6 * s * rest / length, to),
                   tangents_slope = combined((1 - 3 * s) * rest, out, s * (3 * s - 2), in);
        return {combined(Interval(1), ends, 1, tangents), combined(Interval(1), ends_slope, 1, tangents_slope)};
    }
    if (curve.target == Curve::Target::rotation)
        return spherical(arcs[place.key], s, length);
    return {combined(1 - s, from, s, to), combined(-1 / length, from, 1 / length, to)};
}

// 2 × the symmetric bilinear form of q ↦ |q|² R(q).
std::array<std::array<Interval, 3>, 3> bilinear(const Quad& a, const Quad& b)
{
    auto s = [&](std::size_t i, std::size_t j) { return Interval(a[i] * b[j] + a[j] * b[i]); };
    const Interval xx = s(0, 0), yy = s(1, 1), zz = s(2, 2), ww = s(3, 3); // each 2 a_i b_i
    return {{{ww + xx - yy - zz, 2 * (s(0, 1) - s(2, 3)), 2 * (s(0, 2) + s(1, 3))},
             {2 * (s(0, 1) + s(2, 3)), ww - xx + yy - zz, 2 * (s(1, 2) - s(0, 3))},
             {2 * (s(0, 2) - s(1, 3)), 2 * (s(1, 2) + s(0, 3)), ww - xx - yy + zz}}};
}

struct State {
    WithSlope<Quad> translation, rotation, scale;
};

State state_of(const Bone& bone)
{
    State out;
    for (std::size_t n = 0; n < 3; ++n) {
        out.translation.value[n] = bone.translation[n];
        out.scale.value[n] = bone.scale[n];
    }
    const auto& q = bone.rotation; // scaled exactly: the square of a tiny number would be none
    const double most = std::max({std::abs(q[0]), std::abs(q[1]), std::abs(q[2]), std::abs(q[3])});
    for (std::size_t n = 0; n < 4; ++n)
        out.rotation.value[n] = most > 0 ? std::ldexp(q[n], -std::ilogb(most)) : 0;
    return out;
}

WithSlope<Rows> local(const Bone& bone, const State& state, bool moves)
{
    WithSlope<Rows> out;
    if (bone.is_matrix && !moves) {
        for (std::size_t r = 0; r < 3; ++r)
            for (std::size_t c = 0; c < 4; ++c)
                out.value[r][c] = bone.matrix[4 * c + r];
        return out;
    }
    const Quad &q = state.rotation.value, &dq = state.rotation.slope;
    const Interval square = dot(q, q), square_slope = 2 * dot(q, dq);
    const auto h = bilinear(q, q), dh = bilinear(q, dq);
    const bool none = square.sup() == 0; // no rotation at all
    for (std::size_t r = 0; r < 3; ++r) {
        for (std::size_t c = 0; c < 3; ++c) {
            const Interval turn = none ? Interval(r == c ? 1 : 0) : Interval(h[r][c] / 2 / square);
            const Interval turning = none ? Interval(0) : Interval((dh[r][c] - square_slope * turn) / square);
            out.value[r][c] = turn * state.scale.value[c];
            out.slope[r][c] = turning * state.scale.value[c] + turn * state.scale.slope[c];
        }
        out.value[r][3] = state.translation.value[r];
        out.slope[r][3] = state.translation.slope[r];
    }
    return out;
}

// x y, with y's last row (0 0 0 `last`). Needs DirectedRounding.
Rows times(const Rows& x, const Rows& y, bool last)
{
    Rows out;
    for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 4; ++c) {
            out[r][c] = c == 3 && last ? x[r][3] : Interval(0);
            for (std::size_t k = 0; k < 3; ++k)
                out[r][c] += x[r][k] * y[k][c];
        }
    return out;
}

Rows sum(const Rows& x, const Rows& y)
{
    Rows out;
    for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 4; ++c)
            out[r][c] = x[r][c] + y[r][c];
    return out;
}

Enclosure enclosure_of(const Interval& x) // an overflow leaves no interval
{
    return x.inf() <= x.sup() ? Enclosure{x.inf(), x.sup()} : Enclosure{-HUGE_VAL, HUGE_VAL};
}

MapEnclosure enclosure_of(const Rows& m)
{
    MapEnclosure out;
    for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 4; ++c)
            out.m[r][c] = enclosure_of(m[r][c]);
    return out;
}

// Four weights of a curve as a curve of their own; what is past its last one is 0.
Curve four_of(const WeightCurve& curve, std::size_t first)
{
    Curve out{0, Curve::Target::translation, curve.interpolation, curve.time_s, {}};
    for (std::size_t i = first; i < curve.value.size(); i += curve.count)
        for (std::size_t n = 0; n < 4; ++n) {
            if (n == 0)
                out.value.emplace_back();
            out.value.back()[n] = first + n < curve.count ? curve.value[i + n] : 0;
        }
    return out;
}

} // namespace

MapEnclosure bone_enclosure(const Bone& bone)
{
    const DirectedRounding rounding;
    return enclosure_of(local(bone, state_of(bone), false).value);
}

struct ClipEnclosure::Parts {
    std::vector<Bone> bones;
    std::vector<Joint> joints;
    std::vector<Curve> curves;
    std::vector<std::vector<Arc>> arcs; // between the keys of each curve, where they are that
    std::vector<double> keys;
    std::vector<WithSlope<Rows>> still; // bones as the file has them
    std::vector<Enclosure> weights;     // of morph targets, where no curve moves them
    std::vector<WeightCurve> weight_curves;
    bool any_weights;
};

ClipEnclosure::ClipEnclosure(const Character& character, const Character::Animation& animation,
                             std::optional<Enclosure> any_weights)
    : parts_(new Parts{character.bones,
                       character.joints,
                       animation.curves,
                       {},
                       {},
                       {},
                       {},
                       animation.morphs,
                       any_weights.has_value()})
{
    for (const double weight : character.target_weights)
        parts_->weights.push_back(any_weights.value_or(Enclosure{weight, weight}));
    if (any_weights)
        parts_->weight_curves.clear();
    const DirectedRounding rounding;
    for (const Curve& curve : parts_->curves) {
        std::vector<Arc>& arcs = parts_->arcs.emplace_back();
        if (curve.target == Curve::Target::rotation && curve.interpolation == Curve::Interpolation::linear)
            for (std::size_t i = 1; i < curve.value.size(); ++i)
                arcs.push_back(arc_between(curve.value[i - 1], curve.value[i]));
    }
    for (const Bone& bone : parts_->bones)
        parts_->still.push_back(local(bone, state_of(bone), false));
    std::set<double> keys;
    for (const Curve& curve : animation.curves)
        keys.insert(curve.time_s.begin(), curve.time_s.end());
    for (const WeightCurve& curve : parts_->weight_curves)
        keys.insert(curve.time_s.begin(), curve.time_s.end());
    parts_->keys.assign(keys.begin(), keys.end());
}

ClipEnclosure::~ClipEnclosure() = default;

bool ClipEnclosure::has_any_weights() const { return parts_->any_weights; }

const std::vector<double>& ClipEnclosure::keys() const { return parts_->keys; }

void ClipEnclosure::weights_at(double a_s, double b_s, double piece_a_s, double piece_b_s,
                               std::vector<Enclosure>& weights, std::vector<Enclosure>& slopes) const
{
    const DirectedRounding rounding;
    weights = parts_->weights;
    slopes.assign(weights.size(), Enclosure{});
    for (const WeightCurve& curve : parts_->weight_curves)
        for (std::size_t first = 0; first < curve.count; first += 4) {
            const WithSlope<Quad> four =
                evaluate(four_of(curve, first), {}, Interval(a_s, b_s), piece_a_s + (piece_b_s - piece_a_s) / 2);
            for (std::size_t n = 0; n < 4 && first + n < curve.count; ++n) {
                weights[curve.first_target + first + n] = enclosure_of(four.value[n]);
                slopes[curve.first_target + first + n] = enclosure_of(four.slope[n]);
            }
        }
}

void ClipEnclosure::at(double a_s, double b_s, double piece_a_s, double piece_b_s, std::vector<MapEnclosure>& maps,
                       std::vector<MapEnclosure>& slopes) const
{
    const DirectedRounding rounding; // MPFR rounds for itself
    const Interval t(a_s, b_s);
    const double middle = piece_a_s + (piece_b_s - piece_a_s) / 2;
    const std::size_t count = parts_->bones.size();
    std::vector<State> states(count);
    std::vector<char> moves(count);
    for (std::size_t i = 0; i < parts_->curves.size(); ++i) {
        const Curve& curve = parts_->curves[i];
        State& state = states[curve.bone];
        if (!moves[curve.bone])
            state = state_of(parts_->bones[curve.bone]);
        moves[curve.bone] = true;
        (curve.target == Curve::Target::translation ? state.translation
         : curve.target == Curve::Target::rotation  ? state.rotation
                                                    : state.scale) = evaluate(curve, parts_->arcs[i], t, middle);
    }
    std::vector<WithSlope<Rows>> world(count);
    for (std::size_t i = 0; i < count; ++i) {
        const Bone& bone = parts_->bones[i];
        world[i] = moves[i] ? local(bone, states[i], true) : parts_->still[i];
        if (bone.parent < 0)
            continue;
        const WithSlope<Rows> own = world[i], &above = world[static_cast<std::size_t>(bone.parent)];
        world[i] = {times(above.value, own.value, true),
                    sum(times(above.slope, own.value, true), times(above.value, own.slope, false))};
    }
    maps.clear();
    slopes.clear();
    for (const Joint& joint : parts_->joints) {
        Rows bind;
        for (std::size_t r = 0; r < 3; ++r)
            for (std::size_t c = 0; c < 4; ++c)
                bind[r][c] = Interval(joint.inverse_bind.m[r][c]);
        const WithSlope<Rows>& bone = world[joint.bone];
        maps.push_back(enclosure_of(times(bone.value, bind, true)));
        slopes.push_back(enclosure_of(times(bone.slope, bind, true)));
    }
}

} // namespace cinch::exact
