// SPDX-License-Identifier: Apache-2.0
#include "toolkit/time/weight_path.hpp"

namespace cinch {

WeightPath::WeightPath(const std::vector<double>& still, const std::vector<WeightCurve>& curves, double middle_s,
                       std::optional<double> end_s)
{
    path_.reserve(still.size());
    for (const double weight : still)
        path_.push_back({0, 0, Polynomial<1>{std::array<double, 1>{weight}}});
    for (const WeightCurve& curve : curves) {
        const CurvePiece piece =
            piece_of(curve.time_s, curve.interpolation,
                     end_s ? end_of(curve.time_s, curve.interpolation, middle_s, *end_s) : middle_s);
        const double key_s = curve.time_s[piece.key],
                     length_s = piece.constant ? 0 : curve.time_s[piece.key + 1] - key_s;
        for (std::size_t i = 0; i < curve.count; ++i)
            path_[curve.first_target + i] = {
                key_s, length_s, polynomial_of<1>(curve.time_s, curve.interpolation, piece, [&](std::size_t value) {
                    return std::array{curve.value[value * curve.count + i]};
                })};
    }
}

std::vector<double> WeightPath::at(std::size_t k, double t_s) const
{
    std::vector<double> out;
    out.reserve(path_.size());
    for (const Since<Polynomial<1>>& of : path_)
        out.push_back(of.path.derivative(k, t_s - of.key_s)[0]);
    return out;
}

std::vector<WeightPath::Limits> WeightPath::over(double a_s, double b_s) const
{
    std::vector<Limits> out(path_.size());
    for (std::size_t i = 0; i < path_.size(); ++i)
        suprema(
            path_[i], a_s, b_s, [](const Polynomial<1>& p) { return p.greatest_norm(); }, out[i].sup, out[i].magnitude);
    return out;
}

} // namespace cinch
