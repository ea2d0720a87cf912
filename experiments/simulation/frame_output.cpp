// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/simulation/frame_output.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <sstream>

#include <fmt/format.h>

#include "cinch/surface.hpp"
#include "experiments/report/provenance.hpp"
#include "toolkit/simulate/stream.hpp"
#include "toolkit/surface/read_mesh.hpp"

namespace cinch {
namespace {

namespace fs = std::filesystem;
constexpr std::string_view magic = "cinchchk3";

bool is_text(const std::string& file) { return file.ends_with(".jsonl"); }

void write_ply(std::ostream& out, const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles)
{
    out << "ply\nformat binary_little_endian 1.0\nelement vertex " << vertices.size()
        << "\nproperty float x\nproperty float y\nproperty float z\nelement face " << triangles.size()
        << "\nproperty list uchar uint vertex_indices\nend_header\n";
    for (const Vec3& v : vertices) {
        const Eigen::Vector3f f = v.cast<float>();
        out.write(reinterpret_cast<const char*>(f.data()), 12);
    }
    for (const Triangle& t : triangles) {
        out.put(3);
        out.write(reinterpret_cast<const char*>(t.data()), 12);
    }
}

void write_obj(std::ostream& out, const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles)
{
    for (const Vec3& v : vertices)
        out << fmt::format("v {} {} {}\n", static_cast<float>(v[0]), static_cast<float>(v[1]),
                           static_cast<float>(v[2]));
    for (const Triangle& t : triangles)
        out << fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
}

std::string json_lines(std::size_t frame, double time_s, const std::vector<std::string>& names,
                       std::span<const std::vector<AffineMap>> maps)
{
    std::string out;
    for (std::size_t b = 0; b < maps.size(); ++b) {
        out += fmt::format("{{\"frame\":{},\"time_s\":{},\"body\":\"{}\",\"maps\":[", frame, time_s, names[b]);
        for (std::size_t j = 0; j < maps[b].size(); ++j) {
            out += j ? ",[" : "[";
            for (int i = 0; i < 12; ++i)
                out += fmt::format("{}{}", i ? "," : "", maps[b][j].m[i / 4][i % 4]);
            out += "]";
        }
        out += "]}\n";
    }
    return out;
}

enum class FrameFormat : std::uint64_t { none, binary, text };
FrameFormat format_of(const std::string& file)
{
    return file.empty() ? FrameFormat::none : is_text(file) ? FrameFormat::text : FrameFormat::binary;
}

struct Checkpoint {
    struct Header {
        std::uint64_t identity = 0, bytes = 0, checksum = checksum_of_nothing,
                      written = 0; ///< of the scene; of the file of frames; frames in it
        FrameFormat format = FrameFormat::none;
        std::uint64_t program_bytes = 0, state_bytes = 0; ///< what follows
    } header;
    std::string program; ///< that wrote it
    std::string state;
};

std::string this_program()
{
    const Provenance from = provenance(1, 0);
    return from.version + " (" + from.commit + ")";
}

// The file's last 8 bytes are a checksum of all before them.
Checkpoint read_checkpoint(const std::string& file)
{
    const std::string bytes = read_bytes(file);
    Checkpoint checkpoint;
    constexpr std::size_t overhead = magic.size() + sizeof(Checkpoint::Header) + 8;
    if (bytes.size() < overhead || !bytes.starts_with(magic))
        throw InputError::in_file(file, "is no checkpoint");
    std::uint64_t sum = 0;
    std::istringstream in(bytes.substr(magic.size())), end(bytes.substr(bytes.size() - 8));
    read_raw<std::uint64_t>(end, {&sum, 1});
    if (sum != checksum(std::string_view(bytes).substr(0, bytes.size() - 8)))
        throw InputError::in_file(file, "was changed or is cut off");
    read_raw<Checkpoint::Header>(in, {&checkpoint.header, 1});
    const Checkpoint::Header& header = checkpoint.header;
    const std::uint64_t rest = bytes.size() - overhead;
    if (header.program_bytes > rest || header.state_bytes != rest - header.program_bytes ||
        header.format > FrameFormat::text ||
        (header.format == FrameFormat::none && (header.bytes != 0 || header.written != 0)))
        throw InputError::in_file(file, "contradicts itself");
    checkpoint.program = bytes.substr(overhead - 8, header.program_bytes);
    checkpoint.state = bytes.substr(overhead - 8 + header.program_bytes, header.state_bytes);
    return checkpoint;
}

} // namespace

FrameOutput::FrameOutput(const SimulateOptions& options, const FoundScene& scene, Simulation& simulation)
    : options_(options), identity_(scene.identity),
      checkpoint_(options.checkpoint.empty() ? options.resume : options.checkpoint)
{
    layout_.frame_s = simulation.scene().frame_s;
    for (Simulation::Body& body : simulation.bodies()) {
        layout_.nodes.push_back(static_cast<std::uint32_t>(body.simulation.body().size()));
        names_.push_back(body.name);
        if (!options.meshes.empty())
            surface_.push_back(std::make_unique<SurfaceEvaluator<float>>(*body.simulation.surface()));
    }
    if (!options.meshes.empty()) {
        std::error_code error;
        fs::create_directories(options.meshes, error);
        if (!fs::is_directory(options.meshes))
            throw InputError::in_file(options.meshes, "is no folder and cannot be made one");
        for (const auto& there : fs::directory_iterator(options.meshes, error)) // of which any may come to be written
            if (is_mesh_name(there.path()))
                refuse_input(there.path());
    }
    std::error_code error;
    if (!checkpoint_.empty() && fs::exists(checkpoint_, error) && !fs::is_regular_file(checkpoint_, error))
        throw InputError::in_file(checkpoint_, "is no regular file");
    std::optional<WholeFile> can_be_written;
    if (!checkpoint_.empty())
        can_be_written.emplace(checkpoint_);
    if (!options.resume.empty()) {
        resume(simulation);
    } else if (!options.frames.empty()) {
        frames_.emplace(WholeFile::continued(options.frames));
        checksum_ = checksum({});
        if (!is_text(options.frames))
            append(frame_header(layout_));
    }
}

// NAME-FRAME.ply of one of the bodies, as write_meshes makes it.
bool FrameOutput::is_mesh_name(const fs::path& file) const
{
    const std::string stem = file.stem().string();
    const std::size_t dash = stem.rfind('-');
    return file.extension() == "." + options_.mesh_format && dash != std::string::npos &&
           stem.find_first_not_of("0123456789", dash + 1) == std::string::npos &&
           std::find(names_.begin(), names_.end(), stem.substr(0, dash)) != names_.end();
}

void FrameOutput::resume(Simulation& simulation)
{
    const Checkpoint checkpoint = read_checkpoint(options_.resume);
    if (checkpoint.program != this_program())
        throw InputError::in_file(
            options_.resume,
            fmt::format("was written by cinch {}, this is {}, whose frames may differ; continue with the same program",
                        checkpoint.program, this_program()));
    if (checkpoint.header.identity != identity_)
        throw InputError::in_file(options_.resume, "is of another scene, or of other settings than these");
    if (checkpoint.header.format != format_of(options_.frames))
        throw InputError::in_file(
            options_.resume, checkpoint.header.format == FrameFormat::none     ? "is of a run without --frames"
                             : checkpoint.header.format == FrameFormat::binary ? "continues with --frames FILE, binary"
                                                                               : "continues with --frames FILE.jsonl");
    std::istringstream state(checkpoint.state);
    simulation.restore(state);
    if (!state || state.peek() != std::istringstream::traits_type::eof())
        throw InputError::in_file(options_.resume, "does not fit this scene");
    if (simulation.frame() >= simulation.frame_count())
        throw InputError::in_file(
            options_.resume, fmt::format("is at frame {}, and this run ends with frame {}; give it a longer --duration",
                                         simulation.frame(), simulation.frame_count() - 1));
    for (const Simulation::Body& body : simulation.bodies())
        for (const Field* field : {&body.simulation.positions(), &body.simulation.velocities()})
            if (!std::all_of(field->begin(), field->end(), [](double x) { return std::isfinite(x); }))
                throw InputError::in_file(options_.resume,
                                          "has numbers for body '" + body.name + "' that are not finite");
    if (const std::uint64_t frames = simulation.frame() + 1;
        checkpoint.header.format != FrameFormat::none && checkpoint.header.written != frames)
        throw InputError::in_file(options_.resume, fmt::format("is at frame {}, but says that {} frames are written",
                                                               simulation.frame(), checkpoint.header.written));
    bytes_ = checkpoint.header.bytes;
    checksum_ = checkpoint.header.checksum;
    written_ = checkpoint.header.written;
    std::error_code error;
    if (!options_.frames.empty() && fs::equivalent(options_.frames, options_.resume, error))
        throw InputError::in_file(options_.frames, "is the checkpoint to continue from; the frames need another name");
    if (!options_.frames.empty()) // what came after the checkpoint comes again
        frames_.emplace(WholeFile::continued(options_.frames, bytes_, checksum_));
}

void FrameOutput::append(const std::string& bytes)
{
    frames_->write(bytes);
    bytes_ += bytes.size();
    checksum_ = checksum(bytes, checksum_);
}

std::string FrameOutput::write(Simulation& simulation)
{
    if (options_.frames.empty() && options_.meshes.empty())
        return "";
    std::vector<std::vector<AffineMap>> maps;
    for (Simulation::Body& body : simulation.bodies()) {
        maps.push_back(body.simulation.frame());
        for (const AffineMap& map : maps.back())
            for (const auto& row : map.m)
                for (const double value : row)
                    if (!std::isfinite(value))
                        return fmt::format("body '{}' at {:.6g} s: its transforms are no longer finite", body.name,
                                           simulation.time_s());
    }
    if (!options_.frames.empty()) {
        const std::string record = is_text(options_.frames)
                                       ? json_lines(simulation.frame(), simulation.time_s(), names_, maps)
                                       : frame_record(layout_, simulation.frame(), simulation.time_s(), maps);
        append(record);
        ++written_;
    }
    return options_.meshes.empty() ? "" : write_meshes(simulation.frame(), maps, simulation);
}

std::string FrameOutput::write_meshes(std::size_t frame, std::span<const std::vector<AffineMap>> maps,
                                      const Simulation& simulation)
{
    for (std::size_t b = 0; b < maps.size(); ++b) {
        const TriangleMesh& mesh = simulation.bodies()[b].simulation.surface()->mesh;
        std::vector<Vec3> vertices(mesh.vertices.size());
        (*surface_[b])(maps[b], vertices);
        for (const Vec3& v : vertices)
            if (!(v.cwiseAbs().maxCoeff() <= std::numeric_limits<float>::max()))
                return fmt::format("body '{}' at {:.6g} s: a position is beyond what a mesh file holds", names_[b],
                                   simulation.time_s());
        const fs::path file =
            fs::path(options_.meshes) / fmt::format("{}-{:05}.{}", names_[b], frame, options_.mesh_format);
        std::ostringstream out;
        (options_.mesh_format == "obj" ? write_obj : write_ply)(out, vertices, mesh.triangles);
        write_whole(file, out.view());
    }
    return "";
}

void FrameOutput::save(const Simulation& simulation)
{
    if (frames_)
        frames_->sync();
    if (checkpoint_.empty())
        return;
    std::ostringstream out;
    out << magic;
    std::ostringstream state;
    simulation.save(state);
    const std::string program = this_program();
    const Checkpoint::Header header{
        identity_, bytes_, checksum_, written_, format_of(options_.frames), program.size(), state.view().size()};
    write_raw<Checkpoint::Header>(out, {&header, 1});
    out << program << state.view();
    const std::uint64_t sum = checksum(out.view());
    write_raw<std::uint64_t>(out, {&sum, 1});
    write_whole(checkpoint_, out.view());
}

void FrameOutput::commit()
{
    if (frames_)
        frames_->commit();
    frames_.reset();
}

} // namespace cinch
