// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/verifier.hpp"

#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include <tbb/parallel_for.h>

#include "exact/formulas.hpp"
#include "exact/optimum.hpp"
#include "exact/rest_data.hpp"
#include "toolkit/deform/evaluate.hpp"

namespace cinch::exact {
namespace {

using Range = tbb::blocked_range<std::size_t>;
constexpr double infinity = std::numeric_limits<double>::infinity();

bool at_most(const Exact& value, double bound) { return bound == infinity || value <= Exact(bound); }

std::string gap(const Exact& value, double bound) { return "exceeds the bound by " + as_fraction(value - Exact(bound)); }

/// All that one frame shares between BVs.
struct Frame {
    const DeformableSurface& surface;
    const Bvh& bvh;
    std::span<const AffineMap> maps;
    Method method;
    std::span<const Axis> axes;
    std::vector<Point<Interval>> exact_vertices; // enclosures
    std::vector<Vec3> computed_vertices;
};

/// Proves the bounds of single BVs; one per task, for its scratch memory. Lives under DirectedRounding.
class BvCheck {
public:
    explicit BvCheck(const Frame& frame) : frame_(frame), place_(frame.surface.weights.node_count) {}

    // failed: one mask per direction, rest_data already set where it applies. Returns how many the filter decided.
    std::size_t check(std::size_t bv, std::span<const std::uint32_t> vertices, std::span<const double> supports,
                      std::span<std::uint8_t> failed, BvReport& report, std::vector<Violation>& violations)
    {
        bv_ = bv;
        rest_ = frame_.bvh.rest(bv);
        vertices_ = vertices;
        for (std::size_t j = 0; j < rest_.node.size(); ++j)
            place_[rest_.node[j]] = j;
        const bool has_weight_space = frame_.method != Method::vertices && !(failed[0] & rest_data);
        std::size_t filtered = 0;
        double true_square = 0, bound_square = 0;
        for (std::size_t a = 0; a < frame_.axes.size(); ++a) {
            if (has_weight_space)
                enclose_extrema(frame_.axes[a]);
            double true_width = 0, bound_width = 0;
            for (std::size_t side = 0; side < 2; ++side) {
                axis_ = a;
                against_ = side == 1;
                bound_ = supports[2 * a + side];
                exact_used_ = false;
                std::uint8_t& mask = failed[2 * a + side];
                const Interval support = true_support();
                if (!(bound_ > -infinity)) { // NaN proves nothing
                    for (const Statement statement : {exact_vertices, computed_vertices, weight_space})
                        if (statement != weight_space || has_weight_space)
                            fail(mask, statement, "the bound is not a number above minus infinity", violations);
                    continue;
                }
                check_exact_vertices(support, mask, violations);
                check_computed_vertices(mask, violations);
                if (has_weight_space)
                    check_weight_space(mask, violations);
                filtered += !exact_used_;
                attribute(support, has_weight_space, report.loss);
                true_width += middle(support);
                bound_width += bound_;
            }
            if (a < 3) {
                true_square += true_width * true_width / 4;
                bound_square += bound_width * bound_width / 4;
            }
        }
        report.true_radius = std::sqrt(true_square);
        report.bound_radius = std::sqrt(bound_square);
        return filtered;
    }

private:
    const Axis& axis() const { return frame_.axes[axis_]; }

    void fail(std::uint8_t& mask, Statement statement, std::string detail, std::vector<Violation>& violations)
    {
        mask = static_cast<std::uint8_t>(mask | statement);
        violations.push_back({bv_, static_cast<int>(2 * axis_ + against_), statement, std::move(detail)});
    }

    void enclose_extrema(const Axis& axis)
    {
        plus_.clear();
        minus_.clear();
        for (std::uint32_t node : rest_.node) {
            const auto both = extremum<Interval>(rest_.centre, rest_.half, frame_.maps[node], axis);
            plus_.push_back(both.plus);
            minus_.push_back(both.minus);
        }
    }
    const std::vector<Interval>& extrema() const { return against_ ? minus_ : plus_; }

    Interval true_support() const
    {
        Interval support = along(frame_.exact_vertices[vertices_[0]], axis(), against_);
        for (std::uint32_t k : vertices_.subspan(1))
            support = maximum(support, along(frame_.exact_vertices[k], axis(), against_));
        return support;
    }

    void check_exact_vertices(const Interval& support, std::uint8_t& mask, std::vector<Violation>& violations)
    {
        if (support.sup() <= bound_)
            return;
        for (std::uint32_t k : vertices_) {
            if (along(frame_.exact_vertices[k], axis(), against_).sup() <= bound_)
                continue;
            exact_used_ = true;
            const Exact value = along(deformed<Exact>(frame_.surface.mesh.vertices[k], frame_.surface.weights.of(k), frame_.maps), axis(), against_);
            if (!at_most(value, bound_))
                return fail(mask, exact_vertices, "exact vertex " + std::to_string(k) + " " + gap(value, bound_), violations);
        }
    }

    void check_computed_vertices(std::uint8_t& mask, std::vector<Violation>& violations)
    {
        for (std::uint32_t k : vertices_) {
            const Vec3& v = frame_.computed_vertices[k];
            if (along(as_point<Interval>(v), axis(), against_).sup() <= bound_)
                continue;
            exact_used_ = true;
            const Exact value = along(as_point<Exact>(v), axis(), against_);
            if (!at_most(value, bound_))
                return fail(mask, computed_vertices, "computed vertex " + std::to_string(k) + " " + gap(value, bound_), violations);
        }
    }

    void check_weight_space(std::uint8_t& mask, std::vector<Violation>& violations)
    {
        // Any λ gives a certificate; a greedy fill of the enclosures' middles finds one without a gap, or nearly.
        lambda_ = greedy_lambda();
        optimum_ = dual_value(rest_.space, extrema(), Interval(lambda_));
        if (optimum_.sup() <= bound_)
            return;
        exact_used_ = true;
        std::vector<Exact> b;
        for (std::uint32_t node : rest_.node) {
            const auto both = extremum<Exact>(rest_.centre, rest_.half, frame_.maps[node], axis());
            b.push_back(against_ ? both.minus : both.plus);
        }
        const auto best = optimum(rest_.space, b);
        if (best && !at_most(best->value, bound_))
            fail(mask, weight_space, "the maximum over the weight space " + gap(best->value, bound_), violations);
    }

    double greedy_lambda()
    {
        const auto& b = extrema();
        order_.resize(b.size());
        std::iota(order_.begin(), order_.end(), std::size_t{0});
        std::sort(order_.begin(), order_.end(), [&](std::size_t i, std::size_t j) { return middle(b[i]) > middle(b[j]); });
        double slack = 1;
        for (double l : rest_.space.l)
            slack -= l;
        for (std::size_t j : order_) {
            slack -= rest_.space.h[j] - rest_.space.l[j];
            if (slack <= 0)
                return middle(b[j]);
        }
        return middle(b[order_.back()]);
    }

    // The exact value that the method's formula has, rounding aside.
    Interval method_value() const
    {
        const auto& b = extrema();
        switch (frame_.method) {
        case Method::limited: return optimum_;
        case Method::convex: return std::accumulate(b.begin(), b.end(), b[0], [](const Interval& x, const Interval& y) { return maximum(x, y); });
        default: break;
        }
        if (b.size() == 1)
            return b[0];
        Interval first = maximum(b[0], b[1]), second = minimum(b[0], b[1]);
        for (std::size_t j = 2; j < b.size(); ++j) {
            second = maximum(second, minimum(first, b[j]));
            first = maximum(first, b[j]);
        }
        return dual_value(rest_.space, b, second);
    }

    Interval boxes_at_actual_weights() const
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

    void attribute(const Interval& support, bool has_weight_space, Loss& loss) const
    {
        if (!(bound_ < infinity))
            return;
        const int components = std::abs(axis()[0]) + std::abs(axis()[1]) + std::abs(axis()[2]);
        const double scale = 1 / (std::sqrt(components) * static_cast<double>(2 * frame_.axes.size()));
        if (!has_weight_space) {
            loss.rounding += scale * (bound_ - middle(support));
            return;
        }
        const double boxes = middle(boxes_at_actual_weights()), best = middle(optimum_), value = middle(method_value());
        loss.box += scale * (boxes - middle(support));
        loss.interval += scale * (best - boxes);
        loss.corner += scale * (value - best);
        loss.rounding += scale * (bound_ - value);
    }

    const Frame& frame_;
    std::vector<std::size_t> place_; // of a simulation node in rest_.node; valid for nodes of the BV
    std::size_t bv_ = 0, axis_ = 0;
    bool against_ = false, exact_used_ = false;
    double bound_ = 0, lambda_ = 0;
    RestBv rest_;
    std::span<const std::uint32_t> vertices_;
    std::vector<Interval> plus_, minus_;
    Interval optimum_;
    std::vector<std::size_t> order_;
};

} // namespace

std::string name_of(Statement statement)
{
    switch (statement) {
    case rest_data: return "rest data";
    case weight_space: return "weight space";
    case exact_vertices: return "exact vertices";
    case computed_vertices: return "computed vertices";
    }
    return "unknown";
}

Verifier::Verifier(const DeformableSurface& surface, const Bvh& bvh) : surface_(surface), bvh_(bvh)
{
    require_dyadic_weights(surface);
    require_tree(surface, bvh);
    vertices_.resize(bvh.bvs.size());
    faults_.resize(bvh.bvs.size());
    tbb::parallel_for(Range(0, bvh.bvs.size(), 64), [&](const Range& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
            vertices_[i] = vertices_of(surface, bvh, i);
            faults_[i] = rest_data_fault(surface, bvh, i, vertices_[i]);
        }
    });
}

FrameVerdict Verifier::check(std::span<const AffineMap> maps, Method method, int kdop, std::span<const double> supports) const
{
    const auto k = static_cast<std::size_t>(kdop);
    if (!is_kdop(kdop) || maps.size() != surface_.weights.node_count || supports.size() != bvh_.bvs.size() * k)
        throw std::invalid_argument("Verifier::check: sizes do not fit");
    for (const AffineMap& map : maps)
        for (const auto& row : map.m)
            for (double x : row)
                if (!std::isfinite(x))
                    throw std::invalid_argument("Verifier::check: a transform is not finite; there is no exact position to compare with");

    const std::size_t vertex_count = surface_.mesh.vertices.size();
    Frame frame{surface_, bvh_, maps, method, axes_of(kdop), {}, {}};
    frame.computed_vertices.resize(vertex_count);
    evaluate(surface_.mesh.vertices, surface_.weights, maps, frame.computed_vertices);
    frame.exact_vertices.resize(vertex_count);
    tbb::parallel_for(Range(0, vertex_count, 512), [&](const Range& range) {
        const DirectedRounding upward;
        for (std::size_t v = range.begin(); v < range.end(); ++v)
            frame.exact_vertices[v] = deformed<Interval>(surface_.mesh.vertices[v], surface_.weights.of(v), maps);
    });

    FrameVerdict out;
    out.failed.assign(supports.size(), 0);
    out.bvs.resize(bvh_.bvs.size());
    constexpr std::size_t block = 64;
    const std::size_t blocks = (bvh_.bvs.size() + block - 1) / block;
    std::vector<std::size_t> filtered(blocks, 0);
    std::vector<std::vector<Violation>> violations(blocks);
    tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t b) {
        const DirectedRounding upward;
        BvCheck check(frame);
        for (std::size_t i = b * block; i < std::min(bvh_.bvs.size(), (b + 1) * block); ++i) {
            const auto failed = std::span(out.failed).subspan(i * k, k);
            if (!faults_[i].empty()) {
                std::fill(failed.begin(), failed.end(), rest_data);
                violations[b].push_back({i, -1, rest_data, faults_[i]});
            }
            filtered[b] += check.check(i, vertices_[i], supports.subspan(i * k, k), failed, out.bvs[i], violations[b]);
        }
    });
    out.decided_by_filter = std::accumulate(filtered.begin(), filtered.end(), std::size_t{0});
    constexpr std::size_t most_examples = 10;
    for (const auto& list : violations)
        for (const Violation& violation : list)
            if (out.examples.size() < most_examples)
                out.examples.push_back(violation);
    return out;
}

} // namespace cinch::exact
