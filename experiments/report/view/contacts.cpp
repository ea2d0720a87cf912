// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/view/contacts.hpp"

#include <algorithm>

#include "cinch/collider.hpp"
#include "experiments/report/interrupt.hpp"

namespace cinch {

Contacts contacts(const std::vector<DrawnBody>& bodies, std::size_t frames)
{
    Contacts out;
    if (bodies.size() < 2)
        return out;
    Collider collider{LazyOptions{}};
    std::vector<std::uint32_t> base{0};
    for (const DrawnBody& body : bodies) {
        throw_if_interrupted();
        collider.add(body.bvh, body.input.surface);
        base.push_back(base.back() + static_cast<std::uint32_t>(body.bvh.triangle.size()));
    }
    std::vector<BodyFrame> now(bodies.size());
    std::vector<Clip::Frame> maps(bodies.size());
    for (std::size_t f = 0; f < frames; ++f) {
        throw_if_interrupted();
        for (std::size_t b = 0; b < bodies.size(); ++b) {
            maps[b] = bodies[b].input.clip.frame(f);
            now[b] = {maps[b]};
        }
        collider.update(now);
        const std::vector<TrianglePair> pairs = collider.pairs();
        std::vector<std::int32_t> here;
        auto add = [&](std::uint32_t body, std::uint32_t triangle) {
            here.push_back(static_cast<std::int32_t>(base[body] + bodies[body].place_of_triangle[triangle]));
        };
        for (const TrianglePair& p : pairs) {
            add(p.body_a, p.triangle_a);
            add(p.body_b, p.triangle_b);
        }
        std::sort(here.begin(), here.end());
        here.erase(std::unique(here.begin(), here.end()), here.end());
        out.triangle.insert(out.triangle.end(), here.begin(), here.end());
        out.triangles_in_frame.push_back(static_cast<std::int32_t>(here.size()));
        out.pairs_in_frame.push_back(static_cast<std::int32_t>(pairs.size()));
    }
    return out;
}

} // namespace cinch
