// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "cinch/environment.hpp"
#include "toolkit/time/motion_interval.hpp"

#include "toolkit/time/norm.hpp"

namespace cinch {
namespace {

// Sums of a few squares and a root.
constexpr double wider = 1 + 0x1p-40;

struct Frames {
    Clip clip;
    std::vector<double> time_s;
    std::vector<Reach> reach;

    // The frame at or before t that is not the last one.
    std::size_t before(double t) const
    {
        const auto next = std::upper_bound(time_s.begin(), time_s.end(), t);
        const auto i = static_cast<std::size_t>(next - time_s.begin());
        return std::min(i > 0 ? i - 1 : 0, time_s.size() > 1 ? time_s.size() - 2 : 0);
    }

    // T_i + s (T_i+1 − T_i).
    static std::vector<AffineMap> between(const Clip::Frame& first, const Clip::Frame& last, double s)
    {
        std::vector<AffineMap> out(first.size());
        for (std::size_t j = 0; j < first.size(); ++j)
            for (int r = 0; r < 3; ++r)
                for (int c = 0; c < 4; ++c)
                    out[j].m[r][c] =
                        s == 1 ? last[j].m[r][c] : first[j].m[r][c] + s * (last[j].m[r][c] - first[j].m[r][c]);
        return out;
    }

    double share(std::size_t i, double t) const
    {
        if (!(time_s[i + 1] > time_s[i]))
            return 1; // of two frames at one time the later one
        return std::clamp((t - time_s[i]) / (time_s[i + 1] - time_s[i]), 0.0, 1.0);
    }

    std::vector<AffineMap> at(double t) const
    {
        if (time_s.size() == 1)
            return clip.frame(0);
        const std::size_t i = before(t);
        return between(clip.frame(i), clip.frame(i + 1), share(i, t));
    }

    MotionInterval over(double a, double b) const
    {
        MotionInterval out{a, b, {}, {}, {}, {}, {}};
        if (time_s.size() == 1) {
            out.first = out.last = clip.frame(0);
        } else {
            const std::size_t i = before(a + (b - a) / 2);
            const Clip::Frame first = clip.frame(i), last = clip.frame(i + 1);
            out.first = between(first, last, share(i, a));
            out.last = between(first, last, share(i, b));
        }
        out.bend.assign(out.first.size(), AffineMap{});
        // Between the ends every place moves along a straight line: no bump. What interpolation rounds, here and where
        // vertices are computed at times between, is 6u of either map.
        auto norm = [](const AffineMap& map, const Reach& of) {
            std::array<double, 9> linear;
            std::array<double, 3> shift;
            for (std::size_t r = 0; r < 3; ++r) {
                std::copy_n(map.m[r], 3, linear.begin() + static_cast<std::ptrdiff_t>(3 * r));
                shift[r] = map.m[r][3];
            }
            return norm_of(linear) * (norm_of(of.centre) + of.radius) + norm_of(shift);
        };
        out.limits.resize(out.first.size());
        for (std::size_t j = 0; j < out.limits.size(); ++j)
            if (reach[j].any) {
                const double size = (norm(out.first[j], reach[j]) + norm(out.last[j], reach[j])) * wider;
                out.limits[j] = {0, 0, HUGE_VAL, 0x1p-42 * size, 0};
            }
        return out;
    }
};

} // namespace

std::vector<Reach> reaches(const DeformableSurface& surface)
{
    const Weights& weights = surface.weights;
    std::vector<Reach> out(weights.node_count);
    std::vector<std::pair<Vec3, Vec3>> box(out.size(), {Vec3::Constant(HUGE_VAL), Vec3::Constant(-HUGE_VAL)});
    auto each = [&](auto&& use) {
        for (std::size_t v = 0; v < weights.vertex_count(); ++v)
            for (const std::uint32_t j : weights.of(v).node)
                use(j, surface.mesh.vertices[v]);
    };
    each([&](std::uint32_t j, const Vec3& y) {
        box[j] = {box[j].first.cwiseMin(y), box[j].second.cwiseMax(y)};
        out[j].any = true;
    });
    for (std::size_t j = 0; j < out.size(); ++j)
        if (out[j].any)
            out[j].centre = 0.5 * box[j].first + 0.5 * box[j].second;
    each([&](std::uint32_t j, const Vec3& y) {
        out[j].radius = std::max(out[j].radius, norm_of(y - out[j].centre) * wider);
    });
    return out;
}

TimedMotion linear_motion(const Clip& of, const DeformableSurface& surface)
{
    require_default_arithmetic();
    auto frames = std::make_shared<Frames>(Frames{of, {}, reaches(surface)});
    for (std::size_t i = 0; i < of.frame_count(); ++i)
        frames->time_s.push_back(of.time_s(i));
    TimedMotion out{of.name, frames->time_s, [frames](double t) { return frames->at(t); }, nullptr,
                    [frames](double a, double b) { return frames->over(a, b); }};
    out.keys.erase(std::unique(out.keys.begin(), out.keys.end()), out.keys.end());
    return out;
}

} // namespace cinch
