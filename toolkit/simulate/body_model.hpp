// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "toolkit/simulate/effect.hpp"
#include "toolkit/simulate/pin.hpp"

namespace cinch {

/// What a body is and what acts on it: all that no step changes.
struct BodyModel {
    MeshlessBody body;
    std::optional<DeformableSurface> surface;
    std::vector<std::unique_ptr<const Effect>> effects;
    std::vector<Pin> pins;
    std::vector<std::uint8_t> pinned; ///< per node: whether a pin says where it is
    bool needs_deformation = false, has_springs = false, is_plastic = false; ///< whether some effect does, has, is

    /// Throws std::invalid_argument if the surface's weights are of other nodes.
    BodyModel(MeshlessBody body, std::optional<DeformableSurface> surface);
    void add(std::unique_ptr<const Effect> effect);
    void add(Pin pin);

    /// Whether a pinned node is elsewhere at the one time than at the other.
    bool pins_move(double from_s, double to_s) const;
    /// Sets the displacements from `reference` of pinned nodes to where their pins have them.
    void move_pins(const Reference& reference, double time_s, Field& u) const;
    void zero_pinned(Field& f) const;
};

} // namespace cinch
