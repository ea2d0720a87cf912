// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/body_builder.hpp"

#include <algorithm>
#include <stdexcept>

#include "cinch/surface.hpp"

namespace cinch {

void BodyBuilder::build()
{
    for (const SceneEffect& effect : scene_.effects)
        if (effect.acts_on(spec_.name) && effect.plan.build) {
            effect_ = &effect;
            effect.plan.build(*this);
        }
}

void BodyBuilder::add(std::unique_ptr<const Effect> effect)
{
    if (std::string_view(effect->name()) != effect_->kind->name)
        throw std::logic_error(std::string("the effect '") + effect_->kind->name + "' of a scene is called '" +
                               effect->name() + "' on its bodies");
    out_.add(std::move(effect));
}

void BodyBuilder::add(Pin pin)
{
    for (const std::uint32_t i : pin.nodes) {
        if (std::find(pinned_.begin(), pinned_.end(), i) != pinned_.end())
            complain("simulation node " + std::to_string(i) + " of body '" + spec_.name +
                     "' is pinned or scripted already");
        pinned_.push_back(i);
    }
    out_.add(std::move(pin));
}

std::vector<std::uint32_t> BodyBuilder::select(const NodeSelection& nodes) const
{
    return select_nodes(nodes, body().rest, file_, effect_->path, spec_.name);
}

std::vector<Vec3> BodyBuilder::starts(const std::vector<std::uint32_t>& nodes) const
{
    std::vector<Vec3> places;
    for (const std::uint32_t i : nodes)
        places.push_back(at(start_, i));
    return places;
}

BodyPath BodyBuilder::clip(const std::vector<std::uint32_t>& nodes) const
{
    if (!clip_)
        complain("'clip' needs a body whose surface is an animated character; '" + spec_.name + "' is none");
    return [nodes, path = clip_](std::size_t k, double t) { return path(nodes[k], t); };
}

double BodyBuilder::young() const
{
    for (const SceneEffect& effect : scene_.effects)
        if (effect.plan.young > 0 && effect.acts_on(spec_.name))
            return effect.plan.young;
    return 0;
}

void BodyBuilder::complain(const std::string& what) const
{
    throw InputError::in_file(file_, effect_->path + ": " + what);
}
void CouplingBuilder::complain(const std::string& what) const
{
    throw InputError::in_file(file_, effect_.path + ": " + what);
}

} // namespace cinch
