// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/tightness/level_ratios.hpp"

#include <algorithm>
#include <cmath>

#include "toolkit/hierarchy/box_radius.hpp"

namespace cinch {

using Json = nlohmann::ordered_json;

double LevelRatio::mean() const { return measured ? sum / static_cast<double>(measured) : NAN; }

std::vector<LevelRatio> level_ratios(const Bvh& bvh, std::span<const double> truth, std::span<const double> supports,
                                     const exact::FrameVerdict* verdict)
{
    std::vector<LevelRatio> levels(bvh.level.size() - 1);
    for (std::size_t l = 0; l < levels.size(); ++l) {
        levels[l].bvs = bvh.level[l + 1] - bvh.level[l];
        for (std::size_t bv = bvh.level[l]; bv < bvh.level[l + 1]; ++bv) {
            const double whole = box_radius(truth.subspan(6 * bv, 6)),
                         ratio = box_radius(supports.subspan(6 * bv, 6)) / whole;
            if (!(whole > 0 && std::isfinite(ratio)))
                continue;
            ++levels[l].measured;
            levels[l].sum += ratio;
            levels[l].max = std::max(levels[l].max, ratio);
            if (!verdict)
                continue;
            const exact::Loss& loss = verdict->bvs[bv].loss;
            levels[l].loss.box += loss.box / whole;
            levels[l].loss.interval += loss.interval / whole;
            levels[l].loss.corner += (loss.corner + loss.rounding) / whole;
        }
    }
    return levels;
}

void add(const LevelRatios& more, LevelRatios& sum)
{
    for (const auto& [method, levels] : more) {
        std::vector<LevelRatio>& to = sum[method];
        to.resize(levels.size());
        for (std::size_t l = 0; l < levels.size(); ++l) {
            to[l].bvs = levels[l].bvs;
            to[l].measured += levels[l].measured;
            to[l].sum += levels[l].sum;
            to[l].max = std::max(to[l].max, levels[l].max);
            to[l].loss.box += levels[l].loss.box;
            to[l].loss.interval += levels[l].loss.interval;
            to[l].loss.corner += levels[l].loss.corner;
        }
    }
}

Json to_json(const LevelRatios& ratios)
{
    Json out = Json::object();
    for (const auto& [method, levels] : ratios) {
        Json rows = Json::array();
        for (const LevelRatio& l : levels)
            rows.push_back({l.bvs, l.measured, l.sum, l.max, l.loss.box, l.loss.interval, l.loss.corner});
        out[method] = std::move(rows);
    }
    return out;
}

LevelRatios level_ratios_of(const Json& json)
{
    LevelRatios out;
    for (const auto& [method, rows] : json.items())
        for (const Json& l : rows)
            out[method].push_back({l[0], l[1], l[2], l[3], {l[4], l[5], l[6], 0}});
    return out;
}

} // namespace cinch
