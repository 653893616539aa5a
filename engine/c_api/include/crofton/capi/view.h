/* SPDX-License-Identifier: MIT */
/* Requests and results of views: of a World, or of a list of boxes. Guides: docs/world.md, docs/occlude.md. */
#ifndef CROFTON_CAPI_VIEW_H
#define CROFTON_CAPI_VIEW_H
#include <crofton/capi/base.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum crofton_verdict { CROFTON_OUTSIDE = 0, CROFTON_STRADDLING = 1, CROFTON_INSIDE = 2 } crofton_verdict;

/* Leaves out objects that are too small or too far away. Guide: docs/lights.md. */
typedef struct crofton_draw_limits {
    size_t size;
    double eye[3];
    double max_distance_in_radii; /* leaves out what is farther than this times its radius; 0: no limit */
    double least_radius;          /* leaves out what is smaller */
    const float* layer_distances; /* 32, or NULL */
    const float* item_distances;  /* by item id or object index, or NULL */
    size_t item_count;
    const uint64_t* drawn_before; /* bit i % 64 of word i / 64 for item i, or NULL */
    size_t drawn_word_count;
    double hysteresis; /* limits of items that were drawn before are this many times as long; 0: 1 */
} crofton_draw_limits;

#define CROFTON_MAX_CLUSTER_TRIANGLES 64u

/* The triangles [first_triangle, first_triangle + triangle_count) in the order of the clusters. */
typedef struct crofton_cluster {
    uint32_t first_triangle, triangle_count; /* 1 to CROFTON_MAX_CLUSTER_TRIANGLES */
} crofton_cluster;

/* Contains a cluster's triangles, in the mesh's coordinates. */
typedef struct crofton_cluster_box {
    float center[3];
    float half_edges[9]; /* half_edges[3 k + i] is component i of edge k; center +- each edge gives the corners */
} crofton_cluster_box;

typedef struct crofton_clustered_mesh crofton_clustered_mesh; /* a mesh cut into clusters */

/* In which order indices that are lent to a clustered mesh have the triangles. */
typedef enum crofton_index_order {
    CROFTON_INDEX_ORDER_PERMUTED = 0, /* as crofton_permute_triangles writes them */
    CROFTON_INDEX_ORDER_ORIGINAL = 1  /* as the mesh that was cut has them */
} crofton_index_order;

/* A mesh cut into clusters. The k-th triangle of the order is triangle triangle_order[k] of the given mesh. */
typedef struct crofton_clusters {
    const crofton_cluster* clusters;
    size_t cluster_count;
    const uint32_t* triangle_order;
    size_t triangle_count;
} crofton_clusters;

/* The picture that you draw. */
typedef struct crofton_picture_view {
    size_t size;
    uint32_t width, height; /* 1280 and 720; 1 to 16384 */
    uint32_t depth;         /* a crofton_depth_range; CROFTON_DEPTH_REVERSED_ZERO_TO_ONE */
    uint32_t samples;       /* 1 in each pixel, at its centre; 2, 4 or 8: for multisampling, at Vulkan's locations */
    /* 0 for no limit. Otherwise a number of clusters that are tested and of triangles that are drawn, together; what is
     * left after that is listed whole unless its box is hidden. */
    uint64_t work_limit;
} crofton_picture_view;

/* Bit k of `triangles` stands for triangle first_triangle + k of the cluster; at least one is set. */
typedef struct crofton_visible_cluster {
    uint32_t object, cluster;
    uint64_t triangles;
} crofton_visible_cluster;

/* Options of occlusion culling. */
typedef struct crofton_occlusion_options {
    size_t size;
    uint32_t width, height; /* of the depth buffer: 480 and 270; more pixels find more hidden objects and take longer */
    uint32_t max_occluders; /* 256: draws at most so many, those that hide most in the view */
    uint32_t list_occluded; /* 0; 1: also lists hidden objects, which takes a second query */
    float least_cover;      /* 2e-5: does not draw occluders that cover a smaller part of the sphere of directions */
} crofton_occlusion_options;

/* Your engine's matrix, from positions relative to `origin` to clip space, for column vectors. */
typedef struct crofton_view_matrix {
    size_t size;
    const double* doubles; /* sixteen numbers, */
    const float* floats;   /* or these: set one of the two */
    uint32_t is_row_major; /* 0: column by column; 1: row by row */
    uint32_t depth;        /* a crofton_depth_range; CROFTON_DEPTH_REVERSED_ZERO_TO_ONE */
    double origin[3];      /* 0, 0, 0 */
} crofton_view_matrix;

typedef struct crofton_view_result crofton_view_result; /* the answer of one to 32 views; keeps its memory */

/* What a camera sees, for the view of a light. */
typedef struct crofton_shadow_receivers {
    size_t size;
    const crofton_view_result* seen; /* NULL: set it. The answer to the camera's view alone, which had a picture; not
                                        that of the light. It holds until an update changes something, an object or a
                                        mesh is removed, or a mesh is replaced */
    double radius; /* 1; 0.5 to 1024. A lookup reads texels whose centres are at most this far from its point along each
                      axis: 0.5 for the nearest texel, 1 for a bilinear comparison, r + 1 for one in each of (2 r + 1)^2
                      texels */
} crofton_shadow_receivers;

/* A view's request. The call obeys every member that is set, or returns an error that names it. */
typedef struct crofton_view_request {
    size_t size;
    const crofton_camera* camera;      /* set one of these three; NULL */
    const crofton_view_matrix* matrix; /* NULL */
    const crofton_frustum* volume; /* NULL. Any convex volume. For occlusion also set camera or matrix; objects are then
                                      tested against the volume instead of its frustum */
    uint32_t layers;               /* all; lists objects that share a layer with these */
    const crofton_occlusion_options* occlusion; /* NULL: does not look for hidden objects */
    const crofton_draw_limits* limits;          /* NULL: none */
    const uint64_t* candidate_mask; /* NULL, or bit i % 64 of word i / 64 says whether object i may be seen, as from
                                       crofton_pvs_visible. Objects beyond the end, objects that have moved since their
                                       first update, and objects that reuse an index may always be seen */
    size_t candidate_words;
    uint32_t conservative; /* 0: exact; 1: tests planes only, which keeps some boxes near the volume's corners */
    uint32_t
        tree_order; /* 0: ascending indices; 1: in the order of the tree in memory, twice as fast where much is seen */
    const crofton_picture_view*
        picture; /* NULL, or instead of `occlusion`: for objects whose mesh has `clusters`, also lists the triangles
                    that this picture needs; other objects are listed if their boxes may be seen */
    const crofton_shadow_receivers*
        receivers; /* NULL, or with `picture`, which then is the shadow map of a light: lists only the triangles without
                      which a shadow on what a camera sees would change */
} crofton_view_request;

/* Data of one view. Pointers are valid until the result's next view. */
typedef struct crofton_view_info {
    size_t size;
    /* Counts of frustum culling. 0 for a view that is one of several, and with occlusion unless list_occluded or
     * tree_order is set. */
    uint64_t nodes_tested, boxes_tested, accepted_whole, straddling, exact_tests, false_positives;
    /* With occlusion, else 0. Nodes are those of the tree; the nodes below a hidden node are not counted. */
    uint64_t occluders_drawn, occluder_pieces_drawn, occluder_triangles_drawn;
    uint64_t occlusion_nodes_tested, occlusion_nodes_outside, occlusion_nodes_hidden;
    uint64_t occlusion_items_tested, occlusion_items_hidden;
    const uint32_t* occluded_ids; /* with list_occluded: objects in the volume that are hidden, ascending */
    size_t occluded_count;
    uint32_t depth_width, depth_height; /* of the depth buffer; crofton_view_result_depth copies it */
    /* With a picture: what to draw, by object index, then by cluster of its mesh (crofton_world_get_mesh). */
    const crofton_visible_cluster* triangles;
    size_t triangle_cluster_count; /* of `triangles` */
    /* With a picture, as in crofton_depth_statistics. */
    uint64_t objects_listed, objects_asked, clusters_asked, clusters_drawn, triangles_drawn, triangles_listed;
} crofton_view_info;

CROFTON_API crofton_draw_limits crofton_default_draw_limits(void);
CROFTON_API crofton_picture_view crofton_default_picture_view(void);
CROFTON_API crofton_shadow_receivers crofton_default_shadow_receivers(void);
CROFTON_API crofton_occlusion_options crofton_default_occlusion_options(void);
CROFTON_API crofton_view_matrix crofton_default_view_matrix(void);
CROFTON_API crofton_view_request crofton_default_view_request(void);

/* Computes limits that leave out objects whose sphere is less than `pixels` wide in a picture `picture_height` pixels
 * high, as if each were in its middle. Fills a struct whose `size` is set; its other members become 0. */
CROFTON_API crofton_status crofton_draw_limits_of_camera(const crofton_camera* camera, double picture_height,
                                                         double pixels, crofton_draw_limits* limits);

CROFTON_API crofton_status crofton_view_result_create(crofton_view_result** result);
CROFTON_API crofton_status crofton_view_result_destroy(crofton_view_result* result);

/* Returns the indices of the objects, items or boxes; valid until the result's next view.
 *
 * For one view, *inside_count is how many lie inside its volume. In tree order they are the first; in ascending order,
 * *verdicts has a crofton_verdict for each, else it is NULL. For several views both are 0 and NULL. `verdicts`,
 * `inside_count` or NULL. */
CROFTON_API crofton_status crofton_view_result_ids(const crofton_view_result* result, const uint32_t** ids,
                                                   size_t* count, const uint8_t** verdicts, size_t* inside_count);
/* Fills a struct whose `size` is set with the data of view number `view`. CROFTON_OUT_OF_RANGE: there are fewer views.
 */
CROFTON_API crofton_status crofton_view_result_get_view(const crofton_view_result* result, size_t view,
                                                        crofton_view_info* info);
/* Writes the depth buffer of view number `view`: depth_width * depth_height numbers, at most `capacity`, row by row
 * from the bottom. Each is the occluders' nearness, 1 / w (orthographic: minus the distance), or below -1e38 where
 * nothing is drawn. CROFTON_EMPTY: the view had no occlusion. */
CROFTON_API crofton_status crofton_view_result_depth(const crofton_view_result* result, size_t view, float* nearness,
                                                     size_t capacity);

/* Lists the boxes of a plain array that a view sees. Box i is in the layers layer_masks[i], in all if `layer_masks` is
 * NULL. `jobs` or NULL. CROFTON_UNSUPPORTED: a request with occlusion or a picture. Allocates nothing once `result` has
 * held as many. */
CROFTON_API crofton_status crofton_view_boxes(const crofton_box* boxes, const uint32_t* layer_masks, size_t count,
                                              const crofton_view_request* request, const crofton_jobs* jobs,
                                              crofton_view_result* result);
/* Sets verdicts[i] to the exact verdict of boxes[i]. */
CROFTON_API crofton_status crofton_classify(const crofton_frustum* frustum, const crofton_box* boxes, size_t count,
                                            uint8_t* verdicts);

#ifdef __cplusplus
}
#endif
#endif
