/* SPDX-License-Identifier: MIT */
/* The modules one by one, for engines that keep their own lists and trees. */
#ifndef CROFTON_CAPI_MODULES_H
#define CROFTON_CAPI_MODULES_H
#include <crofton/capi/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The scene graph: who is where, and how large. */

typedef struct crofton_scene crofton_scene;

/* Triangles of one mesh; copied by the calls that take it. */
typedef struct crofton_mesh {
    size_t size;
    const float* positions; /* x y z per vertex */
    size_t vertex_count;
    const uint32_t* indices; /* three per triangle, counter-clockwise seen from outside */
    size_t index_count;
    const char* name; /* or NULL */
} crofton_mesh;

typedef struct crofton_update_statistics {
    size_t size;
    uint32_t nodes_updated, instances_updated, instances_invalid;
} crofton_update_statistics;

CROFTON_API crofton_status crofton_scene_create(crofton_scene** scene);
CROFTON_API crofton_status crofton_scene_destroy(crofton_scene* scene);

CROFTON_API crofton_status crofton_scene_add_mesh(crofton_scene* scene, const crofton_mesh* mesh, uint32_t* mesh_id);
/* `parent` is a node or CROFTON_NONE; `local` or NULL: the identity. */
CROFTON_API crofton_status crofton_scene_add_node(crofton_scene* scene, uint32_t parent, const crofton_transform* local,
                                                  uint32_t layer_mask, uint32_t* node_id);
CROFTON_API crofton_status crofton_scene_add_instance(crofton_scene* scene, uint32_t node, uint32_t mesh,
                                                      uint32_t* instance_id);
CROFTON_API crofton_status crofton_scene_set_local(crofton_scene* scene, uint32_t node, const crofton_transform* local);
CROFTON_API crofton_status crofton_scene_set_layer_mask(crofton_scene* scene, uint32_t node, uint32_t layer_mask);
/* Ids of others stay as they are; this one is given out again. */
CROFTON_API crofton_status crofton_scene_remove_instance(crofton_scene* scene, uint32_t instance);

/* Brings world transforms and boxes up to date; `jobs`, `statistics` or NULL. */
CROFTON_API crofton_status crofton_scene_update(crofton_scene* scene, const crofton_jobs* jobs,
                                                crofton_update_statistics* statistics);

/* By instance id, removed ones included (their layer mask is 0); valid until the scene's next non-const call. */
CROFTON_API crofton_status crofton_scene_boxes(const crofton_scene* scene, const crofton_box** boxes,
                                               const uint32_t** layer_masks, size_t* count);
/* Whose box changed in the last update, ascending; valid as above. */
CROFTON_API crofton_status crofton_scene_moved(const crofton_scene* scene, const uint32_t** instances, size_t* count);

/* What does a view see? */

typedef struct crofton_tree crofton_tree;               /* a hierarchy over boxes */
typedef struct crofton_visible_set crofton_visible_set; /* the answer to a query, in buffers that are kept */

typedef enum crofton_verdict { CROFTON_OUTSIDE = 0, CROFTON_STRADDLING = 1, CROFTON_INSIDE = 2 } crofton_verdict;

/* Sees the items whose layer mask shares a bit with its own. */
typedef struct crofton_view {
    size_t size;
    uint32_t layer_mask;
    crofton_frustum frustum;
} crofton_view;

typedef struct crofton_cull_options {
    size_t size;
    uint32_t conservative; /* 0: exact; 1: planes only, which keeps some boxes near the frustum's corners */
    uint32_t tree_order;   /* 0: ids ascending; 1: as the tree lies in memory, in half the time where much is seen */
    /* Items that may be seen at all, as crofton_pvs_visible gives them: bit i % 64 of among[i / 64] is item i. Those
     * beyond may, and so may what moves in a world. NULL: all. A caller's smaller struct lacks it: all. */
    const uint64_t* among;
    size_t among_words;
} crofton_cull_options;

typedef struct crofton_cull_statistics {
    size_t size;
    uint64_t nodes_tested, boxes_tested, accepted_whole, straddling, exact_tests, improper;
} crofton_cull_statistics;

/* Item i is boxes[i], seen in the layers layer_masks[i] (or NULL: in all). Both are copied. */
CROFTON_API crofton_status crofton_tree_create(const crofton_box* boxes, const uint32_t* layer_masks, size_t count,
                                               const crofton_jobs* jobs, crofton_tree** tree);
CROFTON_API crofton_status crofton_tree_destroy(crofton_tree* tree);

/* Changes: all of a call's items, or none. After moves and removals call crofton_tree_refit before the next query. */
CROFTON_API crofton_status crofton_tree_move(crofton_tree* tree, const uint32_t* items, const crofton_box* boxes,
                                             size_t count);
CROFTON_API crofton_status crofton_tree_insert(crofton_tree* tree, const crofton_box* box, uint32_t layer_mask,
                                               uint32_t* item);
/* The item's id is given to a later insert. */
CROFTON_API crofton_status crofton_tree_remove(crofton_tree* tree, uint32_t item);
CROFTON_API crofton_status crofton_tree_set_layer_mask(crofton_tree* tree, uint32_t item, uint32_t layer_mask);
CROFTON_API crofton_status crofton_tree_refit(crofton_tree* tree);
/* Rebuilds in the background, `budget` items' worth of work a call: once a frame, after refit, where items move for
 * long. */
CROFTON_API crofton_status crofton_tree_rebuild_step(crofton_tree* tree, size_t budget);

CROFTON_API crofton_status crofton_visible_set_create(crofton_visible_set** visible);
CROFTON_API crofton_status crofton_visible_set_destroy(crofton_visible_set* visible);

/* Finds what `view` sees of the tree; `options`, `jobs` or NULL. Allocates nothing once `visible` has grown to the
 * largest answer. */
CROFTON_API crofton_status crofton_cull_tree(const crofton_tree* tree, const crofton_view* view,
                                             const crofton_cull_options* options, const crofton_jobs* jobs,
                                             crofton_visible_set* visible);
/* The same from a plain list of boxes. */
CROFTON_API crofton_status crofton_cull_boxes(const crofton_box* boxes, const uint32_t* layer_masks, size_t count,
                                              const crofton_view* view, const crofton_cull_options* options,
                                              const crofton_jobs* jobs, crofton_visible_set* visible);

/* The items seen and their verdicts (or NULL; a crofton_verdict each), valid until the set's next query. */
CROFTON_API crofton_status crofton_visible_set_items(const crofton_visible_set* visible, const uint32_t** ids,
                                                     const uint8_t** verdicts, size_t* count);
CROFTON_API crofton_status crofton_visible_set_statistics(const crofton_visible_set* visible,
                                                          crofton_cull_statistics* statistics);

/* Writes verdicts[i] for boxes[i], exactly. */
CROFTON_API crofton_status crofton_classify(const crofton_frustum* frustum, const crofton_box* boxes, size_t count,
                                            uint8_t* verdicts);

/* What touches what? Exactly; touching counts. */

typedef struct crofton_broadphase crofton_broadphase; /* all pairs of many moving boxes */
typedef struct crofton_collider crofton_collider;     /* one mesh, ready for collisions */

/* Two items are tested iff each one's layers meet what the other collides with. */
typedef struct crofton_filter {
    uint32_t layers, collides_with;
} crofton_filter;

typedef struct crofton_pair {
    uint32_t first, second;
} crofton_pair;

typedef enum crofton_pairs {
    CROFTON_PAIRS_ALL = 0,
    CROFTON_PAIRS_BEGAN = 1, /* not there after the update before */
    CROFTON_PAIRS_STAYED = 2,
    CROFTON_PAIRS_ENDED = 3
} crofton_pairs;

typedef struct crofton_broadphase_statistics {
    size_t size;
    uint64_t bound_pairs, box_pairs, nodes_tested;
    uint32_t rejected; /* items whose box is invalid: they meet nothing */
} crofton_broadphase_statistics;

/* *meet is 1 where the boxes share a point, else 0. */
CROFTON_API crofton_status crofton_boxes_meet(const crofton_box* a, const crofton_box* b, int* meet);

CROFTON_API crofton_status crofton_broadphase_create(crofton_broadphase** broadphase);
CROFTON_API crofton_status crofton_broadphase_destroy(crofton_broadphase* broadphase);
/* boxes[i] is the same item as in the update before; `filters` or NULL: all pass; `jobs` or NULL. */
CROFTON_API crofton_status crofton_broadphase_update(crofton_broadphase* broadphase, const crofton_box* boxes,
                                                     const crofton_filter* filters, size_t count,
                                                     const crofton_jobs* jobs);
/* `which` is a crofton_pairs. In order, first < second; valid until the next update. */
CROFTON_API crofton_status crofton_broadphase_pairs(const crofton_broadphase* broadphase, uint32_t which,
                                                    const crofton_pair** pairs, size_t* count);
CROFTON_API crofton_status crofton_broadphase_get_statistics(const crofton_broadphase* broadphase,
                                                             crofton_broadphase_statistics* statistics);

CROFTON_API crofton_status crofton_collider_create(const crofton_mesh* mesh, crofton_collider** collider);
CROFTON_API crofton_status crofton_collider_destroy(crofton_collider* collider);

/* `b_to_a` is a rotation and a translation: the pose of b in a's frame. */
CROFTON_API crofton_status crofton_colliders_meet(const crofton_collider* a, const crofton_collider* b,
                                                  const crofton_transform* b_to_a, int* meet);
/* The smallest distance between the surfaces, 0 where they meet, and where it is, in a's frame (or NULL). */
CROFTON_API crofton_status crofton_colliders_distance(const crofton_collider* a, const crofton_collider* b,
                                                      const crofton_transform* b_to_a, double* distance, double* on_a,
                                                      double* on_b);
/* Writes the first `capacity` pairs of triangles that meet, in order, and in *count how many there are in all. */
CROFTON_API crofton_status crofton_colliders_triangle_pairs(const crofton_collider* a, const crofton_collider* b,
                                                            const crofton_transform* b_to_a, crofton_pair* pairs,
                                                            size_t capacity, size_t* count);

/* Where do boxes and meshes touch, how deep, and how far are they apart? */

#define CROFTON_MAX_MANIFOLD_POINTS 8u

typedef struct crofton_contact_point {
    double position[3]; /* midway between the surfaces */
    double depth;       /* >= 0 */
} crofton_contact_point;

/* Moving b by depth * normal ends the contact. */
typedef struct crofton_manifold {
    size_t size;
    double normal[3]; /* unit, from a to b */
    double depth;
    uint32_t point_count; /* 0 where the boxes do not meet */
    crofton_contact_point points[CROFTON_MAX_MANIFOLD_POINTS];
} crofton_manifold;

/* Where two triangles meet, in a's frame: the ends of their common segment, and the unit normal of b's triangle. */
typedef struct crofton_mesh_contact {
    crofton_pair triangles; /* of a and of b */
    double begin[3], end[3], normal[3];
} crofton_mesh_contact;

typedef enum crofton_containment {
    CROFTON_CONTAINS_NOTHING = 0, /* or the surfaces meet */
    CROFTON_A_INSIDE_B = 1,
    CROFTON_B_INSIDE_A = 2,
    CROFTON_PARTLY_INSIDE = 3 /* some pieces of a mesh, but not all */
} crofton_containment;

/* Fills a manifold whose `size` is set. */
CROFTON_API crofton_status crofton_boxes_manifold(const crofton_box* a, const crofton_box* b,
                                                  crofton_manifold* manifold);
/* 0 where they meet; nearest points, or NULL. */
CROFTON_API crofton_status crofton_boxes_distance(const crofton_box* a, const crofton_box* b, double* distance,
                                                  double* on_a, double* on_b);

/* Writes the first `capacity` contacts, in order of triangles, and in *count how many there are in all. */
CROFTON_API crofton_status crofton_colliders_contacts(const crofton_collider* a, const crofton_collider* b,
                                                      const crofton_transform* b_to_a, crofton_mesh_contact* contacts,
                                                      size_t capacity, size_t* count);
/* A motion of b by *depth along `direction` (a unit vector, or NULL) ends the contact: an upper bound of the
 * penetration depth, 0 where the meshes do not meet. */
CROFTON_API crofton_status crofton_colliders_depth(const crofton_collider* a, const crofton_collider* b,
                                                   const crofton_transform* b_to_a, double* depth, double* direction);
/* Whether one mesh, without touching it, lies inside the other, which is to be closed: a crofton_containment. */
CROFTON_API crofton_status crofton_colliders_containment(const crofton_collider* a, const crofton_collider* b,
                                                         const crofton_transform* b_to_a, uint32_t* containment);

/* What does a ray hit first, and what lies within a body? */

/* The points origin + t direction, 0 <= t <= max_t, which may be infinite. A segment from p to q is {p, q - p, 1}. */
typedef struct crofton_ray {
    double origin[3], direction[3];
    double max_t;
} crofton_ray;

typedef struct crofton_ray_hit {
    double t;
    uint32_t index; /* of a collider: the triangle; of a tree: the item; CROFTON_NONE: no hit, and t is infinite */
} crofton_ray_hit;

/* *t is where the ray enters the box, 0 where it starts inside, infinite where it misses. */
CROFTON_API crofton_status crofton_box_raycast(const crofton_box* box, const crofton_ray* ray, double* t);
/* The nearest triangle. Nothing slips through between triangles that share an edge; a ray within the plane of a
 * triangle does not hit that triangle. */
CROFTON_API crofton_status crofton_collider_raycast(const crofton_collider* collider, const crofton_ray* rays,
                                                    size_t count, crofton_ray_hit* hits);
/* *hit is 1 where the ray hits any triangle, else 0: quicker than which. */
CROFTON_API crofton_status crofton_collider_hits_any(const crofton_collider* collider, const crofton_ray* ray,
                                                     int* hit);

/* Of the items whose layers share a bit with `layer_mask`, the one whose box each ray enters first. */
CROFTON_API crofton_status crofton_tree_raycast(const crofton_tree* tree, const crofton_ray* rays, size_t count,
                                                uint32_t layer_mask, crofton_ray_hit* hits);
/* Write the first `capacity` of the items that meet the body, ascending, and in *found how many there are in all. */
CROFTON_API crofton_status crofton_tree_within_box(const crofton_tree* tree, const crofton_box* box,
                                                   uint32_t layer_mask, uint32_t* items, size_t capacity,
                                                   size_t* found);
CROFTON_API crofton_status crofton_tree_within_ball(const crofton_tree* tree, const double center[3], double radius,
                                                    uint32_t layer_mask, uint32_t* items, size_t capacity,
                                                    size_t* found);

/* Boxes around points, best by the criterion that the queries imply. */

/* volume_weight V + area_weight F + mean_curvature_weight M, weights >= 0 and not all 0. */
typedef struct crofton_criterion {
    double volume_weight, area_weight, mean_curvature_weight;
} crofton_criterion;

typedef enum crofton_fit_quality {
    CROFTON_FIT_FAST = 0,  /* one or two passes over the points */
    CROFTON_FIT_TIGHT = 1, /* convex hull and local search */
    CROFTON_FIT_EXACT = 2  /* the global optimum */
} crofton_fit_quality;

typedef struct crofton_fit_options {
    size_t size;
    uint32_t quality; /* a crofton_fit_quality */
    crofton_criterion criterion;
} crofton_fit_options;

/* For frusta large beside the objects: the sum of the edges. */
CROFTON_API crofton_status crofton_criterion_minimal_perimeter(crofton_criterion* criterion);
/* The criterion that makes the camera's expected number of hits smallest; its far distance must be finite. */
CROFTON_API crofton_status crofton_criterion_for_frustum(const crofton_camera* camera, crofton_criterion* criterion);
/* For rays and segments of this length. */
CROFTON_API crofton_status crofton_criterion_for_rays(double length, crofton_criterion* criterion);

/* A box that contains every point, x y z each; `options` or NULL: tight, minimal perimeter. */
CROFTON_API crofton_status crofton_fit_floats(const float* points, size_t point_count,
                                              const crofton_fit_options* options, crofton_box* box);
CROFTON_API crofton_status crofton_fit_doubles(const double* points, size_t point_count,
                                               const crofton_fit_options* options, crofton_box* box);
/* A box that contains all the boxes; `criterion` or NULL: minimal perimeter. */
CROFTON_API crofton_status crofton_fit_boxes(const crofton_box* boxes, size_t count, const crofton_criterion* criterion,
                                             crofton_box* box);

/* Polygons with holes to triangles of minimum weight. */

typedef struct crofton_triangulator crofton_triangulator; /* memory kept from one polygon to the next */

/* Rings one after another; ring r is [ring_ends[r - 1], ring_ends[r]), the first is the outer one, the others holes. */
typedef struct crofton_polygon {
    size_t size;
    const double* points; /* x y each */
    size_t point_count;
    const uint32_t* ring_ends;
    size_t ring_count;
} crofton_polygon;

typedef enum crofton_triangulation_method {
    CROFTON_TRIANGULATE_EAR = 0,
    CROFTON_TRIANGULATE_DELAUNAY = 1,
    CROFTON_TRIANGULATE_MINIMUM_WEIGHT = 2
} crofton_triangulation_method;

typedef struct crofton_triangulation {
    size_t size;
    const uint32_t* indices; /* three per triangle, counter-clockwise; valid until the triangulator's next call */
    size_t triangle_count;
    double weight;    /* total length of the diagonals */
    double gap;       /* proven bound on (weight - minimum) / minimum; infinite when unknown */
    uint32_t optimal; /* 1 where the weight is proven minimal */
} crofton_triangulation;

CROFTON_API crofton_status crofton_triangulator_create(crofton_triangulator** triangulator);
CROFTON_API crofton_status crofton_triangulator_destroy(crofton_triangulator* triangulator);
/* Fills a triangulation whose `size` is set; `method` is a crofton_triangulation_method. */
CROFTON_API crofton_status crofton_triangulate(crofton_triangulator* triangulator, const crofton_polygon* polygon,
                                               uint32_t method, crofton_triangulation* triangulation);

/* Scenes made ready at build time: boxes, tree and meshes in one file that is used where it lies. */

typedef struct crofton_baked_scene crofton_baked_scene;

/* A mesh as it lies in the file. */
typedef struct crofton_baked_mesh {
    size_t size;
    const float* positions; /* x y z per vertex */
    size_t vertex_count;
    const float* colors; /* linear r g b per vertex, or NULL */
    const uint32_t* indices;
    size_t index_count;
    const char* name; /* `name_length` characters, with no 0 behind them */
    size_t name_length;
    crofton_box box; /* in the mesh's own frame */
} crofton_baked_mesh;

typedef struct crofton_baked_instance {
    uint32_t mesh, node;
} crofton_baked_instance;

typedef struct crofton_baked_node {
    crofton_transform world;
    uint32_t parent; /* or CROFTON_NONE */
    uint32_t reserved;
} crofton_baked_node;

/* Writes the scene as of its last update into a file: all of it, flushed to the disk, or the old file stays as it was.
 * Whoever has the old file open keeps its contents. `jobs` or NULL. */
CROFTON_API crofton_status crofton_scene_bake(const crofton_scene* scene, const char* path, const crofton_jobs* jobs);

/* Maps a file and checks it whole. `tree` lies over the instances, item i being instance i; it is a handle of its own,
 * which may change and outlive `baked`. Do not shorten or change the file meanwhile: reading what was cut off ends the
 * program (SIGBUS). Replacing it, as crofton_scene_bake does, is safe. `jobs` or NULL. */
CROFTON_API crofton_status crofton_baked_scene_open(const char* path, const crofton_jobs* jobs,
                                                    crofton_baked_scene** baked, crofton_tree** tree);
/* As crofton_baked_scene_open, with the file read into memory first: what then happens to the file does no harm. */
CROFTON_API crofton_status crofton_baked_scene_read(const char* path, const crofton_jobs* jobs,
                                                    crofton_baked_scene** baked, crofton_tree** tree);
CROFTON_API crofton_status crofton_baked_scene_destroy(crofton_baked_scene* baked);

/* All pointers lead into the file, and hold as long as `baked` lives. */
CROFTON_API crofton_status crofton_baked_scene_mesh_count(const crofton_baked_scene* baked, size_t* count);
CROFTON_API crofton_status crofton_baked_scene_mesh(const crofton_baked_scene* baked, uint32_t mesh_id,
                                                    crofton_baked_mesh* mesh);
CROFTON_API crofton_status crofton_baked_scene_instances(const crofton_baked_scene* baked,
                                                         const crofton_baked_instance** instances, size_t* count);
CROFTON_API crofton_status crofton_baked_scene_nodes(const crofton_baked_scene* baked, const crofton_baked_node** nodes,
                                                     size_t* count);

/* Potentially visible sets, as `crofton pvs --out FILE` has baked them: docs/pvs.md. */

typedef struct crofton_pvs crofton_pvs;

typedef enum crofton_pvs_mode {
    CROFTON_PVS_CONSERVATIVE = 0, /* all that is not proved hidden */
    CROFTON_PVS_STATISTICAL = 1   /* what lines have seen */
} crofton_pvs_mode;

#define CROFTON_PVS_NO_CELL 0xffffffffu

CROFTON_API crofton_status crofton_pvs_open(const char* path, crofton_pvs** pvs);
CROFTON_API crofton_status crofton_pvs_destroy(crofton_pvs* pvs);
/* Numbers of cells and of objects; either may be NULL. */
CROFTON_API crofton_status crofton_pvs_counts(const crofton_pvs* pvs, size_t* cells, size_t* objects);
/* The cell of an eye (three numbers), or CROFTON_PVS_NO_CELL where none holds it, or a solid one. */
CROFTON_API crofton_status crofton_pvs_find_cell(const crofton_pvs* pvs, const double* eye, uint32_t* cell);
/* What may be seen by an eye, for crofton_cull_options; `mode` is a crofton_pvs_mode. Without a cell *words is NULL and
 * *count 0: everything. Holds as long as `pvs` lives; nothing is allocated. */
CROFTON_API crofton_status crofton_pvs_visible(const crofton_pvs* pvs, const double* eye, uint32_t mode,
                                               const uint64_t** words, size_t* count);

#ifdef __cplusplus
}
#endif
#endif
