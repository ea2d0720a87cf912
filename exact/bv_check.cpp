// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/bv_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "exact/optimum.hpp"

namespace cinch::exact {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

bool at_most(const Exact& value, double bound) { return value <= Exact(bound); } // a finite bound

std::string gap(const Exact& value, double bound)
{
    return "exceeds the bound by " + as_fraction(value - Exact(bound));
}

} // namespace

void BvCheck::check(std::size_t bv, std::span<const std::uint32_t> vertices, std::span<const double> supports,
                    FrameVerdict& out, BlockResult& block)
{
    out_ = &out;
    block_ = &block;
    bv_ = bv;
    rest_ = frame_.bvh.rest(bv);
    vertices_ = vertices;
    box_is_finite_ =
        std::isfinite(rest_.box.half[0]) && std::isfinite(rest_.box.half[1]) && std::isfinite(rest_.box.half[2]);
    for (std::size_t j = 0; j < rest_.node.size(); ++j)
        if (rest_.node[j] < place_.size()) // else rest_data is set
            place_[rest_.node[j]] = j;
    if (std::all_of(supports.begin(), supports.end(), [](double bound) { return bound == infinity; })) {
        block.decided_by_filter += supports.size(); // contains everything, what overflows included
        return;
    }
    const std::size_t first = bv * 2 * frame_.axes.size();
    displaced_ = std::any_of(vertices.begin(), vertices.end(), [this](std::size_t v) { return frame_.displaced(v); });
    const bool rest_holds = frame_.methods != Method::vertices && !displaced_ && !(out.failed[first] & rest_data);
    BvReport& report = out.bvs[bv];
    double true_half[3] = {0, 0, 0}, bound_half[3] = {0, 0, 0};
    for (axis_ = 0; axis_ < frame_.axes.size(); ++axis_) {
        if (rest_holds && box_is_finite_)
            enclose_extrema();
        double true_width = 0, bound_width = 0;
        for (const bool against : {false, true}) {
            against_ = against;
            slot_ = first + 2 * axis_ + against;
            bound_ = supports[2 * axis_ + against];
            const Interval support = true_support();
            check_direction(support, rest_holds, report.loss);
            true_width += 0.5 * middle(support);
            bound_width += 0.5 * bound_;
        }
        if (axis_ < 3) {
            true_half[axis_] = true_width;
            bound_half[axis_] = bound_width;
        }
    }
    report.true_radius = std::hypot(true_half[0], true_half[1], true_half[2]);
    report.bound_radius = std::hypot(bound_half[0], bound_half[1], bound_half[2]);
}

void BvCheck::check_direction(const Interval& support, bool rest_holds, Loss& loss)
{
    const bool has_weight_space = rest_holds && weight_space_;
    if (!(bound_ > -infinity)) { // NaN proves nothing
        for (const Statement statement : {exact_vertices, computed_vertices, weight_space})
            if (statement != weight_space || has_weight_space)
                fail(statement, "the bound is not a number above minus infinity");
        return;
    }
    exact_used_ = false;
    if (bound_ == infinity) {
        ++block_->decided_by_filter; // contains everything, what overflows included
        return;
    }
    check_exact_vertices(support);
    check_computed_vertices();
    if (has_weight_space)
        check_weight_space();
    else if (rest_holds && box_is_finite_)
        optimum_ = dual_value(rest_.space, extrema(), Interval(greedy_lambda()));
    block_->decided_by_filter += !exact_used_;
    if (!rest_holds)
        (displaced_ ? loss.corner : loss.rounding) += scale() * (bound_ - middle(support));
    else if (box_is_finite_)
        attribute(support, loss);
}

void BvCheck::fail(Statement statement, std::string detail)
{
    out_->failed[slot_] = static_cast<std::uint8_t>(out_->failed[slot_] | statement);
    block_->violations.push_back({bv_, static_cast<int>(2 * axis_ + against_), statement, std::move(detail)});
}

void BvCheck::enclose_extrema()
{
    plus_.clear();
    minus_.clear();
    if (!boxes_)
        return own_extrema(plus_, minus_);
    for (std::uint32_t node : rest_.node) {
        const auto both = extremum<Interval>(rest_.box.centre, rest_.box.half, frame_.maps[node], axis());
        plus_.push_back(both.plus);
        minus_.push_back(both.minus);
    }
}

// Of each simulation node over the vertices that it influences.
template <class N> void BvCheck::own_extrema(std::vector<N>& plus, std::vector<N>& minus) const
{
    std::vector<Column<N>> column;
    for (std::uint32_t node : rest_.node)
        column.push_back(column_of<N>(frame_.maps[node], axis()));
    plus.assign(rest_.node.size(), N(0));
    minus.assign(rest_.node.size(), N(0));
    std::vector<bool> seen(rest_.node.size(), false);
    for (std::uint32_t k : vertices_)
        for (std::uint32_t node : frame_.surface.weights.of(k).node) {
            const std::size_t j = place_[node];
            const N image = image_along(column[j], frame_.surface.mesh.vertices[k]);
            plus[j] = seen[j] ? maximum(plus[j], image) : image;
            minus[j] = seen[j] ? maximum(minus[j], -image) : -image;
            seen[j] = true;
        }
}

std::vector<Exact> BvCheck::exact_extrema() const
{
    std::vector<Exact> plus, minus;
    if (boxes_)
        for (std::uint32_t node : rest_.node) {
            const auto both = extremum<Exact>(rest_.box.centre, rest_.box.half, frame_.maps[node], axis());
            plus.push_back(both.plus);
            minus.push_back(both.minus);
        }
    else
        own_extrema(plus, minus);
    return against_ ? minus : plus;
}

Interval BvCheck::true_support() const
{
    Interval support = along(frame_.exact_vertices[vertices_[0]], axis(), against_);
    for (std::uint32_t k : vertices_.subspan(1))
        support = maximum(support, along(frame_.exact_vertices[k], axis(), against_));
    return support;
}

void BvCheck::check_exact_vertices(const Interval& support)
{
    if (support.sup() <= bound_)
        return;
    for (std::uint32_t k : vertices_) {
        if (along(frame_.exact_vertices[k], axis(), against_).sup() <= bound_)
            continue;
        exact_used_ = true;
        const Exact value =
            along(deformed(frame_.rest<Exact>(k), frame_.surface.weights.of(k), frame_.maps), axis(), against_);
        if (!at_most(value, bound_))
            return fail(exact_vertices, "exact vertex " + std::to_string(k) + " " + gap(value, bound_));
    }
}

void BvCheck::check_computed_vertices()
{
    for (std::uint32_t k : vertices_) {
        Vec3 v = frame_.computed_vertices[k];
        for (int r = 0; r < 3; ++r) {
            if (axis()[static_cast<std::size_t>(r)] == 0)
                v[r] = 0;                  // of no concern here, whatever it is
            else if (!std::isfinite(v[r])) // only an infinite bound would do
                return fail(computed_vertices, "computed vertex " + std::to_string(k) + " is not finite");
        }
        if (along(as_point<Interval>(v), axis(), against_).sup() <= bound_)
            continue;
        exact_used_ = true;
        const Exact value = along(as_point<Exact>(v), axis(), against_);
        if (!at_most(value, bound_))
            return fail(computed_vertices, "computed vertex " + std::to_string(k) + " " + gap(value, bound_));
    }
}

void BvCheck::check_weight_space()
{
    if (!box_is_finite_)
        return fail(weight_space, "the rest box is infinite, the bound is not");
    // Any λ gives a certificate; a greedy fill of the enclosures' middles finds one without a gap, or nearly.
    const double lambda = greedy_lambda();
    optimum_ = dual_value(rest_.space, extrema(), Interval(lambda));
    if (boxes_)
        out_->lambda[slot_] = lambda;
    if (optimum_.sup() <= bound_)
        return;
    exact_used_ = true;
    const std::vector<Exact> b = exact_extrema();
    const auto best = optimum(rest_.space, b);
    if (best && !at_most(best->value, bound_))
        fail(weight_space, "the maximum over the weight space " + gap(best->value, bound_));
    else if (best && boxes_ && !at_most(dual_value(rest_.space, b, Exact(lambda)), bound_))
        block_->exact_lambda.emplace(slot_, as_fraction(best->lambda));
}

double BvCheck::greedy_lambda()
{
    const auto& b = extrema();
    order_.resize(b.size());
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    auto key = [&](std::size_t i) { // finite, so that the order is strict and λ a number, whatever overflowed
        const double m = middle(b[i]);
        return m > -infinity && m < infinity ? m : 0.0;
    };
    std::sort(order_.begin(), order_.end(), [&](std::size_t i, std::size_t j) { return key(i) > key(j); });
    double slack = 1;
    for (double l : rest_.space.l)
        slack -= l;
    for (std::size_t j : order_) {
        slack -= rest_.space.h[j] - rest_.space.l[j];
        if (slack <= 0)
            return key(j);
    }
    return key(order_.back());
}

// The exact value that the method's formula has, rounding aside; the bound itself for methods without one over these
// extrema.
Interval BvCheck::method_value() const
{
    const auto& b = extrema();
    if (!boxes_)
        return Interval(bound_);
    if (frame_.methods.contains(Method::limited))
        return optimum_;
    if (frame_.methods == Method::corners)
        return best_corner(rest_.space, b);
    if (!frame_.methods.contains(Method::eq12))
        return std::accumulate(b.begin(), b.end(), b[0],
                               [](const Interval& x, const Interval& y) { return maximum(x, y); });
    if (b.size() == 1)
        return b[0];
    Interval first = maximum(b[0], b[1]), second = minimum(b[0], b[1]);
    for (std::size_t j = 2; j < b.size(); ++j) {
        second = maximum(second, minimum(first, b[j]));
        first = maximum(first, b[j]);
    }
    return dual_value(rest_.space, b, second);
}

Interval BvCheck::boxes_at_actual_weights() const
{
    const auto& b = extrema();
    auto at_weights_of = [&](std::uint32_t k) {
        const Weights::Row row = frame_.surface.weights.of(k);
        Interval sum(0);
        for (std::size_t i = 0; i < row.node.size(); ++i)
            sum = sum + Interval(row.weight[i]) * b[place_[row.node[i]]];
        return sum;
    };
    Interval most = at_weights_of(vertices_[0]);
    for (std::uint32_t k : vertices_.subspan(1))
        most = maximum(most, at_weights_of(k));
    return most;
}

// Of a direction in the mean over all, with the axis scaled to unit length.
double BvCheck::scale() const
{
    const int components = std::abs(axis()[0]) + std::abs(axis()[1]) + std::abs(axis()[2]);
    return 1 / (std::sqrt(components) * static_cast<double>(2 * frame_.axes.size()));
}

void BvCheck::attribute(const Interval& support, Loss& loss) const
{
    const double boxes = middle(boxes_at_actual_weights()), best = middle(optimum_), value = middle(method_value());
    loss.box += scale() * (boxes - middle(support));
    loss.interval += scale() * (best - boxes);
    loss.corner += scale() * (value - best);
    loss.rounding += scale() * (bound_ - value);
}

} // namespace cinch::exact
