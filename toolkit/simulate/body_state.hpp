// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>

#include "toolkit/simulate/body_model.hpp"
#include "toolkit/simulate/memory.hpp"

namespace cinch {

/// Where a body is, how it moves, what of it flowed and what its effects remember: all that steps change. A value:
/// steps are taken back by assigning a copy from before them, and two equal states of a model have the same future, to
/// the last bit.
struct BodyState {
    double time_s = 0;
    Reference reference;
    Field u;                           ///< displacements from the reference, m
    Field v;                           ///< velocities in the world, m/s
    Field x;                           ///< positions in the world, m, as update_positions() made them last
    std::vector<Mat3> plastic_inverse; ///< F_p⁻¹ per node; empty without plasticity
    std::vector<Memory> memory;        ///< of every effect
    Field slow_mode;                   ///< explicit steps: where the last power iteration ended

    BodyState() = default;
    /// At rest at the body's own places, with effects that remember nothing.
    explicit BodyState(const MeshlessBody& body);

    /// Changes the reference; `fields`: displacements that are to stay where they are.
    void refer_to(const MeshlessBody& body, const Reference& to, std::initializer_list<Field*> fields);
    void update_positions(const MeshlessBody& body);
    double kinetic(const MeshlessBody& body) const; ///< J
    bool is_finite() const;

    /// Bytes of which restore() makes the same state again, in a state of the same model. A stream that is too short is
    /// left failed, with a state that is not to be used.
    void save(std::ostream& out) const;
    void restore(std::istream& in);
};

/// The reference that fits displacements `u` from the present one best, by mass; the present one where pins hold the
/// body, so that these stay where they are to the last bit. A turn by less than 2⁻²⁶ is left to the displacements: they
/// are fine enough, and two rotations of doubles differ by a strain of some u.
Reference fitted(const BodyModel& model, const Reference& present, const Field& u);

} // namespace cinch
