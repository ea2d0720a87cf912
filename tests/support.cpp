// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <sstream>

#include <sys/wait.h>
#include <unistd.h>

#include "toolkit/deform/motion.hpp"
#include "toolkit/deform/sample_nodes.hpp"
#include "toolkit/surface/shapes.hpp"
#include "toolkit/surface/triangle_mesh.hpp"

namespace cinch::test {

TemporaryFolder::TemporaryFolder()
{
    std::string pattern = (std::filesystem::temp_directory_path() / "cinch-test-XXXXXX").string();
    if (!mkdtemp(pattern.data()))
        throw std::runtime_error("no temporary folder");
    path_ = pattern;
}

TemporaryFolder::~TemporaryFolder()
{
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

std::filesystem::path TemporaryFolder::write(const std::string& name, std::string_view bytes) const
{
    std::ofstream(path_ / name, std::ios::binary) << bytes;
    return path_ / name;
}

std::optional<std::filesystem::path> shared(const std::string& name)
{
    const std::filesystem::path path = std::filesystem::path(CINCH_SHARED) / name;
    if (std::filesystem::exists(path))
        return path;
    std::cout << "SKIPPED: the reference material '" << name << "' is not here\n";
    return std::nullopt;
}

double test_share()
{
    const char* const text = std::getenv("CINCH_TEST_SHARE");
    return text ? std::atof(text) : 1;
}

std::size_t share_of(std::size_t cases)
{
    const double share = std::clamp(test_share(), 0.0, 1.0);
    return std::max<std::size_t>(1, static_cast<std::size_t>(share * static_cast<double>(cases)));
}

std::vector<std::string> Run::lines() const
{
    std::vector<std::string> all;
    std::istringstream in(out);
    for (std::string line; std::getline(in, line);)
        all.push_back(line);
    return all;
}

static std::string slurp(const std::filesystem::path& path)
{
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

static Run run(const std::string& prefix, const std::string& arguments)
{
    const TemporaryFolder folder;
    const std::string out = (folder.path() / "out").string(), err = (folder.path() / "err").string();
    const std::string command =
        prefix + "'" + CINCH_PROGRAM + "' " + arguments + " >'" + out + "' 2>'" + err + "' </dev/null";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), slurp(out), slurp(err)};
}

Run cinch(const std::string& arguments) { return run("", arguments); }

Run cinch_with(const std::string& setting, const std::string& arguments) { return run(setting + " ", arguments); }

Run cinch_interrupted(const std::string& arguments, int seconds)
{
    return run("timeout --preserve-status -s INT " + std::to_string(seconds) + " ", arguments);
}

Run cinch_killed(const std::string& arguments, double seconds)
{
    return run("timeout -s KILL " + std::to_string(seconds) + " ", arguments);
}

Example example(std::size_t vertices, std::size_t nodes)
{
    Example out;
    out.surface.mesh = brain(vertices);
    centre_and_scale(out.surface.mesh, 1.2);
    const SimulationNodes sampled = sample_nodes(out.surface.mesh, nodes, 0);
    out.surface.weights = kernel_weights(out.surface.mesh, sampled, 2);
    const Clip clip = scripted_clip(*named_motion("strong"), sampled.position, 3);
    for (std::size_t f = 0; f < clip.frame_count(); ++f)
        out.frames.push_back(clip.frame(f));
    return out;
}

} // namespace cinch::test
