/* SPDX-License-Identifier: GPL-3.0-or-later */
/* In C: proven boxes of a character's clips, each for all times: c_bounds FILE.glb */
#include <cinch/cinch.h>
#include <stdio.h>
#include <stdlib.h>

static void need(cinch_status status)
{
    if (status == CINCH_OK)
        return;
    fprintf(stderr, "%s\n", cinch_error_message());
    exit(2);
}

int main(int argc, char** argv)
{
    cinch_character* character;
    cinch_surface* surface;
    cinch_bvh* bvh;
    cinch_bvh_sizes sizes;
    size_t clips, clip;
    double* supports;

    need(cinch_character_read(argc > 1 ? argv[1] : "character.glb", 0, &character));
    need(cinch_character_get_surface(character, &surface, &clips));
    need(cinch_bvh_build(surface, 4, 0, CINCH_DETAIL_ALL, &bvh)); /* at most 4 triangles per leaf */
    need(cinch_bvh_get_sizes(bvh, &sizes));
    supports = malloc(sizes.bvs * 6 * sizeof *supports);
    if (!supports)
        return 2;
    for (clip = 0; clip < clips; ++clip) {
        cinch_clip_bounder* bounder;
        cinch_clip_info info;
        double times[2], box[6];
        need(cinch_character_get_clip(character, clip, &info));
        need(cinch_clip_bounder_new(character, clip, bvh, NULL, &bounder));
        times[0] = info.first_s;
        times[1] = info.last_s;
        need(cinch_clip_bounder_bound(bounder, times, 1, 0.01, supports, sizes.bvs)); /* at every real time between */
        need(cinch_boxes_of(supports, 6, box, 1));                                    /* of the root */
        printf("%s: %g %g %g to %g %g %g\n", info.name, box[0], box[1], box[2], box[3], box[4], box[5]);
        cinch_free(bounder);
    }
    free(supports);
    cinch_free(bvh);
    cinch_free(surface);
    cinch_free(character);
    return 0;
}
