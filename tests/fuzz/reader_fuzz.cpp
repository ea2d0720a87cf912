// SPDX-License-Identifier: GPL-3.0-or-later
// Any bytes either load or are refused with InputError; what loads is consistent. Sanitizers watch the rest.
#include <cmath>
#include <cstdlib>

#include "toolkit/surface/character.hpp"
#include "toolkit/surface/input_error.hpp"
#include "toolkit/surface/read_mesh.hpp"
#include "toolkit/surface/skin.hpp"

namespace {

using namespace cinch;

void require(bool condition)
{
    if (!condition)
        std::abort();
}

void check(const TriangleMesh& mesh)
{
    for (const Vec3& v : mesh.vertices)
        require(std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]));
    for (const Triangle& t : mesh.triangles)
        for (std::uint32_t v : t)
            require(v < mesh.vertices.size());
}

void check(const MeshFile& file)
{
    check(file.mesh);
    for (const std::string& note : file.notes)
        require(!note.empty() && note.find('\n') == std::string::npos);
}

void check(const Influences& influences, std::size_t vertices)
{
    require(influences.row.size() == vertices + 1 && influences.row.back() == influences.node.size());
    for (std::size_t i = 0; i < influences.node.size(); ++i)
        require(influences.node[i] < influences.node_count && influences.weight[i] >= 0);
}

void read([[maybe_unused]] std::string_view bytes)
{
#if defined(CINCH_FUZZ_obj)
    check(parse_obj(bytes, "fuzz.obj"));
#elif defined(CINCH_FUZZ_off)
    check(parse_off(bytes, "fuzz.off"));
#elif defined(CINCH_FUZZ_ply)
    check(parse_ply(bytes, "fuzz.ply"));
#elif defined(CINCH_FUZZ_stl)
    check(parse_stl(bytes, "fuzz.stl"));
#elif defined(CINCH_FUZZ_gltf)
    const Character character = parse_gltf(bytes, "fuzz.gltf");
    check(character.mesh);
    check(character.influences, character.mesh.vertices.size());
    rest_pose(character);
    for (const auto& animation : character.animations)
        sample(character, animation, 1e-3);
#elif defined(CINCH_FUZZ_weights)
    check(parse_weights_text(bytes, "fuzz.txt", 3), 3);
#elif defined(CINCH_FUZZ_clips)
    for (const Clip& clip : parse_clips_text(bytes, "fuzz.txt", 2))
        for (const auto& frame : clip.frames)
            require(frame.size() == 2);
#endif
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    try {
        read({reinterpret_cast<const char*>(data), size});
    } catch (const InputError& error) {
        require(std::string_view(error.what()).find('\n') == std::string_view::npos);
    }
    return 0;
}
