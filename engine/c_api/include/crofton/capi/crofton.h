/* SPDX-License-Identifier: MIT */
/* Crofton for C and for languages that call C. This header has World; modules.h has its parts for engines that do
 * without it.
 *
 * Every function that can fail returns a status; nothing throws. Results are written to the last parameters, which a
 * failed call leaves unchanged. Only a failed allocation may end the program. "or NULL" marks parameters that may be
 * NULL.
 *
 * Structs that may grow begin with `size`. Get descriptions and options from their crofton_default_...(), then change
 * members. Before a call that fills a struct, set its `size` to sizeof(the struct).
 *
 * Threads: calls on different handles are independent. Calls that take a pointer to const may run on one handle at the
 * same time; no other call may run on a handle at the same time as any call. With crofton_set_thread_checks, a
 * violation returns CROFTON_BUSY.
 */
#ifndef CROFTON_CAPI_CROFTON_H
#define CROFTON_CAPI_CROFTON_H
#include <crofton/capi/base.h>
#include <crofton/capi/modules.h>

#ifdef __cplusplus
extern "C" {
#endif

/* World holds a game's objects and answers queries about them. Guide: docs/world.md. */

/* Owns nodes, meshes and objects. Changes take effect in crofton_world_update. */
typedef struct crofton_world crofton_world;

/* Handles: an index, which is reused after removal, and a generation, which tells apart those that have used it. Index
 * CROFTON_NONE is no handle. Calls return CROFTON_STALE_HANDLE for a handle whose object, node or mesh was removed, for
 * one of another world, and for {0, 0}. */
typedef struct crofton_object {
    uint32_t index, generation;
} crofton_object;
typedef struct crofton_node {
    uint32_t index, generation;
} crofton_node;
typedef struct crofton_world_mesh {
    uint32_t index, generation;
} crofton_world_mesh;

/* A smaller struct of this header, from an older version, is accepted: members that it lacks have their defaults, and
 * results are written up to its size. A larger one is refused (CROFTON_WRONG_SIZE). */

#define CROFTON_AUTOMATIC UINT64_MAX

typedef struct crofton_world_options {
    size_t size;
    uint32_t pairs;       /* 1: updates find pairs and contacts; 0: neither */
    uint32_t contacts;    /* 1; 0: updates find pairs only */
    uint32_t containment; /* 1: an object inside a closed mesh counts as a contact */
    uint32_t mesh_depth;  /* 0; 1: computes depths of contacts between meshes; takes longer than finding them */
    uint64_t max_pairs;   /* 2^24: an update with more fails */
    /* Items' worth of background work on the tree in each update; 0: none, and no allocation. CROFTON_AUTOMATIC: at
     * least a 2048th of the objects and 128 while a rebuild is under way. */
    uint64_t rebuild_budget;
    uint32_t updates_to_rest; /* 16: updates without motion after which an object rests again */
    double contact_margin;    /* 0: gaps up to this between shapes are contacts */
} crofton_world_options;

/* As of the last update. */
typedef struct crofton_world_statistics {
    size_t size;
    uint64_t objects;         /* all, hidden ones too */
    uint64_t resting, moving; /* none that is hidden or in no layer */
    uint64_t box_pairs_tested, contact_pairs_tested;
    uint32_t boxes_changed, nodes_updated;
    uint32_t out_of_range; /* objects whose product of transforms is out of range: hidden until it is valid */
    uint32_t tree_built;   /* 1: in one go: a scene was loaded, or much came to rest */
    uint64_t object_count; /* as of now, hidden ones included */
    uint64_t
        occluders_waiting; /* objects of regions whose occluders are not placed yet; they hide nothing until then */
} crofton_world_statistics;

/* A mesh in its own frame, in your arrays; World copies what it needs. Each triangle has three indices,
 * counter-clockwise seen from outside. With an index_count of 0, each three positions are a triangle. */
typedef struct crofton_mesh_data {
    size_t size;
    const void* positions; /* x y z; need not be aligned */
    size_t position_count;
    size_t position_stride; /* in bytes; 0: packed */
    const void* indices;    /* packed */
    size_t index_count;
    uint32_t is_double; /* 1: positions are double, rounded to float; 0: float */
    uint32_t is_short;  /* 1: indices are uint16_t; 0: uint32_t */
    uint32_t triangles; /* 1: queries test the triangles; 0: they test the mesh's box */
    uint32_t clusters;  /* 0; 1: views with a picture list the triangles by clusters (crofton_world_get_mesh) */
    uint32_t one_sided; /* 0; 1, with clusters: back faces are not drawn; they are listed for mirrored objects only */
    /* NULL; or with clusters: those of this mesh that were cut before, as crofton_baked_scene_clusters gives them */
    const crofton_clustered_mesh* precut;
} crofton_mesh_data;

typedef enum crofton_bound_kind {
    CROFTON_BOUND_NONE = 0,
    CROFTON_BOUND_BOX = 1,
    CROFTON_BOUND_ALIGNED_BOX = 2,
    CROFTON_BOUND_SPHERE = 3
} crofton_bound_kind;

/* The bound of an object without a mesh, in world coordinates. */
typedef struct crofton_bound {
    uint32_t kind;            /* a crofton_bound_kind: says which members below are used */
    crofton_box box;          /* of a box */
    double min[3], max[3];    /* of an aligned box */
    double center[3], radius; /* of a sphere */
} crofton_bound;

/* Give an object a mesh or a shape, placed by `transform` under `node` or in the world, or a bound. */
typedef struct crofton_object_description {
    size_t size;
    uint64_t user;                      /* returned with every answer */
    const crofton_bound* bound;         /* or NULL, for an object with a mesh or only a shape */
    const crofton_transform* transform; /* or NULL: the identity */
    uint32_t has_mesh, has_node;        /* 1: mesh, or node, is used */
    crofton_world_mesh mesh;
    crofton_node node;
    uint32_t layers;        /* all; a query finds objects that share a layer with its mask */
    uint32_t collides_with; /* all layers; 0: the object forms no pairs */
    uint32_t occludes;      /* 1: the object's mesh hides others; 0: it does not, for transparent objects */
    uint32_t only_occludes; /* 0; 1, with a mesh: no answer contains the object, but its occluders hide others */
    /* Or NULL. You may destroy the shape at any time: the world keeps what it needs. Queries use it at once, pairs from
     * the next update on. From the next update on, the object's box also contains it. Half-spaces, and compounds that
     * contain some, are infinite ground. The object's transform scales the shape. CROFTON_UNSUPPORTED: the transform
     * would turn the shape into another kind, as a non-uniform scale does with a sphere; calls that move objects and
     * nodes return the same error. */
    const crofton_shape* shape;
    uint32_t hidden; /* 0; 1: no answer contains the object */
} crofton_object_description;

/* The members of a description that crofton_world_set sets. */
typedef enum crofton_object_members {
    CROFTON_SET_USER = 1,
    CROFTON_SET_LAYERS = 2,
    CROFTON_SET_COLLIDES_WITH = 4,
    CROFTON_SET_HIDDEN = 8,
    CROFTON_SET_OCCLUDES = 16, /* for an object with a mesh */
    CROFTON_SET_MESH = 32,     /* for an object that has one */
    CROFTON_SET_BOUND = 64,    /* for an object that was added with one */
    CROFTON_SET_SHAPE = 128    /* NULL removes it; not for an object that was added with only a shape */
} crofton_object_members;

CROFTON_API crofton_world_options crofton_default_world_options(void);
CROFTON_API crofton_mesh_data crofton_default_mesh_data(void);
CROFTON_API crofton_object_description crofton_default_object_description(void);

/* `options` or NULL: the defaults. */
CROFTON_API crofton_status crofton_world_create(const crofton_world_options* options, crofton_world** world);
CROFTON_API crofton_status crofton_world_destroy(crofton_world* world);

CROFTON_API crofton_status crofton_world_add_mesh(crofton_world* world, const crofton_mesh_data* data,
                                                  crofton_world_mesh* mesh);
CROFTON_API crofton_status crofton_world_replace_mesh(crofton_world* world, crofton_world_mesh mesh,
                                                      const crofton_mesh_data* data);
/* Moves the vertices of a mesh that deforms: as many positions as before. Ignores the other members of `data`. */
CROFTON_API crofton_status crofton_world_set_vertices(crofton_world* world, crofton_world_mesh mesh,
                                                      const crofton_mesh_data* data);
/* Error: objects use the mesh. */
CROFTON_API crofton_status crofton_world_remove_mesh(crofton_world* world, crofton_world_mesh mesh);

/* `parent` or NULL: none; `transform` or NULL: the identity. Objects below have only those of their layers that are
 * also in `layers`. */
CROFTON_API crofton_status crofton_world_add_node(crofton_world* world, const crofton_node* parent,
                                                  const crofton_transform* transform, uint32_t layers,
                                                  crofton_node* node);
/* Removes the node with all nodes and objects below it. */
CROFTON_API crofton_status crofton_world_remove_node(crofton_world* world, crofton_node node);
/* `parent` or NULL: none. CROFTON_INVALID_ARGUMENT: the parent is the node itself or one below it. */
CROFTON_API crofton_status crofton_world_set_parent(crofton_world* world, crofton_node node,
                                                    const crofton_node* parent);
CROFTON_API crofton_status crofton_world_set_node_layers(crofton_world* world, crofton_node node, uint32_t layers);

/* Strides let calls read members of your own structs: elements are `stride` bytes apart; 0: packed. A stride must be a
 * multiple of the type's alignment and at least its size. A call applies all valid items and leaves the others
 * unchanged; crofton_last_error_item is the place of the first invalid one. */

CROFTON_API crofton_status crofton_world_set_node_transforms(crofton_world* world, const crofton_node* nodes,
                                                             size_t node_stride, const crofton_transform* transforms,
                                                             size_t transform_stride, size_t count);

CROFTON_API crofton_status crofton_world_add(crofton_world* world, const crofton_object_description* description,
                                             crofton_object* object);
/* Adds many; the descriptions lie as far from each other as their `size` says, which all share. Adds all valid ones.
 * The handles of the others become 0, and crofton_last_error_item is the place of the first of them. */
CROFTON_API crofton_status crofton_world_add_many(crofton_world* world, const crofton_object_description* descriptions,
                                                  size_t count, crofton_object* objects);
/* Takes memory for so many objects in all, so that no later call copies what the world knows of each to larger memory.
 */
CROFTON_API crofton_status crofton_world_reserve(crofton_world* world, size_t objects);
CROFTON_API crofton_status crofton_world_remove(crofton_world* world, crofton_object object);
/* Requires objects that were added with a transform, or by a shape under no node. */
CROFTON_API crofton_status crofton_world_set_transforms(crofton_world* world, const crofton_object* objects,
                                                        size_t object_stride, const crofton_transform* transforms,
                                                        size_t transform_stride, size_t count);
/* Requires objects that were added with a bound; it becomes a box. */
CROFTON_API crofton_status crofton_world_set_boxes(crofton_world* world, const crofton_object* objects,
                                                   size_t object_stride, const crofton_box* boxes, size_t box_stride,
                                                   size_t count);
/* Sets members of an object. `members` is a sum of crofton_object_members, with at most one of the last four. An error
 * changes nothing. */
CROFTON_API crofton_status crofton_world_set(crofton_world* world, crofton_object object, uint32_t members,
                                             const crofton_object_description* description);

/* Regions: parts of a large world, prepared on any thread and attached in constant time. Guide: docs/large_worlds.md.
 */

/* Many objects that do not move. A region never changes; any thread may use it. */
typedef struct crofton_region crofton_region;
/* A region that is attached at an origin. */
typedef struct crofton_attached_region {
    uint32_t index, generation;
} crofton_attached_region;

#define CROFTON_FIRST_REGION_INDEX 0x80000000u /* objects of regions have indices from here on, consecutive in each */

/* An object of a region: a bound, a mesh, or only a shape, relative to the region's origin. Get it from
 * crofton_default_region_object(). */
typedef struct crofton_region_object {
    crofton_bound bound;
    uint64_t user;
    uint32_t layers, collides_with; /* all */
    uint32_t mesh;                  /* CROFTON_NONE, or a place in the options' meshes */
    uint32_t occludes;              /* 1; 0: the object's mesh does not hide others */
    uint32_t only_occludes; /* 0; 1, with a mesh: no answer contains the object, but its occluders hide others */
    const crofton_transform* transform; /* of a mesh or a shape without a bound; NULL: the identity */
    /* Or NULL. Not infinite ground, which you add to the world itself. You may destroy it once the region is prepared.
     */
    const crofton_shape* shape;
} crofton_region_object;

typedef struct crofton_region_options {
    size_t size;
    uint64_t max_objects; /* 2^24; a region with more is refused */
    /* Or NULL. Return 1 to stop (CROFTON_CANCELLED). Called every few milliseconds. */
    int (*should_stop)(void* user, double share_done);
    void* stop_user;
    const crofton_mesh_data* meshes; /* that the objects share; or NULL */
    size_t mesh_count;
    uint32_t find_occluders; /* 0; 1: searches the meshes for occluders, as crofton_world_find_occluders does */
    /* 1e9: no coordinate of an origin may be larger if an object has a mesh or a shape, whose box is wider by about
     * 1e-15 of it. */
    double max_origin;
} crofton_region_options;

/* What a region holds. */
typedef struct crofton_region_info {
    size_t size;
    uint64_t object_count;
    uint64_t bytes;        /* of memory; occluders and clusters are not counted */
    double min[3], max[3]; /* around all objects, relative to the origin; without objects min is infinite, max is its
                              negative */
} crofton_region_info;

CROFTON_API crofton_region_object crofton_default_region_object(void);
CROFTON_API crofton_region_options crofton_default_region_options(void);
/* Prepares a region; call it on any thread. `options`, `jobs` or NULL. If an object or a mesh is refused,
 * crofton_last_error_item is its place. */
CROFTON_API crofton_status crofton_region_prepare(const crofton_region_object* objects, size_t count,
                                                  const crofton_region_options* options, const crofton_jobs* jobs,
                                                  crofton_region** region);
/* You may destroy a region at any time: a world keeps what it needs. */
CROFTON_API crofton_status crofton_region_destroy(crofton_region* region);
/* Fills a struct whose `size` is set. */
CROFTON_API crofton_status crofton_region_get_info(const crofton_region* region, crofton_region_info* info);
/* Sets *mesh to the place of an object's mesh among the region's, or to CROFTON_NONE if it has none.
 * CROFTON_OUT_OF_RANGE: there is no such object. */
CROFTON_API crofton_status crofton_region_mesh_of(const crofton_region* region, uint32_t place, uint32_t* mesh);
/* Returns the clusters of a mesh, to which a view's triangles refer; valid as long as `region`. CROFTON_EMPTY: there is
 * no such mesh, or it has no clusters. */
CROFTON_API crofton_status crofton_region_clusters_of(const crofton_region* region, uint32_t mesh,
                                                      crofton_clusters* clusters);
/* Attaches a region: from the next update on, answers contain its objects, moved by `origin`. */
CROFTON_API crofton_status crofton_world_attach(crofton_world* world, const crofton_region* region,
                                                const double origin[3], crofton_attached_region* attached);
/* Detaches a region. Handles of its objects are stale at once; views follow with the next update. */
CROFTON_API crofton_status crofton_world_detach(crofton_world* world, crofton_attached_region region);
/* Returns the object at `place` in the array that the region was prepared from. crofton_world_set can hide it; other
 * changes are CROFTON_UNSUPPORTED. */
CROFTON_API crofton_status crofton_world_object_in(const crofton_world* world, crofton_attached_region region,
                                                   uint32_t place, crofton_object* object);
/* Returns the region and place of an object. CROFTON_INVALID_ARGUMENT: the object was added by crofton_world_add. */
CROFTON_API crofton_status crofton_world_place_of(const crofton_world* world, crofton_object object,
                                                  crofton_attached_region* region, uint32_t* place);

/* Applies the changes and finds pairs and contacts. Call it once a frame. `jobs` or NULL. CROFTON_BUDGET_EXCEEDED: more
 * than max_pairs pairs; all pairs are dropped, everything else is up to date. */
CROFTON_API crofton_status crofton_world_update(crofton_world* world, const crofton_jobs* jobs);
CROFTON_API crofton_status crofton_world_get_statistics(const crofton_world* world,
                                                        crofton_world_statistics* statistics);

/* Queries. All answer as of the last update. */

typedef struct crofton_found crofton_found; /* a list of objects or hits, which keeps its memory from call to call */

typedef struct crofton_object_ref {
    crofton_object object;
    uint64_t user;
} crofton_object_ref;

typedef struct crofton_object_hit {
    crofton_object object; /* index CROFTON_NONE: no hit, and t is infinite */
    uint64_t user;
    double t; /* the ray's */
    double point[3];
    uint32_t triangle;      /* of the object's mesh or its shape's surface, or CROFTON_NONE */
    uint32_t child;         /* of a compound shape; else 0 */
    double normal[3];       /* of the surface, unit, towards the ray's origin; 0 if the ray began inside */
    uint8_t started_inside; /* 1: the ray began in the shape, box or sphere, and t is 0; else 0 */
} crofton_object_hit;

typedef struct crofton_closest_object {
    size_t size;
    crofton_object object; /* index CROFTON_NONE: none within max_distance; `distance` is then infinite */
    uint64_t user;
    double distance;
    double on_shape[3], on_object[3]; /* nearest points; if they overlap, any common point */
    uint32_t triangle;                /* at on_object, of the object's mesh or its shape's surface, or CROFTON_NONE */
    uint32_t child;                   /* of a compound shape; else 0 */
} crofton_closest_object;

typedef struct crofton_object_pair {
    crofton_object_ref first, second; /* first.object.index < second.object.index */
} crofton_object_pair;

typedef enum crofton_contact_phase {
    CROFTON_CONTACT_BEGAN = 0,
    CROFTON_CONTACT_STAYED = 1,
    CROFTON_CONTACT_ENDED = 2
} crofton_contact_phase;

/* Two objects that touch, or that have ended touching in this update; these have only the handles, which may be
 * stale. Shapes also touch up to the contact margin. Convex ones keep the face and points of the last update while they
 * are as good within 1e-4 of the pair's size. A pair that rests is not computed again. */
typedef struct crofton_object_contact {
    crofton_object_ref first, second; /* ordered as in crofton_object_pair */
    uint8_t phase;                    /* a crofton_contact_phase */
    uint8_t inside;                   /* a crofton_containment of first (a) and second (b) */
    double normal[3];                 /* unit, from first to second; 0 if no direction is known */
    double depth; /* of the deepest point; between meshes as a motion that separates them, if mesh_depth is set */
    const crofton_contact_point* points; /* at most four, in the world, none for two shapes; until the next update */
    size_t point_count;
    const crofton_mesh_contact* triangles; /* of two meshes, or of a mesh and a box; valid as long */
    size_t triangle_count;
    crofton_tracked_point* shape_points; /* of two shapes; you may write their `memory`; valid as long */
    size_t shape_point_count;
} crofton_object_contact;

/* The first object that a moving shape meets. */
typedef struct crofton_shape_hit {
    size_t size;
    crofton_object object; /* index CROFTON_NONE: none; `time` is then infinite */
    uint64_t user;
    double time;
    double normal[3];  /* unit, from the shape to the object */
    double point[3];   /* on the object's surface */
    uint32_t triangle; /* of the object's mesh or its shape's surface, or CROFTON_NONE */
    uint32_t result;   /* a crofton_cast_result; unresolved: it meets nothing before `time` */
    double distance;   /* gap at that time; negative: how deep they overlap, from the start */
    uint32_t child;    /* of a compound shape; else 0 */
} crofton_shape_hit;

/* Where a shape touches an object: the points of one direction. */
typedef struct crofton_object_manifold {
    crofton_object object;
    uint64_t user;
    double normal[3]; /* unit, from the shape to the object */
    double depth;     /* of the deepest point; negative: a gap */
    uint32_t point_count;
    crofton_shape_point points[CROFTON_MAX_MANIFOLD_POINTS];
} crofton_object_manifold;

/* An object's data; box and transform as of the last update. */
typedef struct crofton_object_info {
    size_t size;
    uint64_t user;
    uint32_t has_box;       /* 0 until the first update after the object was added; box is then 0 */
    uint32_t has_transform; /* 1 if the object has a transform, from the first update on */
    crofton_box box;
    crofton_transform transform; /* object to world */
} crofton_object_info;

typedef struct crofton_mesh_info {
    size_t size;
    size_t occluder_count;
    crofton_clusters clusters; /* as of the last update, valid until the next; all 0 for a mesh without clusters */
} crofton_mesh_info;

/* Fill a struct whose `size` is set. CROFTON_STALE_HANDLE: the world does not contain it. */
CROFTON_API crofton_status crofton_world_get_object(const crofton_world* world, crofton_object object,
                                                    crofton_object_info* info);
CROFTON_API crofton_status crofton_world_get_mesh(const crofton_world* world, crofton_world_mesh mesh,
                                                  crofton_mesh_info* info);
/* Sets *contains to 1 or 0. */
CROFTON_API crofton_status crofton_world_contains_node(const crofton_world* world, crofton_node node, int* contains);

/* Lists the objects that `count` views see, at most 32: objects whose boxes they see and, with occlusion, that are not
 * hidden. Each object is listed once. Each request has its own options. `jobs` or NULL.
 *
 * All requests have the same `size` and are that many bytes apart. On an error, crofton_last_error_item is the place of
 * the refused request. Allocates nothing once `result` has held as many objects. */
CROFTON_API crofton_status crofton_world_view(const crofton_world* world, const crofton_view_request* requests,
                                              size_t count, const crofton_jobs* jobs, crofton_view_result* result);
/* Writes the objects from place `first` on, at most `capacity`. Bit v of view_masks[i] says whether view v sees
 * objects[i]; `view_masks` or NULL.
 *
 * `world` is the world of the view. CROFTON_INVALID_ARGUMENT: it was updated since. */
CROFTON_API crofton_status crofton_view_result_list(const crofton_view_result* result, const crofton_world* world,
                                                    size_t first, crofton_object_ref* objects, uint32_t* view_masks,
                                                    size_t capacity);

/* Limits rays, overlaps, nearest objects and casts to some of the objects. */
typedef struct crofton_query_filter {
    size_t size;
    uint32_t layers; /* all; finds objects that share a layer with this mask */
    /* Finds none of these, for example the object that asks and what it carries; NULL if ignored_count is 0. Each
     * object that comes into question is compared with all of them, so pass a few, and use layers for many. A stale
     * handle has no effect. */
    const crofton_object* ignored;
    size_t ignored_count;
} crofton_query_filter;

CROFTON_API crofton_query_filter crofton_default_query_filter(void);

/* Sets hits[i] to the nearest hit of rays[i]. `filter` or NULL: all objects; so in the functions below. Tests an
 * object's shape, or if it has none, its mesh's triangles, its sphere or its box.
 */
CROFTON_API crofton_status crofton_world_raycast(const crofton_world* world, const crofton_ray* rays, size_t count,
                                                 const crofton_query_filter* filter, crofton_object_hit* hits);
/* Sets *hit to 1 if the ray hits anything, else to 0. */
CROFTON_API crofton_status crofton_world_raycast_any(const crofton_world* world, const crofton_ray* ray,
                                                     const crofton_query_filter* filter, int* hit);

CROFTON_API crofton_status crofton_found_create(crofton_found** found);
CROFTON_API crofton_status crofton_found_destroy(crofton_found* found);
/* Return what the last query with `found` has found; valid until the next. Shape hits are hits[0].size bytes apart. */
CROFTON_API crofton_status crofton_found_objects(const crofton_found* found, const crofton_object_ref** objects,
                                                 size_t* count);
CROFTON_API crofton_status crofton_found_hits(const crofton_found* found, const crofton_object_hit** hits,
                                              size_t* count);
CROFTON_API crofton_status crofton_found_shape_hits(const crofton_found* found, const crofton_shape_hit** hits,
                                                    size_t* count);
CROFTON_API crofton_status crofton_found_manifolds(const crofton_found* found,
                                                   const crofton_object_manifold** manifolds, size_t* count);

/* Lists the nearest hit of each object that the ray hits, in order of t, then of index. Read it by crofton_found_hits.
 */
CROFTON_API crofton_status crofton_world_raycast_all(const crofton_world* world, const crofton_ray* ray,
                                                     const crofton_query_filter* filter, crofton_found* found);
/* Finds the objects that overlap the probe, in order of index: their shapes, or if they have none, their meshes'
 * triangles, their spheres or boxes. A probe inside a closed mesh overlaps it if `containment` of the world's options
 * is set. CROFTON_UNSUPPORTED: a half-space. */
CROFTON_API crofton_status crofton_world_overlap(const crofton_world* world, const crofton_query_shape* probe,
                                                 const crofton_query_filter* filter, crofton_found* found);
/* Fills a struct whose `size` is set: the object nearest to the probe, as above, no farther than max_distance, which
 * may be infinite. If several are equally near, the one with the lowest index. */
CROFTON_API crofton_status crofton_world_closest(const crofton_world* world, const crofton_query_shape* probe,
                                                 double max_distance, const crofton_query_filter* filter,
                                                 crofton_closest_object* closest);

/* Returns the pairs of objects whose boxes or spheres overlap, in order; valid until the next update. */
CROFTON_API crofton_status crofton_world_pairs(const crofton_world* world, const crofton_object_pair** pairs,
                                               size_t* count);
/* Returns the pairs that touch, and those that have ended touching, in order; valid until the next update. */
CROFTON_API crofton_status crofton_world_contacts(const crofton_world* world, const crofton_object_contact** contacts,
                                                  size_t* count);

/* Finds the first object that a moving shape meets, by the objects' shapes as for crofton_world_overlap; a shape inside
 * a closed mesh meets it from inside. Fills a struct whose `size` is set. `options` or NULL. */
CROFTON_API crofton_status crofton_world_cast(const crofton_world* world, const crofton_placed* probe,
                                              const crofton_motion* motion, const crofton_cast_options* options,
                                              const crofton_query_filter* filter, crofton_shape_hit* hit);
/* Lists the first hit of each object that the moving shape meets, in order of time, then of index. Read it by
 * crofton_found_shape_hits. */
CROFTON_API crofton_status crofton_world_cast_all(const crofton_world* world, const crofton_placed* probe,
                                                  const crofton_motion* motion, const crofton_cast_options* options,
                                                  const crofton_query_filter* filter, crofton_found* found);
/* Lists where a shape, which need not be an object, touches the objects, in order of index; of one object the deepest
 * manifold comes first. Objects that lie flush push as their union does. Read it by crofton_found_manifolds. `options`
 * or NULL. CROFTON_UNSUPPORTED: a half-space. */
CROFTON_API crofton_status crofton_world_manifolds(const crofton_world* world, const crofton_placed* probe,
                                                   const crofton_manifold_options* options,
                                                   const crofton_query_filter* filter, crofton_found* found);

/* Occluders: geometry by which a mesh's objects hide others. Guide: docs/occlude.md. */

typedef enum crofton_occluder_kind {
    CROFTON_OCCLUDER_BOX = 0,    /* inside a closed piece of the mesh */
    CROFTON_OCCLUDER_WALLED = 1, /* a box behind walls of the mesh; it may be open on some sides */
    CROFTON_OCCLUDER_CONVEX = 2, /* the convex hull of the positions */
    CROFTON_OCCLUDER_PATCH = 3   /* any triangles */
} crofton_occluder_kind;

/* In the mesh's frame. Your own occluders must be opaque and lie within the drawn mesh. */
typedef struct crofton_occluder {
    size_t size;
    uint32_t kind;          /* a crofton_occluder_kind */
    uint32_t is_one_sided;  /* 1: a patch that hides only from the side where its triangles are counter-clockwise */
    const float* positions; /* x y z, packed; not needed for a box that you give */
    size_t position_count;
    const uint32_t* indices; /* not needed for a convex hull that you give */
    size_t index_count;
    crofton_box box;                   /* of a box, walled or not */
    uint32_t edges;                    /* the cost of drawing it; 0: estimated */
    uint32_t has_piece, has_eyes;      /* 1: the next members are used */
    double piece_min[3], piece_max[3]; /* not used for an eye in here */
    double eyes_min[3], eyes_max[3];   /* used only for an eye in here; may be infinite */
    double mean_shadow, gain; /* of found occluders: how much it covers, and how much it adds to those before it */
} crofton_occluder;

/* 0 in any member: the default. */
typedef struct crofton_find_options {
    size_t size;
    uint32_t is_two_sided; /* 1: back faces are drawn as well */
    uint32_t max_occluders, max_edges, max_boxes_a_piece, grid;
    double least_gain, flatness;
    uint32_t max_patch_triangles;
    uint32_t level_triangles; /* not 0: takes a level of many small pieces as surfaces of so many triangles, say 48 */
} crofton_find_options;

typedef struct crofton_occluder_ref {
    crofton_object object;
    uint64_t user;
    uint32_t place; /* in the list of the mesh's occluders */
    uint32_t unused;
} crofton_occluder_ref;

CROFTON_API crofton_find_options crofton_default_find_options(void);
/* Searches a mesh for occluders, which the next update applies. Takes a second or more for 100,000 triangles. `options`
 * or NULL: the defaults. */
CROFTON_API crofton_status crofton_world_find_occluders(crofton_world* world, crofton_world_mesh mesh,
                                                        const crofton_find_options* options);
/* Sets a mesh's occluders: those of an earlier search, or your own. A count of 0 removes them. All have the same `size`
 * and are that many bytes apart. If one is refused, crofton_last_error_item is its place, and nothing changes. */
CROFTON_API crofton_status crofton_world_set_occluders(crofton_world* world, crofton_world_mesh mesh,
                                                       const crofton_occluder* occluders, size_t count);
/* Fills a struct whose `size` is set. Its arrays are valid until the mesh's occluders change. */
CROFTON_API crofton_status crofton_world_get_occluder(const crofton_world* world, crofton_world_mesh mesh, size_t place,
                                                      crofton_occluder* occluder);
/* Lists the occluders that hide an object, none if it is not hidden. With `hidden` NULL, lists all drawn occluders,
 * those that hide most first. Writes at most `capacity`, and sets *count to how many there are. Draws all occluders
 * again for one object, and allocates. `world` is the world of the view, which had one request.
 * CROFTON_INVALID_ARGUMENT: the world was updated since. */
CROFTON_API crofton_status crofton_view_result_occluders(const crofton_view_result* result, const crofton_world* world,
                                                         const crofton_object* hidden, crofton_occluder_ref* occluders,
                                                         size_t capacity, size_t* count);

#ifdef __cplusplus
}
#endif
#endif
