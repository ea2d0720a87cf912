// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>

#include "cinch/deform.hpp"
#include "experiments/report/whole_file.hpp"
#include "experiments/simulation/simulate.hpp"
#include "toolkit/simulate/frame_file.hpp"

namespace cinch {

/// Writes the frames that a run produces, and checkpoints from which another run writes the rest, byte for byte as if
/// there had been one. Until the run is whole its frames stand in NAME.part, which stays where it stops, and is where
/// the next one goes on.
class FrameOutput {
public:
    /// Throws InputError if something cannot be written, or a checkpoint continues no such run; restores `simulation`
    /// from one.
    FrameOutput(const SimulateOptions& options, const FoundScene& scene, Simulation& simulation);

    /// The present state of the simulation as the next frame; or why it is none: nothing that is not finite is ever
    /// written.
    std::string write(Simulation& simulation);
    /// What is written stays written, and a checkpoint says so.
    void save(const Simulation& simulation);
    /// The run is whole: its frames get their name.
    void commit();
    /// Where the frames of a run that is not whole are; empty: nowhere.
    std::string part() const { return frames_ ? frames_->part() : std::string(); }

private:
    void append(const std::string& bytes);
    bool is_mesh_name(const std::filesystem::path& file) const;
    void resume(Simulation& simulation);
    std::string write_meshes(std::size_t frame, std::span<const std::vector<AffineMap>> maps,
                             const Simulation& simulation);

    SimulateOptions options_;
    std::uint64_t identity_;
    std::string checkpoint_;
    FrameLayout layout_;
    std::vector<std::string> names_;
    std::vector<std::unique_ptr<SurfaceEvaluator<float>>> surface_; ///< if there are meshes to write
    std::optional<WholeFile> frames_;
    std::uint64_t bytes_ = 0, checksum_ = 0, written_ = 0; ///< of the file of frames; frames in it
};

} // namespace cinch
