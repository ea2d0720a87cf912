// SPDX-License-Identifier: Apache-2.0
#include "toolkit/simulate/body_model.hpp"

#include <stdexcept>

namespace cinch {

BodyModel::BodyModel(MeshlessBody b, std::optional<DeformableSurface> s)
    : body(std::move(b)), surface(std::move(s)), pinned(body.size(), 0)
{
    if (surface && surface->weights.node_count != body.size())
        throw std::invalid_argument("BodySimulation: the surface's weights are of other nodes");
}

void BodyModel::add(std::unique_ptr<const Effect> effect)
{
    needs_deformation |= effect->needs_deformation();
    has_springs |= effect->has_springs();
    is_plastic |= effect->is_plastic();
    effects.push_back(std::move(effect));
}

void BodyModel::add(Pin pin)
{
    for (const std::uint32_t i : pin.nodes)
        pinned.at(i) = 1;
    pins.push_back(std::move(pin));
}

bool BodyModel::pins_move(double from_s, double to_s) const
{
    for (const Pin& pin : pins)
        for (std::size_t k = 0; k < pin.nodes.size(); ++k)
            if (pin.path(k, from_s) != pin.path(k, to_s))
                return true;
    return false;
}

void BodyModel::move_pins(const Reference& reference, double time_s, Field& u) const
{
    for (const Pin& pin : pins) {
        const Vec3 origin = reference.relative(pin.origin);
        for (std::size_t k = 0; k < pin.nodes.size(); ++k)
            at(u, pin.nodes[k]) = (pin.path(k, time_s) - reference.place(body.rest[pin.nodes[k]])) + origin;
    }
}

void BodyModel::zero_pinned(Field& f) const
{
    for (std::size_t i = 0; i < pinned.size(); ++i)
        if (pinned[i])
            at(f, i).setZero();
}

} // namespace cinch
