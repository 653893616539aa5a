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
/* Whose box or world transform changed in the last update, ascending; valid as above. */
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

typedef struct crofton_cull_options {
    size_t size;
    uint32_t conservative; /* 0: exact; 1: planes only, which keeps some boxes near the frustum's corners */
    uint32_t tree_order;   /* 0: ids ascending; 1: as the tree lies in memory, in half the time where much is seen */
    /* NULL, or bit i % 64 of word i / 64: may item i be seen? Items beyond the end may. */
    const uint64_t* candidate_mask;
    size_t candidate_words;
    const crofton_draw_limits* limits; /* or NULL: all is worth drawing */
} crofton_cull_options;

typedef struct crofton_cull_statistics {
    size_t size;
    uint64_t nodes_tested, boxes_tested, accepted_whole, straddling, exact_tests, false_positives;
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

CROFTON_API crofton_cull_options crofton_default_cull_options(void);
CROFTON_API crofton_draw_limits crofton_default_draw_limits(void);
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

/* Limits for a camera: nothing whose sphere is less than `pixels` wide in a picture so many pixels high. Each is judged
 * as if it were in the middle. Fills a struct whose `size` is set; all else is 0. */
CROFTON_API crofton_status crofton_draw_limits_of_camera(const crofton_camera* camera, double picture_height,
                                                         double pixels, crofton_draw_limits* limits);

/* Writes verdicts[i] for boxes[i], exactly. */
CROFTON_API crofton_status crofton_classify(const crofton_frustum* frustum, const crofton_box* boxes, size_t count,
                                            uint8_t* verdicts);

/* Which triangles does a picture need? Each is asked against the depth of those before, front to back. docs/depth.md is
 * the guide. */

typedef struct crofton_clustered_mesh crofton_clustered_mesh; /* a mesh cut into clusters; it never changes */
typedef struct crofton_depth_culler crofton_depth_culler;     /* the answer for one picture, in buffers that are kept */

#define CROFTON_MAX_CLUSTER_TRIANGLES 64u

/* The triangles [first_triangle, first_triangle + triangle_count) of the order, and a box in the mesh's coordinates
 * that contains them. */
typedef struct crofton_cluster {
    uint32_t first_triangle, triangle_count; /* 1 to CROFTON_MAX_CLUSTER_TRIANGLES */
    float center[3];
    float half_edges[9]; /* half_edges[3 k + i] is component i of edge k; center +- each edge gives the corners */
} crofton_cluster;

/* One mesh that is drawn. */
typedef struct crofton_depth_object {
    size_t size;
    const crofton_clustered_mesh* mesh; /* NULL: set it */
    float to_clip[16];    /* the identity; column-major, takes columns (x, y, z, 1) of the mesh's to clip space, as the
                             vertex shader does in float. Not finite: all of the object is listed and it hides nothing */
    uint32_t one_sided;   /* 0; 1: back faces are not drawn; front faces are counter-clockwise seen with y up */
    uint32_t hides;       /* 1; 0: hides nothing, as alpha-tested and transparent things */
    float position_error; /* 0; how far drawn vertices may lie from the mesh's, in its units, besides the rounding of
                             to_clip times vertex. Negative or not finite: as of to_clip */
} crofton_depth_object;

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

typedef struct crofton_depth_statistics {
    size_t size;
    uint64_t objects_listed;  /* with at least one triangle */
    uint64_t objects_asked;   /* whose bounds cover a sample of the picture */
    uint64_t clusters_asked;  /* of the objects that were not hidden as a whole */
    uint64_t clusters_drawn;  /* that were not hidden as a whole */
    uint64_t triangles_drawn; /* of those clusters */
    uint64_t triangles_listed;
} crofton_depth_statistics;

CROFTON_API crofton_depth_object crofton_default_depth_object(void);
CROFTON_API crofton_picture_view crofton_default_picture_view(void);

/* Cuts a mesh, which is copied, into clusters of up to `max_triangles`, 0 to CROFTON_MAX_CLUSTER_TRIANGLES. 0 chooses:
 * 16 for meshes of up to 1,000 triangles, 64 for those of 10,000 and more, and between them in proportion. Errors name
 * the vertex or the index. */
CROFTON_API crofton_status crofton_clustered_mesh_create(const crofton_mesh* mesh, uint32_t max_triangles,
                                                         crofton_clustered_mesh** clustered);
CROFTON_API crofton_status crofton_clustered_mesh_destroy(crofton_clustered_mesh* clustered);
/* Writes the first `capacity` numbers of the order, and in *count how many there are: one a triangle. Triangle
 * triangles[k] of the mesh that was given is number k of the order. */
CROFTON_API crofton_status crofton_clustered_mesh_triangle_order(const crofton_clustered_mesh* clustered,
                                                                 uint32_t* triangles, size_t capacity, size_t* count);
/* Writes the mesh's `index_count` indices to `permuted` in that order, so that each cluster is one range of an index
 * buffer. The arrays must not overlap. */
CROFTON_API crofton_status crofton_clustered_mesh_permute(const crofton_clustered_mesh* clustered,
                                                          const uint32_t* indices, size_t index_count,
                                                          uint32_t* permuted);
/* Valid while the clustered mesh lives. */
CROFTON_API crofton_status crofton_clustered_mesh_clusters(const crofton_clustered_mesh* clustered,
                                                           const crofton_cluster** clusters, size_t* count);

CROFTON_API crofton_status crofton_depth_culler_create(crofton_depth_culler** culler);
CROFTON_API crofton_status crofton_depth_culler_destroy(crofton_depth_culler* culler);
/* Lists the triangles without which the picture would change, by object, then by cluster; valid until the culler's next
 * call of this. Draw them, or any set that contains them, in the order in which you would draw all, and the picture has
 * the same bits. It holds for opaque triangles with the depth test on, one sample a pixel and 32-bit float depth; the
 * guide says what else the renderer must do. Errors name the object. A call that fails leaves the last answer as it
 * was. Allocates nothing once it has grown to the largest answer. */
CROFTON_API crofton_status crofton_depth_culler_find_visible(crofton_depth_culler* culler,
                                                             const crofton_depth_object* objects, size_t object_count,
                                                             const crofton_picture_view* picture,
                                                             const crofton_visible_cluster** clusters, size_t* count);
/* Of the last answer. Fills a struct whose `size` is set. */
CROFTON_API crofton_status crofton_depth_culler_get_statistics(const crofton_depth_culler* culler,
                                                               crofton_depth_statistics* statistics);
/* The nearness that the listed triangles surely have at a pixel of the last picture: its depth, negated unless
 * reversed; minus infinity where none surely covers it. Row 0 is at the bottom. CROFTON_OUT_OF_RANGE: not a pixel of
 * that picture, or there was none. */
CROFTON_API crofton_status crofton_depth_culler_nearness(const crofton_depth_culler* culler, uint32_t x, uint32_t y,
                                                         float* nearness);

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
/* A motion of b by *depth along `direction` (a unit vector, or NULL) ends the contact. It is an upper bound of the
 * penetration depth, 0 where the meshes do not meet. */
CROFTON_API crofton_status crofton_colliders_depth(const crofton_collider* a, const crofton_collider* b,
                                                   const crofton_transform* b_to_a, double* depth, double* direction);
/* Whether one mesh, without touching it, lies inside the other, which is to be closed: a crofton_containment. */
CROFTON_API crofton_status crofton_colliders_containment(const crofton_collider* a, const crofton_collider* b,
                                                         const crofton_transform* b_to_a, uint32_t* containment);

/* Bodies, convex or made of convex parts: do they meet, how far, how deep, where, and when? docs/convex.md is the
 * guide. A pose is a rotation and a translation, without reflection. The structs of this part that begin with `size`
 * may grow: members that an older, smaller one lacks are 0, the default of every member. */

/* A body never changes. What uses it (a World, a compound, a rounded body) keeps what it needs: destroy it at any time.
 */
typedef struct crofton_body crofton_body;
typedef struct crofton_body_contacts crofton_body_contacts; /* where one pair touches, kept from step to step */

typedef enum crofton_body_kind {
    CROFTON_BODY_SPHERE = 0,
    CROFTON_BODY_CAPSULE = 1,
    CROFTON_BODY_CYLINDER = 2,
    CROFTON_BODY_CONE = 3,
    CROFTON_BODY_BOX = 4,
    CROFTON_BODY_TRIANGLE = 5,
    CROFTON_BODY_HULL = 6,
    CROFTON_BODY_HALF_SPACE = 7, /* up to here convex */
    CROFTON_BODY_MESH = 8,
    CROFTON_BODY_HEIGHT_FIELD = 9,
    CROFTON_BODY_COMPOUND = 10
} crofton_body_kind;

typedef struct crofton_hull_options {
    size_t size;
    uint32_t max_vertices; /* 4 to 256; 0: 256. A hull with more is replaced by one that contains it */
    float face_tolerance;  /* triangles so close to a plane, relative to the hull's size, are one face; 0: 1e-5 */
} crofton_hull_options;

#define CROFTON_HOLE 255u /* as a cell's material: nothing is there */

/* Corner (i, j) is at (i * spacing[0], heights[j * columns + i], j * spacing[1]); two triangles a cell. */
typedef struct crofton_height_field {
    size_t size;
    uint32_t columns, rows;   /* corners along x and along z, 2 to 32768 */
    const float* heights;     /* columns * rows */
    const uint8_t* materials; /* of the cells, row by row: (columns - 1) * (rows - 1); or NULL: all 0 */
    double spacing[2];        /* 0: 1 */
} crofton_height_field;

typedef struct crofton_body_info {
    size_t size;
    uint32_t kind;                     /* a crofton_body_kind */
    uint32_t vertex_count, face_count; /* of a hull, else 0 */
    uint32_t part_count;               /* of a compound, else 1 */
    double min[3], max[3];             /* in its frame, rounded outward; infinite for half-spaces */
    double max_overshoot;              /* how far a hull reaches beyond that of its points at most */
} crofton_body_info;

/* Of a body of density 1, in its frame; the inertia about the center of mass, symmetric. */
typedef struct crofton_mass_properties {
    size_t size;
    double volume, center[3], inertia[9];
} crofton_mass_properties;

/* A body where it stands. */
typedef struct crofton_placed {
    const crofton_body* body;
    const crofton_transform* pose;
} crofton_placed;

/* What a pair remembers: all 0 for a new pair. It belongs to one pair in one order. It makes calls faster and changes
 * no yes or no. */
typedef struct crofton_pair_cache {
    uint64_t opaque[16];
} crofton_pair_cache;

/* A convex part of a body: a child of a compound, a triangle of a mesh or height field. */
typedef struct crofton_part {
    uint32_t child, triangle;
} crofton_part;

typedef struct crofton_body_distance {
    size_t size;
    double distance, lower, upper;      /* proven: the true distance lies between the latter two */
    double on_a[3], on_b[3], normal[3]; /* nearest points; the unit vector from a to b, 0 of bodies that meet */
    crofton_part part_a, part_b;
} crofton_body_distance;

/* Moving b by depth * normal ends the overlap. */
typedef struct crofton_body_penetration {
    size_t size;
    double depth, lower, upper; /* as above; all is 0 where the bodies do not meet */
    double on_a[3], on_b[3], normal[3];
    crofton_part part_a, part_b;
    uint32_t overlapping; /* 1 or 0: as crofton_bodies_meet */
} crofton_body_penetration;

typedef enum crofton_feature_kind {
    CROFTON_FEATURE_VERTEX = 0,
    CROFTON_FEATURE_EDGE = 1,
    CROFTON_FEATURE_FACE = 2
} crofton_feature_kind;

typedef struct crofton_feature {
    uint8_t kind; /* a crofton_feature_kind */
    uint8_t unused;
    uint16_t index;
} crofton_feature;

/* A point that a physics step holds on to. Features and parts are its id: it stays the same while the same features
 * touch. */
typedef struct crofton_tracked_point {
    double position[3]; /* midway between the surfaces, in the world */
    double depth;       /* along the normal; negative: a gap */
    crofton_feature on_a, on_b;
    crofton_part part_a, part_b;
    double normal[3]; /* unit, from a to b */
    uint8_t began;    /* 1: its id was not there in the step before */
    uint8_t unused[3];
    float memory[4]; /* the caller's, as impulses for a warm start: 0 when the point begins, kept while it stays */
} crofton_tracked_point;

/* As the first members of crofton_tracked_point. */
typedef struct crofton_body_point {
    double position[3];
    double depth;
    crofton_feature on_a, on_b;
    crofton_part part_a, part_b;
} crofton_body_point;

typedef struct crofton_body_manifold {
    size_t size;
    double normal[3];     /* unit, from a to b */
    double depth;         /* of the deepest point */
    uint32_t point_count; /* 0 where the bodies are farther apart than the margin */
    crofton_body_point points[CROFTON_MAX_MANIFOLD_POINTS];
} crofton_body_manifold;

typedef struct crofton_manifold_options {
    size_t size;
    double margin;       /* >= 0: points with a gap of up to this are told, too */
    uint32_t max_points; /* 1 to 8; 0: 4 */
} crofton_manifold_options;

/* The body's `pivot`, in its frame, moves by velocity * t, and the body turns about it by |spin| * t radians around
 * `spin` (world axes). */
typedef struct crofton_motion {
    double velocity[3], spin[3], pivot[3];
} crofton_motion;

typedef struct crofton_cast_options {
    size_t size;
    double duration;                  /* >= 0 */
    double tolerance;                 /* how far apart bodies may still be at the time of a hit; 0: 1e-6 */
    uint32_t max_steps;               /* 0: 500 */
    uint32_t ignore_initial_overlaps; /* 1: leaves out what overlaps or is within the tolerance at time 0 */
} crofton_cast_options;

typedef enum crofton_cast_result {
    CROFTON_CAST_MISS = 0,      /* proven: the bodies do not touch in that time */
    CROFTON_CAST_HIT = 1,       /* at `time` they are within the tolerance, before they do not touch, then they do */
    CROFTON_CAST_UNRESOLVED = 2 /* before `time` they do not touch; later is not known */
} crofton_cast_result;

typedef struct crofton_impact {
    size_t size;
    double time, distance;              /* gap at that time; negative: how deep they overlap, from the start */
    double on_a[3], on_b[3], normal[3]; /* on the surfaces; unit, from a to b; all 0 for a miss */
    crofton_part part_a, part_b;
    uint32_t result; /* a crofton_cast_result */
    uint32_t steps;
} crofton_impact;

CROFTON_API crofton_hull_options crofton_default_hull_options(void);
CROFTON_API crofton_manifold_options crofton_default_manifold_options(void);
CROFTON_API crofton_cast_options crofton_default_cast_options(void);

/* Solids of revolution stand along y, with the origin half way up. Lengths are >= 0 and at most 1e15. */
CROFTON_API crofton_status crofton_body_sphere(float radius, crofton_body** body);
CROFTON_API crofton_status crofton_body_capsule(float half_height, float radius, crofton_body** body);
CROFTON_API crofton_status crofton_body_cylinder(float half_height, float radius, crofton_body** body);
CROFTON_API crofton_status crofton_body_cone(float half_height, float radius, crofton_body** body);
CROFTON_API crofton_status crofton_body_box(const float half_extents[3], crofton_body** body);
/* Three corners, x y z each, counter-clockwise seen from the front. */
CROFTON_API crofton_status crofton_body_triangle(const float corners[9], crofton_body** body);
/* The normal, of any length but 0, points into the solid. */
CROFTON_API crofton_status crofton_body_half_space(const crofton_plane* plane, crofton_body** body);
/* The hull of `count` points, x y z each; `options` or NULL. */
CROFTON_API crofton_status crofton_body_hull(const float* points, size_t count, const crofton_hull_options* options,
                                             crofton_body** body);
/* All points within `radius` of a convex body other than a half-space. */
CROFTON_API crofton_status crofton_body_rounded(const crofton_body* core, float radius, crofton_body** body);
/* The triangles, as a surface; front_only 1: contacts push to the front, and casts from behind pass. */
CROFTON_API crofton_status crofton_body_mesh(const crofton_mesh* mesh, uint32_t front_only, crofton_body** body);
/* `both_sides` 0: contacts push up alone. */
CROFTON_API crofton_status crofton_body_height_field(const crofton_height_field* field, uint32_t both_sides,
                                                     crofton_body** body);
/* children[i] stands at poses[i] in the compound's frame. */
CROFTON_API crofton_status crofton_body_compound(const crofton_body* const* children, const crofton_transform* poses,
                                                 size_t count, crofton_body** body);
CROFTON_API crofton_status crofton_body_destroy(crofton_body* body);

/* Both fill a struct whose `size` is set. Surfaces have no mass: CROFTON_UNSUPPORTED. */
CROFTON_API crofton_status crofton_body_get_info(const crofton_body* body, crofton_body_info* info);
CROFTON_API crofton_status crofton_body_get_mass(const crofton_body* body, crofton_mass_properties* mass);
/* For drawing: a hull's vertices, x y z each, and its triangles; valid while the body lives. */
CROFTON_API crofton_status crofton_body_hull_surface(const crofton_body* body, const float** vertices,
                                                     size_t* vertex_count, const uint16_t** indices,
                                                     size_t* index_count);

/* Told of a line, in the world; `user` is what the caller gave. It must not throw, and may ask bodies, but not the
 * contacts that are drawn. */
typedef void (*crofton_line_visitor)(void* user, const double from[3], const double to[3]);
/* For debug drawing: the edges of a body and of its parts. What is round is drawn as circles, in pieces of a 24th. */
CROFTON_API crofton_status crofton_body_outline(const crofton_placed* body, crofton_line_visitor visit, void* user);
/* Writes the first `capacity` of the convex parts that may be within `margin` >= 0 of another body, and in *found how
 * many there are. These are all that are so near, and some more. A convex body is its own part. */
CROFTON_API crofton_status crofton_body_parts_near(const crofton_placed* body, const crofton_placed* other,
                                                   double margin, crofton_part* parts, size_t capacity, size_t* found);

/* *meet is 1 where the bodies share a point, else 0. `cache` or NULL. */
CROFTON_API crofton_status crofton_bodies_meet(const crofton_placed* a, const crofton_placed* b,
                                               crofton_pair_cache* cache, int* meet);
/* These fill a struct whose `size` is set. `cache` or NULL. */
CROFTON_API crofton_status crofton_bodies_distance(const crofton_placed* a, const crofton_placed* b,
                                                   crofton_pair_cache* cache, crofton_body_distance* distance);
CROFTON_API crofton_status crofton_bodies_penetration(const crofton_placed* a, const crofton_placed* b,
                                                      crofton_pair_cache* cache, crofton_body_penetration* penetration);
CROFTON_API crofton_status crofton_body_closest_point(const crofton_placed* body, const double point[3],
                                                      crofton_body_distance* distance);
/* Where they touch: the deepest manifold. crofton_body_contacts_update tells all, and what has stayed. */
CROFTON_API crofton_status crofton_bodies_manifold(const crofton_placed* a, const crofton_placed* b,
                                                   const crofton_manifold_options* options, crofton_pair_cache* cache,
                                                   crofton_body_manifold* manifold);
/* When will they first touch? `options` or NULL: within a time of 1. A motion or NULL: that body rests. Bodies that
 * begin within the tolerance hit if they move into each other, not if they part or slide along each other. Bodies that
 * begin overlapping hit at time 0, with the shortest way out. */
CROFTON_API crofton_status crofton_bodies_cast(const crofton_placed* a, const crofton_motion* motion_a,
                                               const crofton_placed* b, const crofton_motion* motion_b,
                                               const crofton_cast_options* options, crofton_impact* impact);

CROFTON_API crofton_status crofton_body_contacts_create(crofton_body_contacts** contacts);
CROFTON_API crofton_status crofton_body_contacts_destroy(crofton_body_contacts* contacts);
/* Once a step, of one pair in one order: where it touches now. `options` or NULL. */
CROFTON_API crofton_status crofton_body_contacts_update(crofton_body_contacts* contacts, const crofton_placed* a,
                                                        const crofton_placed* b,
                                                        const crofton_manifold_options* options);
/* The points, whose memory is yours to write, and how many have ended (or NULL); valid until the next update. */
CROFTON_API crofton_status crofton_body_contacts_points(crofton_body_contacts* contacts, crofton_tracked_point** points,
                                                        size_t* count, size_t* ended);
/* For debug drawing: each point's normal, `length` >= 0 long, with a cross of that size across it. */
CROFTON_API crofton_status crofton_body_contacts_outline(crofton_body_contacts* contacts, double length,
                                                         crofton_line_visitor visit, void* user);

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

/* Where a ray first meets a body. */
typedef struct crofton_body_ray_hit {
    size_t size;
    double t; /* the ray's; infinite: it hits nothing, and all else is 0 */
    double point[3];
    double normal[3]; /* unit, of the surface, to the side that the ray comes from; 0 if it began inside */
    crofton_part part;
    uint32_t started_inside; /* 1: the ray began in a solid body, and t is 0; else 0 */
} crofton_body_ray_hit;

/* *t is where the ray enters the box, 0 where it starts inside, infinite where it misses. */
CROFTON_API crofton_status crofton_box_raycast(const crofton_box* box, const crofton_ray* ray, double* t);
/* The nearest triangle. Nothing slips through between triangles that share an edge; a ray within the plane of a
 * triangle does not hit that triangle. */
CROFTON_API crofton_status crofton_collider_raycast(const crofton_collider* collider, const crofton_ray* rays,
                                                    size_t count, crofton_ray_hit* hits);
/* Fills a struct whose `size` is set. A solid body that the ray begins in is hit at 0, without a normal; triangles,
 * meshes and height fields have no inside. */
CROFTON_API crofton_status crofton_body_raycast(const crofton_placed* body, const crofton_ray* ray,
                                                crofton_body_ray_hit* hit);
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
CROFTON_API crofton_status crofton_tree_within_sphere(const crofton_tree* tree, const double center[3], double radius,
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

/* Tight, minimal perimeter. */
CROFTON_API crofton_fit_options crofton_default_fit_options(void);
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

#ifdef __cplusplus
}
#endif
#endif
