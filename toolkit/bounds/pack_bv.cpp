// SPDX-License-Identifier: Apache-2.0
#include "toolkit/bounds/pack_bv.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "toolkit/bounds/pack_moments.hpp"
#include "toolkit/bounds/pack_value.hpp"
#include "toolkit/deform/dyadic.hpp"

namespace cinch {
namespace {

// Packs one BV; `value` and `node` grow at their ends.
template <class T> class Packer {
public:
    Packer(std::span<const Vec3> x, const RestExtent& extent, PackedBvs<T>& out) : x_(x), extent_(extent), out_(out) {}

    void pack(const RestBv& rest, const BvChoice& choice)
    {
        const auto [kind, start, oriented, guarded, moments] = choice;
        if (out_.node.size() > std::numeric_limits<std::uint32_t>::max() - 8)
            throw std::length_error("pack: over 2^32 influences; use larger leaves");
        if (rest.node.size() > (sizeof(T) == 4 ? most_nodes_in_float : most_nodes_in_double))
            throw std::length_error(sizeof(T) == 4
                                        ? "pack: a BV has over 65,536 simulation nodes, too many for float; use double"
                                        : "pack: a BV has over 1,048,575 simulation nodes; use fewer");
        bv_ = {};
        bv_.kind = kind;
        bv_.start = static_cast<T>(start);
        bv_.guarded = guarded;
        bv_.count = static_cast<std::uint32_t>(rest.node.size());
        bv_.first_node = static_cast<std::uint32_t>(out_.node.size());
        bv_.first_value = out_.value.size();
        if (takes_one_by_one(kind)) {
            out_.node.insert(out_.node.end(), rest.node.begin(), rest.node.end());
        } else {
            order_octets_first(rest.node);
            for (std::uint32_t j : order_)
                out_.node.push_back(rest.node[j]);
            out_.node.resize(bv_.first_node + blocks_of(rest.node.size()) * block_lanes, out_.node.back());
        }
        put_box(rest.box, extent_.origin, bv_.centre, bv_.half);
        if (oriented && are_normal(*oriented)) // else the other box does
            put_oriented(*oriented);
        if (kind == Method::support || kind == Method::linear)
            put_points(rest);
        if (kind == Method::moments)
            pack_moments<T>(rest, *moments, rounded_means(rest), extent_, bv_, out_.value);
        else if (kind == Method::linear)
            put_models(rest);
        else if (kind == Method::support)
            put_reference(rest);
        else
            put_intervals(rest);
        out_.bvs.push_back(bv_);
    }

private:
    // The kernels read the maps of nodes 8i to 8i + 7 where they stand side by side (ProjectedMaps::octet), so these
    // come first.
    void order_octets_first(std::span<const std::uint32_t> node)
    {
        order_.clear();
        std::vector<std::uint32_t> others;
        for (std::size_t j = 0; j < node.size();) {
            std::size_t end = j;
            while (end < node.size() && node[end] / block_lanes == node[j] / block_lanes)
                ++end;
            auto& to = end - j == block_lanes ? order_ : others;
            for (; j < end; ++j)
                to.push_back(static_cast<std::uint32_t>(j));
        }
        order_.insert(order_.end(), others.begin(), others.end());
    }

    // Whether T holds every component of the axes to within u|a|, and so does the product with what it grows by: none
    // is subnormal, but it may be 0.
    static bool are_normal(const OrientedBox& box)
    {
        for (const Vec3& axis : box.axis)
            for (const double a : axis)
                if (a != 0 && !(std::abs(a) >= static_cast<double>(std::numeric_limits<T>::min())))
                    return false;
        return true;
    }

    // The centre's error d in the direction of an axis a is within Σ d_s of it, so a grows by that; a in T is off by
    // u|a| (rounding.hpp).
    void put_oriented(const OrientedBox& box)
    {
        bv_.oriented = true;
        double off = 0;
        for (int s = 0; s < 3; ++s) {
            const Shifted<T> c = shifted<T>(box.centre[s], extent_.origin[s]);
            bv_.centre[s] = c.value;
            off = sum_up(off, c.off);
        }
        for (int i = 0; i < 3; ++i) {
            const double length = box.axis[i].norm(),
                         grown = off == 0 ? 1 : succ(1 + succ(off / length) * (1 + 32 * unit_roundoff));
            for (int s = 0; s < 3; ++s)
                bv_.axis[i][s] = static_cast<T>(box.axis[i][s] * grown);
        }
    }

    // x − o = pivot + y + an error that goes to the slack.
    void put_points(const RestBv& rest)
    {
        for (int s = 0; s < 3; ++s) {
            const Shifted<T> z = shifted<T>(rest.pivot[s], extent_.origin[s]);
            bv_.pivot[s] = z.value;
            pivot_off_[s] = z.off;
        }
        bv_.points = static_cast<std::uint32_t>(rest.point.size());
        Vec3 off = Vec3::Zero();
        const std::size_t first = out_.value.size();
        out_.value.resize(first + 12 * quads_of(rest.point.size()));
        for (std::size_t i = 0; i < rest.point.size(); ++i)
            for (int s = 0; s < 3; ++s) {
                const double o = extent_.origin[s], x = x_[rest.point[i]][s] - o,
                             y = x - static_cast<double>(bv_.pivot[s]);
                const T packed = static_cast<T>(y);
                for (std::size_t p = i; p < (i + 1 == rest.point.size() ? 4 * quads_of(i + 1) : i + 1);
                     ++p) // the last one to the end of its block
                    out_.value[first + p / 4 * 12 + 4 * static_cast<std::size_t>(s) + p % 4] = packed;
                const double rounding = unit_roundoff * (std::abs(y) + (o == 0 ? 0 : std::abs(x)));
                off[s] = std::max(off[s], succ(std::abs(y - static_cast<double>(packed)) + succ(rounding)));
            }
        // Σ|q_s| off_s ≤ ‖q‖ Σ off_s; the factor is for the rounding of ‖q‖ and of the product: quotients, squares,
        // root and products, less than 6u.
        bv_.slack = round_up<T>(succ(succ(rest.slack + succ(succ(off[0] + off[1]) + off[2])) *
                                     (1 + 16 * static_cast<double>(unit_roundoff_of<T>))));
    }

    void put_intervals(const RestBv& rest)
    {
        Blocks blocks(*this, rest.node.size(), PackedBv<T>::rows(bv_.kind));
        for (std::size_t i = 0; i < rest.node.size(); ++i) {
            const std::size_t j = order_[i];
            T l, r;
            put_interval(rest.space.l[j], rest.space.h[j], l, r, bv_.sum_l, bv_.sum_r);
            blocks.put(i, 0, l, 0);
            blocks.put(i, 1, r, 0);
            if (bv_.kind != Method::local)
                continue;
            T box[6];
            put_box(rest.local[j], extent_.origin, box, box + 3);
            for (std::size_t s = 0; s < 6; ++s)
                blocks.put(i, 2 + s, box[s], box[s]);
            double radius = rest.radius[j]; // about the packed centre
            for (int s = 0; s < 3; ++s)
                radius = sum_up(radius, shifted<T>(rest.local[j].centre[s], extent_.origin[s]).off);
            // ν·radius is rounded once more.
            const T packed =
                round_up<T>(radius == 0 ? 0 : succ(radius * (1 + 4 * static_cast<double>(unit_roundoff_of<T>))));
            blocks.put(i, 8, packed, packed);
        }
    }

    void put_reference(const RestBv& rest)
    {
        const auto means = rounded_means(rest);
        for (std::size_t j = 0; j < rest.node.size(); ++j) {
            T own[9];
            put_box(rest.local[j], extent_.origin, own, own + 3);
            put_interval(rest.space.l[j], rest.space.h[j], own[6], own[7], bv_.sum_l, bv_.sum_r);
            own[8] = static_cast<T>(means[j]);
            out_.value.insert(out_.value.end(), own, own + 9);
        }
    }

    // Means become multiples of 2^-24 for float, still with sum 1; all that moves goes to residual and moment.
    void put_models(const RestBv& rest)
    {
        const auto means = rounded_means(rest);
        double kappa = 0;
        Vec3 reach; // of |y| about the pivot
        for (int s = 0; s < 3; ++s)
            reach[s] =
                sum_up(up_product(std::abs(static_cast<double>(bv_.centre[s]) - static_cast<double>(bv_.pivot[s])),
                                  1 + 4 * unit_roundoff),
                       static_cast<double>(bv_.half[s]));
        for (std::size_t j = 0; j < rest.node.size(); ++j) {
            const WeightModel& model = rest.model[j];
            const double moved = std::abs(model.mean - means[j]); // dyadic: exact
            double residual = sum_up(model.residual, moved), moment_share = 0;
            T own[8];
            for (int s = 0; s < 3; ++s) {
                const T gradient = static_cast<T>(model.gradient[s]);
                const double g = static_cast<double>(gradient), change = std::abs(model.gradient[s] - g);
                residual = sum_up(residual, up_product(change, reach[s]));
                residual = sum_up(residual, up_product(std::abs(g), pivot_off_[s]));
                const double m = sum_up(sum_up(model.moment[s], pivot_off_[s]), up_product(moved, reach[s]));
                kappa += std::abs(g) * reach[s];
                if (m > 0)
                    moment_share = std::max(moment_share, m / extent_.about_origin[s]);
                own[s] = gradient;
                own[4 + s] = round_up<T>(m);
            }
            kappa += residual + moment_share;
            own[3] = round_up<T>(residual);
            own[7] = static_cast<T>(means[j]);
            out_.value.insert(out_.value.end(), own, own + 8);
        }
        bv_.error_factor = round_up<T>(linear_error_factor(rest.node.size(), kappa * (1 + 0x1p-20)));
    }

    // Room for `count` columns of `rows` values at the end of out_.value, in blocks of 8 columns.
    class Blocks {
    public:
        Blocks(Packer& packer, std::size_t count, std::size_t rows)
            : value_(packer.out_.value), first_(value_.size()), count_(count), rows_(rows)
        {
            value_.resize(first_ + blocks_of(count) * rows * block_lanes);
        }
        // The last column is repeated to fill its block, with `repeated` instead of the value.
        void put(std::size_t column, std::size_t row, T value, T repeated)
        {
            T* const block = &value_[first_ + (column / block_lanes * rows_ + row) * block_lanes];
            block[column % block_lanes] = value;
            if (column + 1 == count_)
                for (std::size_t i = column % block_lanes + 1; i < block_lanes; ++i)
                    block[i] = repeated;
        }

    private:
        AlignedVector<T>& value_;
        std::size_t first_, count_, rows_;
    };

    static double up_product(double a, double b) { return a == 0 || b == 0 ? 0 : succ(succ(a * b)); }

    static std::vector<double> rounded_means(const RestBv& rest)
    {
        std::vector<double> means;
        for (const WeightModel& model : rest.model)
            means.push_back(model.mean);
        if (sizeof(T) == 4)
            round_dyadic(means, 24);
        return means;
    }

    std::span<const Vec3> x_;
    const RestExtent& extent_;
    PackedBvs<T>& out_;
    PackedBv<T> bv_;
    Vec3 pivot_off_ = Vec3::Zero();
    std::vector<std::uint32_t> order_; // of the simulation nodes
};

} // namespace

template <class T> void pack_bv(const RestBv& rest, std::span<const Vec3> x, const RestExtent& extent,
                                const BvChoice& choice, PackedBvs<T>& out)
{
    Packer<T>(x, extent, out).pack(rest, choice);
}

template void pack_bv(const RestBv&, std::span<const Vec3>, const RestExtent&, const BvChoice&, PackedBvs<float>&);
template void pack_bv(const RestBv&, std::span<const Vec3>, const RestExtent&, const BvChoice&, PackedBvs<double>&);

} // namespace cinch
