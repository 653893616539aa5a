/* SPDX-License-Identifier: MIT */
/* What a view asks, and what it has seen: of a World, or of a list of boxes. docs/world.md and docs/occlude.md are the
 * guides. */
#ifndef CROFTON_CAPI_VIEW_H
#define CROFTON_CAPI_VIEW_H
#include <crofton/capi/base.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum crofton_verdict { CROFTON_OUTSIDE = 0, CROFTON_STRADDLING = 1, CROFTON_INSIDE = 2 } crofton_verdict;

/* What is not worth drawing: too small or too far; docs/lights.md. */
typedef struct crofton_draw_limits {
    size_t size;
    double eye[3];
    double max_distance_in_radii; /* farther than so many times its radius; 0: no limit */
    double least_radius;          /* smaller than this */
    const float* layer_distances; /* 32, or NULL */
    const float* item_distances;  /* by item id or object index, or NULL */
    size_t item_count;
    const uint64_t* drawn_before; /* bit i % 64 of word i / 64 for item i, or NULL */
    size_t drawn_word_count;
    double hysteresis; /* times as long are the limits of what was drawn before; 0: 1 */
} crofton_draw_limits;

#define CROFTON_MAX_CLUSTER_TRIANGLES 64u

/* The triangles [first_triangle, first_triangle + triangle_count) of the order, and a box in the mesh's coordinates
 * that contains them. */
typedef struct crofton_cluster {
    uint32_t first_triangle, triangle_count; /* 1 to CROFTON_MAX_CLUSTER_TRIANGLES */
    float center[3];
    float half_edges[9]; /* half_edges[3 k + i] is component i of edge k; center +- each edge gives the corners */
} crofton_cluster;

/* How a mesh is cut. Triangle triangle_order[k] of the mesh that was given is number k of the order. */
typedef struct crofton_clusters {
    const crofton_cluster* clusters;
    size_t cluster_count;
    const uint32_t* triangle_order;
    size_t triangle_count;
} crofton_clusters;

/* The picture that is drawn: one sample a pixel, at its centre. */
typedef struct crofton_picture_view {
    size_t size;
    uint32_t width, height; /* 1280 and 720; 1 to 16384 */
    uint32_t depth;         /* a crofton_depth_range; CROFTON_DEPTH_REVERSED_ZERO_TO_ONE */
} crofton_picture_view;

/* Bit k of `triangles` stands for triangle first_triangle + k of the cluster; at least one is set. */
typedef struct crofton_visible_cluster {
    uint32_t object, cluster;
    uint64_t triangles;
} crofton_visible_cluster;

/* How a view leaves out what other objects hide. */
typedef struct crofton_occlusion_options {
    size_t size;
    uint32_t width, height; /* of the depth buffer: 480 and 270; more pixels find more and cost more */
    uint32_t max_occluders; /* 256: draws at most so many, those that are worth most to the view */
    uint32_t list_occluded; /* 0; 1: also lists what is hidden, which costs a second query */
    float least_cover;      /* 2e-5: does not draw what covers a smaller part of the sphere of directions */
} crofton_occlusion_options;

/* An engine's own matrix, from positions relative to `origin` to clip space, for column vectors. */
typedef struct crofton_view_matrix {
    size_t size;
    const double* doubles; /* sixteen numbers, */
    const float* floats;   /* or these: set one of the two */
    uint32_t is_row_major; /* 0: column by column; 1: row by row */
    uint32_t depth;        /* a crofton_depth_range; CROFTON_DEPTH_REVERSED_ZERO_TO_ONE */
    double origin[3];      /* 0, 0, 0 */
} crofton_view_matrix;

/* What a view asks. All that is set counts, in every combination, or the call is refused by name. */
typedef struct crofton_view_request {
    size_t size;
    const crofton_camera* camera;      /* set one of the three; NULL */
    const crofton_view_matrix* matrix; /* NULL */
    const crofton_frustum* volume;     /* NULL. Any convex volume. For occlusion set camera or matrix, too: objects are
                                          tested against the volume instead of theirs */
    uint32_t layers;                   /* all: lists objects that share a layer with these */
    const crofton_occlusion_options* occlusion; /* NULL: lists what other objects hide, too */
    const crofton_draw_limits* limits;          /* NULL: lists what is small or far, too */
    const uint64_t* candidate_mask; /* NULL, or bit i % 64 of word i / 64: may object i be seen, as crofton_pvs_visible
                                       gives it. Objects beyond the end may, and so may those that have moved since
                                       their first update or reuse an index */
    size_t candidate_words;
    uint32_t conservative; /* 0: exact; 1: planes only, which keeps some boxes near the volume's corners */
    uint32_t tree_order;   /* 0: indices ascend; 1: as the tree lies in memory, in half the time where much is seen */
    const crofton_picture_view* picture; /* NULL, or in place of `occlusion`: also lists the triangles without which
                                            this picture would change, of objects whose mesh has `clusters`; others are
                                            listed where their boxes may be seen */
} crofton_view_request;

typedef struct crofton_view_result crofton_view_result; /* what one view sees, or up to 32; its memory is kept */

/* What is known of one view. Pointers hold until the result's next view. */
typedef struct crofton_view_info {
    size_t size;
    /* Counts of the query by the volume. 0 for a view that is one of several, and for one with occlusion unless it
     * lists what is occluded or is in tree order. */
    uint64_t nodes_tested, boxes_tested, accepted_whole, straddling, exact_tests, false_positives;
    /* With occlusion, else 0. Nodes are the tree's; nothing below those that are hidden was looked at. */
    uint64_t occluders_drawn, occluder_pieces_drawn, occluder_triangles_drawn;
    uint64_t occlusion_nodes_tested, occlusion_nodes_outside, occlusion_nodes_hidden;
    uint64_t occlusion_items_tested, occlusion_items_hidden;
    const uint32_t* occluded_ids; /* with list_occluded: in the volume and hidden, ascending */
    size_t occluded_count;
    uint32_t depth_width, depth_height; /* of the depth buffer: crofton_view_result_depth */
    /* With a picture: what to draw, by object index, then by cluster of its mesh (crofton_world_get_mesh). */
    const crofton_visible_cluster* triangles;
    size_t triangle_cluster_count; /* of `triangles` */
    /* As crofton_depth_statistics. */
    uint64_t objects_listed, objects_asked, clusters_asked, clusters_drawn, triangles_drawn, triangles_listed;
} crofton_view_info;

CROFTON_API crofton_draw_limits crofton_default_draw_limits(void);
CROFTON_API crofton_picture_view crofton_default_picture_view(void);
CROFTON_API crofton_occlusion_options crofton_default_occlusion_options(void);
CROFTON_API crofton_view_matrix crofton_default_view_matrix(void);
CROFTON_API crofton_view_request crofton_default_view_request(void);

/* Limits for a camera: nothing whose sphere is less than `pixels` wide in a picture so many pixels high. Each is judged
 * as if it were in the middle. Fills a struct whose `size` is set; all else is 0. */
CROFTON_API crofton_status crofton_draw_limits_of_camera(const crofton_camera* camera, double picture_height,
                                                         double pixels, crofton_draw_limits* limits);

CROFTON_API crofton_status crofton_view_result_create(crofton_view_result** result);
CROFTON_API crofton_status crofton_view_result_destroy(crofton_view_result* result);

/* The indices of the objects, items or boxes; valid until the result's next view.
 *
 * Of one view in tree order, the first *inside_count (or NULL) lie inside its volume. In ascending order *verdicts (or
 * NULL) are a crofton_verdict each. Otherwise they are 0 and NULL. */
CROFTON_API crofton_status crofton_view_result_ids(const crofton_view_result* result, const uint32_t** ids,
                                                   size_t* count, const uint8_t** verdicts, size_t* inside_count);
/* Fills a struct whose `size` is set: what is known of view number `view`. CROFTON_OUT_OF_RANGE: there are fewer. */
CROFTON_API crofton_status crofton_view_result_get_view(const crofton_view_result* result, size_t view,
                                                        crofton_view_info* info);
/* Writes the depth buffer of view number `view`: depth_width * depth_height numbers, at most `capacity`, row by row
 * from the bottom. They are the occluders' nearness: 1 / w (parallel views: minus the distance); below -1e38 where
 * nothing is drawn. CROFTON_EMPTY: the view was without occlusion. */
CROFTON_API crofton_status crofton_view_result_depth(const crofton_view_result* result, size_t view, float* nearness,
                                                     size_t capacity);

/* Finds which boxes of a plain list a view sees; box i is seen in the layers layer_masks[i] (or NULL: in all). `jobs`
 * or NULL. CROFTON_UNSUPPORTED: a request with occlusion or a picture. Allocates nothing once `result` has grown to the
 * largest answer. */
CROFTON_API crofton_status crofton_view_boxes(const crofton_box* boxes, const uint32_t* layer_masks, size_t count,
                                              const crofton_view_request* request, const crofton_jobs* jobs,
                                              crofton_view_result* result);
/* Writes verdicts[i] for boxes[i], exactly. */
CROFTON_API crofton_status crofton_classify(const crofton_frustum* frustum, const crofton_box* boxes, size_t count,
                                            uint8_t* verdicts);

#ifdef __cplusplus
}
#endif
#endif
