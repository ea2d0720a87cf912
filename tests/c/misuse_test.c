/* SPDX-License-Identifier: GPL-3.0-or-later */
/* misuse_test BOUNDS.jsonl: what a caller in C can do wrong is an error with its sentence, and no crash; what is right
   goes on as if nothing had been. */
#include <cinch/cinch.h>
#include <fenv.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int failures, checks;

/* The call must give that status, and for a failure a message that begins so. */
#define GIVES(status, call, message) gives(status, call, message, #call, __LINE__)
#define WORKS(call) gives(CINCH_OK, call, "", #call, __LINE__)

static void gives(cinch_status wanted, cinch_status got, const char* message, const char* call, int line)
{
    const char* said = got == CINCH_OK ? "" : cinch_error_message();
    ++checks;
    if (got == wanted && strncmp(said, message, strlen(message)) == 0 && (wanted == CINCH_OK || message[0]))
        return;
    ++failures;
    printf("line %d: %s gave %d (%s) instead of %d (%s)\n", line, call, (int)got, said, (int)wanted, message);
}

static void holds(int condition, const char* what)
{
    ++checks;
    if (!condition) {
        ++failures;
        printf("wrong: %s\n", what);
    }
}

/* A strip of 2 n triangles that two nodes move. */
enum { columns = 40, vertices = 2 * columns + 2, triangles = 2 * columns, weights = 2 * vertices };
static double position[vertices][3], weight[weights], map[2][12];
static uint32_t triangle[triangles][3], row[vertices + 1], node[weights];

static cinch_surface_arrays strip(void)
{
    cinch_surface_arrays in = {0};
    uint32_t i;
    for (i = 0; i < vertices; ++i) {
        position[i][0] = (double)(i / 2) / columns;
        position[i][1] = i % 2;
        position[i][2] = 0;
        row[i] = 2 * i;
        node[2 * i] = 0;
        node[2 * i + 1] = 1;
        weight[2 * i] = 1 - position[i][0];
        weight[2 * i + 1] = position[i][0];
    }
    row[vertices] = weights;
    for (i = 0; i < triangles; ++i) {
        triangle[i][0] = i;
        triangle[i][1] = i + 1 + i % 2;
        triangle[i][2] = i + 2 - i % 2;
    }
    in.positions = position[0];
    in.vertex_count = vertices;
    in.triangles = triangle[0];
    in.triangle_count = triangles;
    in.weight_row = row;
    in.weight_node = node;
    in.weight = weight;
    in.weight_count = weights;
    in.node_count = 2;
    return in;
}

static void rest(void)
{
    int i;
    memset(map, 0, sizeof map);
    for (i = 0; i < 2; ++i)
        map[i][0] = map[i][5] = map[i][10] = 1;
}

static void test_surfaces(void)
{
    cinch_surface_arrays in = strip();
    cinch_surface* surface = (cinch_surface*)&in;
    const uint32_t row_of_targets[2] = {0, 1}, far_vertex = vertices;
    const double away[3] = {1, 2, HUGE_VAL};
    GIVES(CINCH_ERROR_ARGUMENT, cinch_surface_from_arrays(&in, NULL), "surface is null");
    GIVES(CINCH_ERROR_ARGUMENT, cinch_surface_from_arrays(NULL, &surface), "arrays is null");
    holds(surface == NULL, "a handle is null where nothing was made");
    triangle[3][1] = vertices;
    GIVES(CINCH_ERROR_ARGUMENT, cinch_surface_from_arrays(&in, &surface),
          "surface: triangle 3: vertex 82 is not less than 82");
    in = strip();
    position[5][2] = NAN;
    GIVES(CINCH_ERROR_ARGUMENT, cinch_surface_from_arrays(&in, &surface), "surface: positions, row 5: not finite");
    in = strip();
    weight[7] = -0.25;
    GIVES(CINCH_ERROR_ARGUMENT, cinch_surface_from_arrays(&in, &surface),
          "surface: weight 7 is negative or not finite");
    in = strip();
    node[9] = 2;
    GIVES(CINCH_ERROR_ARGUMENT, cinch_surface_from_arrays(&in, &surface),
          "surface: weight, row 4: index 2 is not less than 2");
    node[9] = 0;
    GIVES(CINCH_ERROR_ARGUMENT, cinch_surface_from_arrays(&in, &surface),
          "surface: weight, row 4: indices do not ascend");
    in = strip();
    row[4] = 400;
    GIVES(CINCH_ERROR_ARGUMENT, cinch_surface_from_arrays(&in, &surface), "surface: weight_row falls after row 4");
    in = strip();
    in.weight_count = row[vertices] = weights - 2;
    GIVES(CINCH_ERROR_ARGUMENT, cinch_surface_from_arrays(&in, &surface), "to_dyadic: vertex 81 has no influence");
    in = strip();
    in.weight_count = weights - 1;
    GIVES(CINCH_ERROR_ARGUMENT, cinch_surface_from_arrays(&in, &surface),
          "surface: weight_row goes from 0 to 164, and not from 0 to 163");
    in = strip();
    in.positions = (const double*)((const char*)position + 4);
    in.vertex_count = 2;
    GIVES(CINCH_ERROR_ARGUMENT, cinch_surface_from_arrays(&in, &surface), "positions is not aligned to 8 bytes");
    in = strip();
    in.vertex_count = (size_t)-1;
    GIVES(CINCH_ERROR_ARGUMENT, cinch_surface_from_arrays(&in, &surface), "surface: vertices are 2^32 and more");
    in = strip();
    in.target_count = 1;
    in.displacement_count = 1;
    in.target_row = row_of_targets;
    in.target_vertex = &far_vertex;
    in.target_displacement = away;
    GIVES(CINCH_ERROR_ARGUMENT, cinch_surface_from_arrays(&in, &surface),
          "surface: target, row 0: index 82 is not less than 82");
    in.target_vertex = row_of_targets;
    GIVES(CINCH_ERROR_ARGUMENT, cinch_surface_from_arrays(&in, &surface),
          "surface: target_displacement, row 0: not finite");
}

static void test_handles(void)
{
    cinch_surface_arrays in = strip();
    cinch_surface *surface = NULL, *stale;
    cinch_surface_sizes sizes;
    cinch_bvh* bvh = NULL;
    cinch_bvh_sizes bvh_sizes;
    cinch_refitter* refitter = NULL;
    double* supports;
    WORKS(cinch_surface_from_arrays(&in, &surface));
    stale = surface;
    WORKS(cinch_bvh_build(surface, 4, 0, CINCH_DETAIL_ALL, &bvh));
    GIVES(CINCH_ERROR_HANDLE, cinch_surface_get_sizes((cinch_surface*)bvh, &sizes),
          "the handle of a surface is needed, and this is that of a BVH");
    GIVES(CINCH_ERROR_HANDLE, cinch_surface_get_sizes(NULL, &sizes), "the handle of a surface is needed, not null");
    GIVES(CINCH_ERROR_HANDLE, cinch_surface_get_sizes((cinch_surface*)&in, &sizes),
          "the handle of a surface is needed, and this is none");
    WORKS(cinch_free(surface));
    GIVES(CINCH_ERROR_HANDLE, cinch_surface_get_sizes(stale, &sizes), "the handle of a surface was freed");
    GIVES(CINCH_ERROR_HANDLE, cinch_free(stale), "the handle of a surface was freed");
    GIVES(CINCH_ERROR_HANDLE, cinch_free(&in), "a handle is needed, and this is none");
    WORKS(cinch_free(NULL));
    WORKS(cinch_surface_from_arrays(&in, &surface));
    holds(surface != stale, "no handle is given twice");
    WORKS(cinch_free(surface));

    /* The tree keeps the surface, and the refitter both. */
    WORKS(cinch_refitter_new(bvh, NULL, &refitter));
    WORKS(cinch_bvh_get_sizes(bvh, &bvh_sizes));
    WORKS(cinch_free(bvh));
    supports = malloc(6 * sizeof(double) * bvh_sizes.bvs);
    rest();
    map[1][11] = 0.5;
    WORKS(cinch_refitter_refit(refitter, 1, map[0], 2, NULL, 0, supports, bvh_sizes.bvs, NULL));
    holds(supports[4] >= 0.5 && supports[4] < 0.51, "the bound of the raised end");
    GIVES(CINCH_ERROR_ARGUMENT, cinch_refitter_refit(refitter, 1, map[0], 1, NULL, 0, supports, bvh_sizes.bvs, NULL),
          "refit: one transform per simulation node is needed");
    GIVES(CINCH_ERROR_ARGUMENT, cinch_refitter_refit(refitter, 1, map[0], 2, NULL, 0, supports, 1, NULL),
          "refit: supports needs k places per BV");
    GIVES(CINCH_ERROR_ARGUMENT, cinch_refitter_refit(refitter, 1, map[0], 2, map[0], 1, supports, bvh_sizes.bvs, NULL),
          "refit: one weight per morph target is needed, or none");
    GIVES(CINCH_ERROR_ARGUMENT, cinch_refitter_refit(refitter, 1, NULL, 2, NULL, 0, supports, bvh_sizes.bvs, NULL),
          "maps is null");
    GIVES(CINCH_ERROR_ARGUMENT,
          cinch_refitter_refit(refitter, (size_t)-1 / 2 + 1, map[0], 0, NULL, 0, supports, 0, NULL),
          "refit: one transform per simulation node is needed");
    map[1][3] = NAN;
    WORKS(cinch_refitter_refit(refitter, 1, map[0], 2, NULL, 0, supports, bvh_sizes.bvs, NULL));
    holds(isinf(supports[0]) && supports[0] > 0, "what is no number gives infinite bounds");
    free(supports);
    WORKS(cinch_free(refitter));
    GIVES(CINCH_ERROR_HANDLE, cinch_refitter_refit(refitter, 0, NULL, 0, NULL, 0, NULL, 0, NULL),
          "the handle of a refitter was freed");
}

static void test_options(void)
{
    cinch_surface_arrays in = strip();
    cinch_surface* surface = NULL;
    cinch_bvh *bvh = NULL, *boxes = NULL;
    cinch_refitter* refitter = NULL;
    cinch_crowd* crowd = NULL;
    cinch_refit_options options = {0};
    cinch_crowd_options crowd_options = {0};
    int32_t axes[9];
    float floats[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 4, 5, 6, 1};
    WORKS(cinch_surface_from_arrays(&in, &surface));
    GIVES(CINCH_ERROR_ARGUMENT, cinch_bvh_build(surface, 0, 0, 0, &bvh),
          "build_bvh: a leaf needs at least one triangle");
    GIVES(CINCH_ERROR_ARGUMENT, cinch_bvh_build(surface, 4, 2, 0, &bvh),
          "build_bvh: a leaf needs room for a triangle and its vertices");
    GIVES(CINCH_ERROR_ARGUMENT, cinch_bvh_build(surface, 4, 0, 3, &bvh), "there is no detail 3");
    WORKS(cinch_bvh_build(surface, 4, 0, CINCH_DETAIL_BOXES, &boxes));
    GIVES(CINCH_ERROR_ARGUMENT, cinch_refitter_new(boxes, NULL, &refitter),
          "refit: the BVH was built without the rest data that these methods need (RestDetail)");
    GIVES(CINCH_ERROR_ARGUMENT, cinch_crowd_new(boxes, NULL, &crowd),
          "crowd: the BVH was built without local boxes (RestDetail)");
    WORKS(cinch_bvh_build(surface, 4, 0, CINCH_DETAIL_ALL, &bvh));
    options.kdop = 7;
    GIVES(CINCH_ERROR_ARGUMENT, cinch_refitter_new(bvh, &options, &refitter), "k must be 6, 14, 18 or 26");
    options.kdop = 0;
    options.methods = 2 * CINCH_METHOD_VERTICES;
    GIVES(CINCH_ERROR_ARGUMENT, cinch_refitter_new(bvh, &options, &refitter), "methods: there are none");
    options.methods = 0;
    options.passes = -1;
    GIVES(CINCH_ERROR_ARGUMENT, cinch_refitter_new(bvh, &options, &refitter), "passes are 1 to 1000, not -1");
    options.passes = 0;
    options.plain = 2;
    GIVES(CINCH_ERROR_ARGUMENT, cinch_refitter_new(bvh, &options, &refitter), "plain is 0 or 1, not 2");
    crowd_options.level = -1;
    GIVES(CINCH_ERROR_ARGUMENT, cinch_crowd_new(bvh, &crowd_options, &crowd),
          "crowd: a level of the tree is needed, from 0 on");
    GIVES(CINCH_ERROR_ARGUMENT, cinch_axes(6, axes, 2), "axes has 2 rows; 3 are needed");
    WORKS(cinch_axes(0, axes, 3));
    holds(axes[0] == 1 && axes[4] == 1 && axes[8] == 1 && axes[1] == 0, "the axes of a box");
    WORKS(cinch_maps_from_floats(floats, CINCH_LAYOUT_COLUMNS_16, map[0], 1));
    holds(map[0][3] == 4 && map[0][7] == 5 && map[0][11] == 6 && map[0][0] == 1, "a map stored by columns");
    GIVES(CINCH_ERROR_ARGUMENT, cinch_maps_from_floats(floats, CINCH_LAYOUT_ROWS_16, map[0], 1),
          "the last row of map 0 is not 0 0 0 1");
    WORKS(cinch_free(surface));
    WORKS(cinch_free(boxes));
    WORKS(cinch_free(bvh));
}

static int32_t calls_back(void* collider, uint32_t a, uint32_t b)
{
    size_t count;
    (void)a;
    (void)b;
    GIVES(CINCH_ERROR_BUSY, cinch_collider_query(collider, 0, &count), "the collider is in use");
    WORKS(cinch_free(collider)); /* ends when the query does */
    return 1;
}

static void test_colliders(void)
{
    cinch_surface_arrays in = strip();
    cinch_surface *surface = NULL, *other = NULL;
    cinch_bvh* bvh = NULL;
    cinch_collider* collider = NULL;
    cinch_body_options own = {0};
    cinch_body_frame frames[2] = {{0}};
    uint32_t id = 9, pair[4];
    size_t count = 9;
    WORKS(cinch_surface_from_arrays(&in, &surface));
    WORKS(cinch_surface_from_arrays(&in, &other));
    WORKS(cinch_bvh_build(other, 16, 16, 0, &bvh));
    WORKS(cinch_collider_new(NULL, &collider));
    GIVES(CINCH_ERROR_ORDER, cinch_collider_query(collider, 0, &count), "Collider: a query before the first update()");
    GIVES(CINCH_ERROR_ARGUMENT, cinch_collider_add(collider, surface, bvh, NULL, &id),
          "Collider::add: the tree is that of another surface");
    own.kdop = 14;
    GIVES(CINCH_ERROR_ARGUMENT, cinch_collider_add(collider, surface, NULL, &own, &id),
          "Collider::add: kdop, lanes and keep_cut must be those of the collider");
    WORKS(cinch_collider_add(collider, surface, NULL, NULL, &id));
    WORKS(cinch_collider_add(collider, other, bvh, NULL, &id));
    WORKS(cinch_free(surface)); /* the collider keeps all of them */
    WORKS(cinch_free(other));
    WORKS(cinch_free(bvh));
    rest();
    frames[0].maps = frames[1].maps = map[0];
    frames[0].map_count = frames[1].map_count = 2;
    GIVES(CINCH_ERROR_ARGUMENT, cinch_collider_update(collider, frames, 1),
          "Collider::update: one frame per body is needed");
    frames[1].map_count = 1;
    GIVES(CINCH_ERROR_ARGUMENT, cinch_collider_update(collider, frames, 2),
          "refit: one transform per simulation node is needed");
    GIVES(CINCH_ERROR_ORDER, cinch_collider_query(collider, 0, &count),
          "Collider: a query after an update() that threw");
    frames[1].map_count = 2;
    WORKS(cinch_collider_update(collider, frames, 2));
    GIVES(CINCH_ERROR_ARGUMENT, cinch_collider_query(collider, 3, &count), "there is no query 3");
    WORKS(cinch_collider_query(collider, CINCH_QUERY_ANY, &count));
    holds(count == 1, "bodies at one place intersect");
    GIVES(CINCH_ERROR_ARGUMENT, cinch_collider_get_pairs(collider, pair, 2), "pairs has 2 rows; 1 are needed");
    WORKS(cinch_collider_get_pairs(collider, pair, 1));
    holds(pair[0] == 0 && pair[2] == 1, "the bodies of the pair");
    GIVES(CINCH_ERROR_ARGUMENT, cinch_collider_remove(collider, 7), "Collider::remove: there is no body 7");
    WORKS(cinch_collider_set_filter(collider, calls_back, collider));
    WORKS(cinch_collider_query(collider, CINCH_QUERY_PAIRS, &count));
    holds(count > triangles, "the query whose collider was freed meanwhile");
    GIVES(CINCH_ERROR_HANDLE, cinch_collider_remove(collider, 0), "the handle of a collider was freed");
}

static void test_arithmetic(void)
{
    cinch_surface_arrays in = strip();
    cinch_surface* surface = NULL;
    GIVES(CINCH_ERROR_ORDER, cinch_end_default_arithmetic(), "cinch_end_default_arithmetic: nothing was begun");
    fesetround(FE_UPWARD);
    GIVES(CINCH_ERROR_RUNTIME, cinch_check_arithmetic(), "the rounding mode is not to-nearest");
    GIVES(CINCH_ERROR_RUNTIME, cinch_surface_from_arrays(&in, &surface), "the rounding mode is not to-nearest");
    WORKS(cinch_begin_default_arithmetic());
    WORKS(cinch_surface_from_arrays(&in, &surface));
    WORKS(cinch_end_default_arithmetic());
    holds(fegetround() == FE_UPWARD, "the arithmetic is what it was");
    fesetround(FE_TONEAREST);
    WORKS(cinch_free(surface));
}

static void test_files(const char* bounds)
{
    cinch_character* character = NULL;
    cinch_baked* baked = NULL;
    cinch_baked_clip clip;
    size_t clips = 0;
    double box[6];
    GIVES(CINCH_ERROR_INPUT, cinch_character_read("no.glb", 0, &character), "no.glb: ");
    GIVES(CINCH_ERROR_ARGUMENT, cinch_character_read(NULL, 0, &character), "path is null");
    GIVES(CINCH_ERROR_INPUT, cinch_baked_read("no.jsonl", &baked, &clips), "no.jsonl: ");
    WORKS(cinch_baked_read(bounds, &baked, &clips));
    holds(clips == 1, "the clips of the file of bounds");
    WORKS(cinch_baked_get_clip(baked, 0, &clip));
    holds(strcmp(clip.name, "wave") == 0 && clip.kdop == 6 && clip.bvs == 1, "its clip");
    WORKS(cinch_baked_box(baked, 0, 0.25, 0, box));
    holds(box[0] < box[3] && box[0] == -0.06185671967636485, "its box");
    GIVES(CINCH_ERROR_ARGUMENT, cinch_baked_box(baked, 0, NAN, 0, box), "no interval of clip 'wave' holds ");
    GIVES(CINCH_ERROR_ARGUMENT, cinch_baked_box(baked, 0, 0, 1, box), "there is no BV 1 of 1");
    GIVES(CINCH_ERROR_ARGUMENT, cinch_baked_get_clip(baked, 1, &clip), bounds);
    WORKS(cinch_free(baked));
}

int main(int argc, char** argv)
{
    holds(cinch_error_message()[0] == 0, "no message before the first failure");
    holds(strncmp(cinch_version(), "0.", 2) == 0, "the version");
    test_surfaces();
    test_handles();
    test_options();
    test_colliders();
    test_arithmetic();
    if (argc > 1 && cinch_parts() & CINCH_PART_IO)
        test_files(argv[1]);
    printf("%d of %d checks failed\n", failures, checks);
    return failures != 0;
}
