// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fstream>
#include <memory>

#include "experiments/simulation/simulate.hpp"
#include "toolkit/deform/surface_evaluator.hpp"
#include "toolkit/simulate/frame_file.hpp"

namespace cinch {

/// Writes the frames that a run produces, and checkpoints from which another run writes the rest, byte for byte as if there had been one.
class FrameOutput {
public:
    /// Throws InputError if something cannot be written, or a checkpoint continues no such run; restores `simulation` from one.
    FrameOutput(const SimulateOptions& options, const FoundScene& scene, Simulation& simulation);

    /// The present state of the simulation as the next frame; or why it is none: nothing that is not finite is ever written.
    std::string write(Simulation& simulation);
    /// What is written stays written, and a checkpoint says so.
    void save(const Simulation& simulation);

private:
    void append(const std::string& bytes);
    std::string write_meshes(std::size_t frame, std::span<const std::vector<AffineMap>> maps, const Simulation& simulation);

    SimulateOptions options_;
    std::uint64_t identity_;
    std::string checkpoint_;
    FrameLayout layout_;
    std::vector<std::string> names_;
    std::vector<std::unique_ptr<SurfaceEvaluator<float>>> surface_; ///< if there are meshes to write
    std::ofstream frames_;
    std::uint64_t bytes_ = 0, written_ = 0, sum_ = checksum_of_nothing; ///< of the file of frames; frames in it; its checksum
};

} // namespace cinch
