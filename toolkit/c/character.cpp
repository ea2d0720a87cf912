// SPDX-License-Identifier: Apache-2.0
#include "toolkit/c/character.hpp"

#include <cmath>

#include "toolkit/c/arrays.hpp"
#include "toolkit/c/call.hpp"

namespace cinch::c {
namespace {

struct Frames {
    static constexpr Kind kind = Kind::clip;
    using Handle = cinch_clip;

    Clip clip; // owns what it needs
    std::size_t nodes, targets;
};

} // namespace

const Decompression* decoders()
{
#if CINCH_C_COMPRESSION
    return &decompression();
#else
    return nullptr;
#endif
}

const Character::Animation& CharacterFile::clip(std::size_t clip) const
{
    if (clip == CINCH_REST)
        return character.rest;
    if (clip >= character.animations.size())
        throw std::invalid_argument(character.file + ": there is no clip " + std::to_string(clip) + " of " +
                                    std::to_string(character.animations.size()));
    return character.animations[clip];
}

} // namespace cinch::c

using namespace cinch;
using namespace cinch::c;

cinch_status cinch_character_read(const char* path, int32_t partial, cinch_character** character)
{
    return call([&] {
        given(character, "character") = nullptr;
        const std::filesystem::path file = &given(path, "path");
        auto made = std::make_shared<CharacterFile>();
        made->character = read_gltf(file, partial != 0 ? Coverage::partial : Coverage::whole, Morphs::read, decoders());
        auto surface = std::make_shared<Surface>();
        surface->surface = std::make_shared<const DeformableSurface>(surface_of(made->character, &surface->report));
        // Those of the character, which ends after the surface.
        surface->targets = std::make_shared<const std::vector<MorphTarget>>(made->character.targets);
        made->surface = std::move(surface);
        *character = put(std::move(made));
    });
}

cinch_status cinch_character_get_surface(const cinch_character* character, cinch_surface** surface, size_t* clips)
{
    return call([&] {
        given(surface, "surface") = nullptr;
        const auto of = get<CharacterFile>(character);
        given(clips, "clips") = of->character.animations.size();
        *surface = put(of->surface);
    });
}

cinch_status cinch_character_get_clip(const cinch_character* character, size_t clip, cinch_clip_info* info)
{
    return call([&] {
        const auto of = get<CharacterFile>(character);
        const Character::Animation& animation = of->clip(clip);
        given(info, "info") = {animation.name.c_str(), animation.first_s, animation.last_s};
    });
}

cinch_status cinch_character_sample(const cinch_character* character, size_t clip, double fps, cinch_clip** frames_of,
                                    size_t* frames)
{
    return call([&] {
        given(frames_of, "frames_of") = nullptr;
        const auto of = get<CharacterFile>(character);
        const Character::Animation& animation = of->clip(clip);
        if (!(fps > 0 && std::isfinite(fps)))
            throw std::invalid_argument("fps must be above 0 and finite");
        auto made = std::make_shared<Frames>(
            Frames{clip == CINCH_REST ? rest_pose(of->character) : sample(of->character, animation, fps),
                   of->surface->nodes(), of->surface->targets->size()});
        given(frames, "frames") = made->clip.frame_count();
        *frames_of = put(std::move(made));
    });
}

cinch_status cinch_clip_get_frame(const cinch_clip* clip, size_t frame, double* time_s, double* maps, size_t map_count,
                                  double* weights, size_t weight_count)
{
    return call([&] {
        const auto of = get<Frames>(clip);
        if (frame >= of->clip.frame_count())
            throw std::invalid_argument("there is no frame " + std::to_string(frame) + " of " +
                                        std::to_string(of->clip.frame_count()));
        const auto moved = array_of<AffineMap>(maps, map_count, of->nodes, "maps");
        const auto by = array_of<double>(weights, weight_count, weights ? of->targets : 0, "weights");
        given(time_s, "time_s") = of->clip.time_s(frame);
        const Clip::Frame at = of->clip.frame(frame);
        std::copy(at.begin(), at.end(), moved.begin());
        if (by.empty())
            return;
        std::vector<double> there = of->clip.weights(frame);
        there.resize(by.size()); // where none displaces anything
        std::copy(there.begin(), there.end(), by.begin());
    });
}
