// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/baselines/engines/engine_formula.hpp"

#include "cinch/deform.hpp"

namespace cinch {

const std::vector<EngineFormula>& engine_formulas()
{
    static const std::vector<EngineFormula> all{
        {"rest-box", "Bevy before 0.19, Babylon.js 7", "the box of the pose of the file, whatever moves", rest_box},
        {"rest-sphere", "three.js since r151", "a ball about the first pose that is seen, kept", rest_sphere},
        {"root-box", "Unity 6, localBounds", "the box of the pose of the file, carried by the root bone", root_box},
        {"joint-pivots", "OpenUSD 24, UsdSkel extents",
         "the box of all joints, padded by how far the mesh reaches beyond them at rest", joint_pivots},
        {"joint-spheres", "Ogre 13, boxes from the skeleton", "balls about joints as far as their vertices are at rest",
         joint_spheres},
        {"joint-boxes", "in real arithmetic", "each joint's rest box transformed, and all united", joint_boxes},
        {"joint-boxes-float", "Bevy 0.19, Godot 4", "the same in binary32, rounded to nearest", joint_boxes_float},
        {"key-union", "baked at import", "the union of the true boxes at all key times", union_at_keys},
        {"fps-union", "baked at import", "the union of the true boxes at 30 frames per second", union_at_30_fps},
        {"key-joint-boxes", "baked at import", "the union of joint-boxes at all key times", joint_boxes_at_keys},
        {"morph-average", "three.js r160, GLTFLoader",
         "the box of the pose of the file, grown by the greatest displacement of any one morph target", morph_average}};
    return all;
}

std::vector<Vec3> EngineCharacter::places(std::span<const AffineMap> maps) const
{
    std::vector<Vec3> out(surface.mesh.vertices.size());
    evaluate(surface.mesh.vertices, surface.weights, maps, out);
    return out;
}

std::vector<Vec3> EngineCharacter::places_at(double t_s) const
{
    std::vector<Vec3> out = surface.mesh.vertices;
    if (motion.weights)
        displace(targets, motion.weights(t_s), out);
    evaluate(out, surface.weights, motion.at(t_s), out);
    return out;
}

EngineBound no_box() { return {Vec3::Constant(HUGE_VAL), Vec3::Constant(-HUGE_VAL), {}}; }

EngineBound merged(const EngineBound& a, const EngineBound& b)
{
    return {a.low.cwiseMin(b.low), a.high.cwiseMax(b.high), {}};
}

EngineBound box_of(std::span<const Vec3> points)
{
    EngineBound box = no_box();
    for (const Vec3& x : points)
        box = merged(box, {x, x, {}});
    return box;
}

} // namespace cinch
