/* SPDX-License-Identifier: MIT */
/* Views of a World that leave out what is hidden: occluders in, what is seen out. docs/occlude.md is the guide. */
#ifndef CROFTON_CAPI_WORLD_OCCLUSION_H
#define CROFTON_CAPI_WORLD_OCCLUSION_H
#include <crofton/capi/world_queries.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The structs of this header may grow, as those of world.h. */

typedef enum crofton_occluder_kind {
    CROFTON_OCCLUDER_BOX = 0,    /* inside a closed piece of the mesh */
    CROFTON_OCCLUDER_WALLED = 1, /* a box behind walls of the mesh, that may be open on some sides */
    CROFTON_OCCLUDER_CONVEX = 2, /* the convex hull of the positions */
    CROFTON_OCCLUDER_PATCH = 3   /* any triangles */
} crofton_occluder_kind;

/* In the mesh's frame: within what is drawn of it, and opaque. */
typedef struct crofton_occluder {
    size_t size;
    uint32_t kind;          /* a crofton_occluder_kind */
    uint32_t is_one_sided;  /* of a patch, 1: it hides only from where its triangles are counter-clockwise */
    const float* positions; /* x y z, packed; of a box that is given they may be missing */
    size_t position_count;
    const uint32_t* indices; /* of a convex hull that is given they may be missing */
    size_t index_count;
    crofton_box box;                   /* of a box, walled or not */
    uint32_t edges;                    /* what it costs; 0: estimated */
    uint32_t has_piece, has_eyes;      /* 1: the next members count */
    double piece_min[3], piece_max[3]; /* an eye in here does not use it */
    double eyes_min[3], eyes_max[3];   /* an eye must be in here; may be infinite */
    double mean_shadow, gain;          /* of what was found: how much it covers, and adds to those before it */
} crofton_occluder;

/* 0 is the default of every member. */
typedef struct crofton_find_options {
    size_t size;
    uint32_t is_two_sided; /* 1: back faces are drawn as well */
    uint32_t max_occluders, max_edges, max_boxes_a_piece, grid;
    double least_gain, flatness;
} crofton_find_options;

/* What is not worth drawing: too small or too far; docs/lights.md. */
typedef struct crofton_draw_limits {
    size_t size;
    double eye[3];
    double radii;                 /* farther than so many times its radius; 0: no limit */
    double least_radius;          /* smaller than this */
    const float* layer_distances; /* 32, or NULL */
    const float* item_distances;  /* by object index, or NULL */
    size_t item_count;
    const uint64_t* drawn_before; /* bit i % 64 of word i / 64 for object i, or NULL */
    size_t drawn_word_count;
    double longer; /* times as long are the limits of what was drawn before; 0: 1 */
} crofton_draw_limits;

typedef struct crofton_occlusion_options {
    size_t size;
    uint32_t disabled;      /* 1: without occlusion, for comparison */
    uint32_t width, height; /* of the depth buffer; 0: 480 and 270 */
    uint32_t max_occluders; /* drawn; 0: 256 */
    uint32_t list_occluded; /* 1: also list what is hidden */
    float least_cover;      /* of the sphere of directions; 0: 2e-5 */
} crofton_occlusion_options;

/* From a camera or from an engine's own matrix. */
typedef struct crofton_occluding_view {
    size_t size;
    const crofton_camera* camera; /* or NULL: then */
    const double* to_clip;        /* 16 numbers, as crofton_frustum_from_matrix takes them, relative to `origin` */
    double origin[3];
    uint32_t depth;                    /* a crofton_depth_range */
    uint32_t hidden_layers;            /* not drawn; 0: all are */
    const crofton_draw_limits* limits; /* or NULL */
} crofton_occluding_view;

typedef struct crofton_occlusion_statistics {
    size_t size;
    uint64_t occluders_drawn, pieces_drawn, triangles_drawn;
    uint64_t nodes_tested, nodes_outside, nodes_hidden; /* of the tree; nothing below the latter was looked at */
    uint64_t items_tested, items_hidden;
} crofton_occlusion_statistics;

typedef struct crofton_occluder_ref {
    crofton_object object;
    uint64_t user;
    uint32_t place; /* among the occluders of the object's mesh */
    uint32_t unused;
} crofton_occluder_ref;

/* Looks for occluders in a mesh; `options` or NULL. They take effect in the next update. Takes a second or more for
 * 100,000 triangles. */
CROFTON_API crofton_status crofton_world_find_occluders(crofton_world* world, crofton_world_mesh mesh,
                                                        const crofton_find_options* options);
/* Gives a mesh its occluders: those stored of an earlier search, or the caller's own; none: count 0. All have the same
 * `size` and lie so far apart. crofton_last_error_item is the place of one that is refused; then all is as before. */
CROFTON_API crofton_status crofton_world_set_occluders(crofton_world* world, crofton_world_mesh mesh,
                                                       const crofton_occluder* occluders, size_t count);
CROFTON_API crofton_status crofton_world_occluder_count(const crofton_world* world, crofton_world_mesh mesh,
                                                        size_t* count);
/* Fills a struct whose `size` is set; its arrays are valid until the mesh's occluders change. */
CROFTON_API crofton_status crofton_world_get_occluder(const crofton_world* world, crofton_world_mesh mesh, size_t place,
                                                      crofton_occluder* occluder);
/* Whether an object with a mesh hides others (1, as at first) or not (0), as where it is drawn transparent. */
CROFTON_API crofton_status crofton_world_set_occludes(crofton_world* world, crofton_object object, int occludes);

/* As crofton_world_view, ascending, without what is hidden; `occlusion`, `options`, `jobs` or NULL. */
CROFTON_API crofton_status crofton_world_view_occluding(const crofton_world* world, const crofton_occluding_view* view,
                                                        const crofton_occlusion_options* occlusion,
                                                        const crofton_cull_options* options, const crofton_jobs* jobs,
                                                        crofton_visible_objects* visible);
/* Up to 32 views of one `size`, which lie so far apart. The limits of the first count for all. */
CROFTON_API crofton_status crofton_world_views_occluding(const crofton_world* world,
                                                         const crofton_occluding_view* views, size_t count,
                                                         const crofton_occlusion_options* occlusion,
                                                         const crofton_cull_options* options, const crofton_jobs* jobs,
                                                         crofton_visible_in_views* visible);

/* Indices of what is in the view's frustum and hidden, ascending; none unless list_occluded asked for it. */
CROFTON_API crofton_status crofton_visible_objects_occluded_ids(const crofton_visible_objects* visible,
                                                                const uint32_t** ids, size_t* count);
/* All 0 after a view without occlusion. */
CROFTON_API crofton_status crofton_visible_objects_get_occlusion_statistics(const crofton_visible_objects* visible,
                                                                            crofton_occlusion_statistics* statistics);
/* Of a view; CROFTON_OUT_OF_RANGE where there are fewer with occlusion. */
CROFTON_API crofton_status crofton_visible_in_views_get_occlusion_statistics(const crofton_visible_in_views* visible,
                                                                             size_t view,
                                                                             crofton_occlusion_statistics* statistics);
/* The depth buffer: its size, and where `nearness` is not NULL and has room for width * height numbers, row by row from
 * the bottom, 1 / w (parallel views: minus the distance) of the occluders; below -1e38 where there are none.
 * CROFTON_EMPTY after a view without occlusion. */
CROFTON_API crofton_status crofton_visible_objects_depth(const crofton_visible_objects* visible, uint32_t* width,
                                                         uint32_t* height, float* nearness, size_t capacity);
CROFTON_API crofton_status crofton_visible_in_views_depth(const crofton_visible_in_views* visible, size_t view,
                                                          uint32_t* width, uint32_t* height, float* nearness,
                                                          size_t capacity);
/* Both write at most `capacity` occluders, and how many there are to *count. `world` is the one that was viewed; ask
 * before its next update. The first names those that hide an object, none where it is not hidden, and is slow. */
CROFTON_API crofton_status crofton_world_hidden_by(const crofton_world* world, crofton_object object,
                                                   const crofton_visible_objects* visible,
                                                   crofton_occluder_ref* occluders, size_t capacity, size_t* count);
CROFTON_API crofton_status crofton_world_drawn_occluders(const crofton_world* world,
                                                         const crofton_visible_objects* visible,
                                                         crofton_occluder_ref* occluders, size_t capacity,
                                                         size_t* count);

#ifdef __cplusplus
}
#endif
#endif
