/* SPDX-License-Identifier: Apache-2.0 */
#ifndef CINCH_CINCH_IO_H
#define CINCH_CINCH_IO_H

/// \file
/// The part of cinch.h, which includes it, that needs files: CINCH_PART_IO and for scenes CINCH_PART_SIMULATE; without
/// them CINCH_ERROR_ABSENT. Paths are as the system has them, strings end with 0.

#include "cinch/cinch.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cinch_character cinch_character;       ///< a glTF file; never changes
typedef struct cinch_clip cinch_clip;                 ///< frames of a character; never changes
typedef struct cinch_clip_bounder cinch_clip_bounder; ///< bounds of every BV for all times of a clip
typedef struct cinch_simulation cinch_simulation;     ///< a scene on its way through time
typedef struct cinch_baked cinch_baked;               ///< the bounds of a file of `cinch bake --json`; never changes

/// A mesh (OBJ, OFF, PLY, STL) and its weights as text (`V J`, then `n j1 w1 ... jn wn` per vertex).
CINCH_API cinch_status cinch_surface_read(const char* mesh, const char* weights, cinch_surface** surface);

/* ------------------------------------- characters and their clips -------------------------------- */

/// A clip of a character.
typedef struct cinch_clip_info {
    const char* name; ///< as the file has it; while the handle that was asked is not freed
    double first_s;   ///< time of its first key
    double last_s;    ///< and of its last one
} cinch_clip_info;
/// The pose of the file, as a clip that moves nothing.
#define CINCH_REST ((size_t)-1)

/// A .gltf, .glb or .vrm file with its skins, parts carried by nodes, and morph targets. `partial` 1: what is not
/// modelled is left out; 0: it is an error. What is compressed needs CINCH_PART_COMPRESSION.
CINCH_API cinch_status cinch_character_read(const char* path, int32_t partial, cinch_character** character);
/// Its surface, with its morph targets; every call makes a handle of the same one. `clips` says how many clips there
/// are.
CINCH_API cinch_status cinch_character_get_surface(const cinch_character* character, cinch_surface** surface,
                                                   size_t* clips);
/// clip < clips, or CINCH_REST.
CINCH_API cinch_status cinch_character_get_clip(const cinch_character* character, size_t clip, cinch_clip_info* info);
/// Frames of a clip, evenly spaced, both ends included; `frames` says how many.
CINCH_API cinch_status cinch_character_sample(const cinch_character* character, size_t clip, double fps,
                                              cinch_clip** frames_of, size_t* frames);
/// A frame: time, maps (map_count = nodes, 12), weights of morph targets (weight_count = targets, or 0: not wanted).
CINCH_API cinch_status cinch_clip_get_frame(const cinch_clip* clip, size_t frame, double* time_s, double* maps,
                                            size_t map_count, double* weights, size_t weight_count);
/// Bounds for all times of a clip; `bvh` is one of the character's surface.
CINCH_API cinch_status cinch_clip_bounder_new(const cinch_character* character, size_t clip, const cinch_bvh* bvh,
                                              const cinch_refit_options* options, cinch_clip_bounder** bounder);
/// Bounds of every BV at every real time of each interval: (support_count = intervals * bvs, k). `times`: (intervals,
/// 2) in s, within those of the clip. Wider than bounds at single times by at most `tolerance` of a BV's greatest half
/// extent, where that can be had; 0.01 is usual.
CINCH_API cinch_status cinch_clip_bounder_bound(cinch_clip_bounder* bounder, const double* times, size_t intervals,
                                                double tolerance, double* supports, size_t support_count);

/* ------------------------------------------ scenes (CINCH_PART_SIMULATE) ----------------------------------------- */

/// Where a scene is.
typedef struct cinch_simulation_state {
    size_t bodies; ///< of the scene
    size_t frame;  ///< at present, from 0
    size_t frames; ///< that the scene asks for
    double time_s; ///< since its start
} cinch_simulation_state;

/// A scene's file (JSON).
CINCH_API cinch_status cinch_simulation_read(const char* path, cinch_simulation** simulation);
/// Where it is.
CINCH_API cinch_status cinch_simulation_get_state(const cinch_simulation* simulation, cinch_simulation_state* state);
/// A body: its name, while the handle is not freed; and its surface, null where it has none.
CINCH_API cinch_status cinch_simulation_get_body(const cinch_simulation* simulation, size_t body, const char** name,
                                                 cinch_surface** surface);
/// To the next frame; where that fails, nowhere.
CINCH_API cinch_status cinch_simulation_advance(cinch_simulation* simulation);
/// Maps of a body at present; `count` says how many; null: the number alone.
CINCH_API cinch_status cinch_simulation_get_maps(const cinch_simulation* simulation, size_t body, double* maps,
                                                 size_t capacity, size_t* count);

/* ------------------------------------ bounds that were baked -------------------------------------- */

/// A clip of a file of bounds.
typedef struct cinch_baked_clip {
    const char* input;     ///< the file of which it is; like all texts here while the handle is not freed
    const char* name;      ///< of the clip
    const char* statement; ///< what the bounds contain
    double first_s;        ///< when its intervals begin
    double last_s;         ///< when they end
    size_t intervals;      ///< of time
    size_t bvs;            ///< of each interval, the first ones of the tree
    int32_t kdop;          ///< of the bounds
    int32_t partial;       ///< 1: parts of the input were left out, or the run was not complete
} cinch_baked_clip;

/// What `cinch bake FILE --json` wrote. Other records are passed over.
CINCH_API cinch_status cinch_baked_read(const char* path, cinch_baked** baked, size_t* clips);
/// clip < clips.
CINCH_API cinch_status cinch_baked_get_clip(const cinch_baked* baked, size_t clip, cinch_baked_clip* info);
/// All of a clip: times, (intervals, 2), and supports, (support_count = intervals * bvs, k).
CINCH_API cinch_status cinch_baked_get_supports(const cinch_baked* baked, size_t clip, double* times, size_t intervals,
                                                double* supports, size_t support_count);
/// The box of one BV at a time of the clip: of an interval that holds it.
CINCH_API cinch_status cinch_baked_box(const cinch_baked* baked, size_t clip, double time_s, size_t bv, double box[6]);

#ifdef __cplusplus
}
#endif

#endif
