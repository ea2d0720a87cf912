// SPDX-License-Identifier: Apache-2.0
#include "toolkit/surface/gltf_morph.hpp"

#include <algorithm>

#include "toolkit/surface/gltf_accessor.hpp"

namespace cinch {

bool is_known_attribute(const std::string& name)
{
    if (name == "POSITION" || name == "NORMAL" || name == "TANGENT" || name.starts_with('_'))
        return true;
    for (const char* set : {"TEXCOORD_", "COLOR_", "JOINTS_", "WEIGHTS_"})
        if (name.starts_with(set))
            return true;
    return false;
}

bool GltfMorph::moved_by(const std::vector<double>& all) const
{
    for (std::size_t i = 0; i < all.size(); ++i)
        if (all[i] != 0 && targets > 0 && moves[i % targets])
            return true;
    return false;
}

GltfMorph read_morph(const GltfValue& node, std::size_t node_index, const GltfValue& mesh)
{
    GltfMorph morph;
    morph.node = node_index;
    morph.mesh = node["mesh"].index();
    const GltfValue primitives = mesh["primitives"];
    for (std::size_t p = 0; p < primitives.size(); ++p)
        if (const auto targets = primitives[p].find("targets");
            targets && primitives[p]["attributes"].has("POSITION")) {
            morph.targets = std::max(morph.targets, targets->size());
            morph.moves.resize(morph.targets, 0);
            for (std::size_t t = 0; t < targets->size(); ++t)
                for (const std::string& name : (*targets)[t].keys())
                    morph.moves[t] |= name == "POSITION" || !is_known_attribute(name);
        }
    if (morph.targets == 0)
        return morph;
    for (const GltfValue& holder : {node, mesh})
        if (const auto weights = holder.find("weights")) {
            morph.weights = weights->numbers(weights->size());
            break;
        }
    return morph;
}

std::vector<Displacements> read_displacements(GltfDocument& document, const GltfValue& primitive, std::size_t vertices,
                                              std::uint32_t first, Missing& missing)
{
    std::vector<Displacements> out(vertices);
    const auto targets = primitive.find("targets");
    if (!targets)
        return out;
    for (std::size_t t = 0; t < targets->size(); ++t) {
        const GltfValue target = (*targets)[t];
        for (const std::string& name : target.keys())
            if (!is_known_attribute(name))
                missing.add("the attribute '" + one_line(name) + "' of morph targets", primitive.place());
        const auto accessor = target.index_of("POSITION");
        if (!accessor)
            continue;
        const std::vector<double> displacement = read_accessor(document, *accessor, 3, missing);
        if (displacement.size() != 3 * vertices)
            target.fail("has " + std::to_string(displacement.size() / 3) + " displacements for " +
                        std::to_string(vertices) + " positions");
        for (std::size_t k = 0; k < vertices; ++k) {
            const double* d = &displacement[3 * k];
            if (d[0] != 0 || d[1] != 0 || d[2] != 0)
                out[k].push_back({first + static_cast<std::uint32_t>(t), {d[0] + 0.0, d[1] + 0.0, d[2] + 0.0}});
        }
    }
    return out;
}

} // namespace cinch
