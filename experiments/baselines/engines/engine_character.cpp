// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/baselines/engines/engine_character.hpp"

#include <algorithm>

#include <Eigen/LU>
#include <fmt/format.h>

namespace cinch {

EngineCharacter engine_character(const TimedBody& body, const TimedClip& clip)
{
    EngineCharacter out{body.input.surface, clip.motion, {}, {}, 0, body.targets()};
    if (!body.character) {
        out.file_pose = clip.motion.at(clip.motion.first_s());
        return out;
    }
    const Character& character = *body.character;
    out.file_pose = rest_pose(character).frame(0);
    for (const Joint& joint : character.joints) {
        Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 4; ++c)
                m(r, c) = joint.inverse_bind.m[r][c];
        out.pivot.push_back(m.inverse().topRightCorner<3, 1>());
        if (joint.bone < character.joints[out.root].bone)
            out.root = out.pivot.size() - 1;
    }
    if (!std::all_of(out.pivot.begin(), out.pivot.end(), [](const Vec3& x) { return x.allFinite(); }))
        out.pivot.clear(); // a joint that flattens the mesh
    return out;
}

ReadyFormula ready_formula(const std::string& name, const TimedBody& body, const TimedClip& clip)
{
    std::string known;
    for (const EngineFormula& formula : engine_formulas()) {
        known += (known.empty() ? "" : ", ") + formula.name;
        if (formula.name != name)
            continue;
        if (auto ready = formula.make(engine_character(body, clip)))
            return std::move(*ready);
        throw InputError::in_file(body.input.name, fmt::format("has not what the formula '{}' needs", name));
    }
    throw InputError(fmt::format("expected a formula of {}, found '{}'", known, name));
}

} // namespace cinch
