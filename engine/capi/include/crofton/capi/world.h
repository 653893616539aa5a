/* The front door: objects in; what is seen, what touches and what rays hit, out. docs/world.md is the guide. */
#ifndef CROFTON_CAPI_WORLD_H
#define CROFTON_CAPI_WORLD_H
#include <crofton/capi/contacts.h>
#include <crofton/capi/cull.h>
#include <crofton/capi/rays.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct crofton_world crofton_world;
typedef struct crofton_visible_objects crofton_visible_objects; /* what a view sees, in memory that is kept */
typedef struct crofton_visible_in_views crofton_visible_in_views; /* what up to 32 views see */
typedef struct crofton_found crofton_found;                       /* lists of objects and of hits, likewise */

/* An index that is used again and a generation that tells its users apart; index CROFTON_NONE: none. Calls that take
 * the handle of what has been removed return CROFTON_STALE_HANDLE. */
typedef struct crofton_object {
    uint32_t index, generation;
} crofton_object;
typedef struct crofton_node {
    uint32_t index, generation;
} crofton_node;
typedef struct crofton_world_mesh {
    uint32_t index, generation;
} crofton_world_mesh;

/* In every struct below that begins with `size`, a smaller one than this header's is taken as well: what it lacks is 0,
 * and 0 is the default of every member. Results are written as far as `size` goes. */

typedef struct crofton_world_options {
    size_t size;
    uint32_t without_pairs;       /* 1: neither pairs nor contacts are looked for */
    uint32_t without_contacts;    /* 1: pairs alone */
    uint32_t without_containment; /* 1: a mesh around another object does not touch it */
    uint32_t mesh_depth;          /* 1: depth and direction of contacts between meshes, which cost more */
    uint64_t max_pairs;           /* 0: 2^24 */
    uint64_t rebuild_budget;      /* items' worth of work on the tree an update; 0: 512 */
    uint32_t updates_to_rest;     /* until an object counts as resting again; 0: 16 */
} crofton_world_options;

typedef struct crofton_world_statistics {
    size_t size;
    uint64_t objects, resting, moving;
    uint64_t box_pairs_tested, contact_pairs_tested;
    uint32_t boxes_changed, nodes_updated;
    uint32_t out_of_range; /* objects whose transforms' product has left the range: hidden until they return */
    uint32_t tree_built;
} crofton_world_statistics;

/* Arrays of the caller's, read in place; a stride of 0: packed. Positions are floats, or doubles where is_double is 1;
 * without indices three positions are a triangle. */
typedef struct crofton_mesh_data {
    size_t size;
    const void* positions;
    size_t position_count, position_stride;
    const void* indices;
    size_t index_count;
    uint32_t is_double;         /* positions are double */
    uint32_t is_short;          /* indices are uint16_t, otherwise uint32_t */
    uint32_t without_triangles; /* 1: its box stands for it in rays and contacts */
} crofton_mesh_data;

typedef enum crofton_bound_kind {
    CROFTON_BOUND_NONE = 0,
    CROFTON_BOUND_BOX = 1,
    CROFTON_BOUND_ALIGNED = 2,
    CROFTON_BOUND_BALL = 3
} crofton_bound_kind;

typedef struct crofton_bound {
    uint32_t kind;             /* a crofton_bound_kind: which of the members below count */
    crofton_box box;           /* of a box */
    double min[3], max[3];     /* of an aligned box */
    double center[3], radius; /* of a ball */
} crofton_bound;

/* A mesh (has_mesh = 1), which `transform` or NULL places under `node` (has_node = 1) or in the world; or a bound. */
typedef struct crofton_object_description {
    size_t size;
    uint64_t user;
    const crofton_transform* transform; /* or NULL: the node's own */
    const crofton_bound* bound;         /* or NULL, with a mesh */
    crofton_world_mesh mesh;
    crofton_node node;
    uint32_t has_mesh, has_node;
    uint32_t hidden_layers;      /* those that the object is not in; 0: it is in all */
    uint32_t not_collides_with; /* layers of objects that it does not collide with; 0: with all */
} crofton_object_description;

typedef struct crofton_object_ref {
    crofton_object object;
    uint64_t user;
} crofton_object_ref;

typedef struct crofton_object_hit {
    crofton_object object; /* index CROFTON_NONE: no hit */
    uint64_t user;
    double t;
    double point[3];
    uint32_t triangle; /* of the object's mesh, or CROFTON_NONE */
} crofton_object_hit;

typedef struct crofton_closest_object {
    size_t size;
    crofton_object object; /* index CROFTON_NONE: none within the distance */
    uint64_t user;
    double distance;
    double on_shape[3], on_object[3];
} crofton_closest_object;

typedef struct crofton_object_pair {
    crofton_object_ref first, second; /* first.object.index < second.object.index */
} crofton_object_pair;

typedef enum crofton_contact_phase {
    CROFTON_CONTACT_BEGAN = 0,
    CROFTON_CONTACT_STAYED = 1,
    CROFTON_CONTACT_ENDED = 2
} crofton_contact_phase;

typedef struct crofton_object_contact {
    size_t size;
    crofton_object_ref first, second;
    uint32_t phase;  /* a crofton_contact_phase */
    uint32_t inside; /* a crofton_containment, of first (a) and second (b) */
    double normal[3], depth;
    const crofton_contact_point* points; /* of two bounds, or a mesh and a ball; valid until the next update */
    size_t point_count;
    const crofton_mesh_contact* triangles; /* of two meshes, or a mesh and a box; likewise */
    size_t triangle_count;
} crofton_object_contact;

CROFTON_API crofton_status crofton_world_create(const crofton_world_options* options, crofton_world** world);
CROFTON_API crofton_status crofton_world_destroy(crofton_world* world);

CROFTON_API crofton_status crofton_world_add_mesh(crofton_world* world, const crofton_mesh_data* data,
                                                  crofton_world_mesh* mesh);
CROFTON_API crofton_status crofton_world_replace_mesh(crofton_world* world, crofton_world_mesh mesh,
                                                      const crofton_mesh_data* data);
/* As many as before; only the positions of `data` are looked at. */
CROFTON_API crofton_status crofton_world_set_vertices(crofton_world* world, crofton_world_mesh mesh,
                                                      const crofton_mesh_data* data);
CROFTON_API crofton_status crofton_world_remove_mesh(crofton_world* world, crofton_world_mesh mesh);

/* `parent` or NULL, `transform` or NULL: the identity. */
CROFTON_API crofton_status crofton_world_add_node(crofton_world* world, const crofton_node* parent,
                                                  const crofton_transform* transform, uint32_t layers,
                                                  crofton_node* node);
CROFTON_API crofton_status crofton_world_remove_node(crofton_world* world, crofton_node node);
CROFTON_API crofton_status crofton_world_set_parent(crofton_world* world, crofton_node node,
                                                    const crofton_node* parent);
CROFTON_API crofton_status crofton_world_set_node_layers(crofton_world* world, crofton_node node, uint32_t layers);
/* Strides in bytes, 0: packed. Those that are refused stay, all others move; crofton_last_error_item names the first
 * that was refused. */
CROFTON_API crofton_status crofton_world_set_node_transforms(crofton_world* world, const crofton_node* nodes,
                                                             size_t node_stride, const crofton_transform* transforms,
                                                             size_t transform_stride, size_t count);

CROFTON_API crofton_status crofton_world_add(crofton_world* world, const crofton_object_description* description,
                                             crofton_object* object);
CROFTON_API crofton_status crofton_world_remove(crofton_world* world, crofton_object object);
/* As crofton_world_set_node_transforms. */
CROFTON_API crofton_status crofton_world_set_transforms(crofton_world* world, const crofton_object* objects,
                                                        size_t object_stride, const crofton_transform* transforms,
                                                        size_t transform_stride, size_t count);
CROFTON_API crofton_status crofton_world_set_boxes(crofton_world* world, const crofton_object* objects,
                                                   size_t object_stride, const crofton_box* boxes, size_t box_stride,
                                                   size_t count);
CROFTON_API crofton_status crofton_world_set_bound(crofton_world* world, crofton_object object,
                                                   const crofton_bound* bound);
CROFTON_API crofton_status crofton_world_set_mesh(crofton_world* world, crofton_object object, crofton_world_mesh mesh);
CROFTON_API crofton_status crofton_world_set_hidden(crofton_world* world, crofton_object object, int hidden);
CROFTON_API crofton_status crofton_world_set_layers(crofton_world* world, crofton_object object, uint32_t layers);
CROFTON_API crofton_status crofton_world_set_collides_with(crofton_world* world, crofton_object object,
                                                           uint32_t layers);
CROFTON_API crofton_status crofton_world_set_user(crofton_world* world, crofton_object object, uint64_t user);

/* As of the last update. Of a handle that is stale: CROFTON_STALE_HANDLE. `user`, `box`, `transform` or NULL; a bound
 * has no transform. */
CROFTON_API crofton_status crofton_world_object_get(const crofton_world* world, crofton_object object, uint64_t* user,
                                                    crofton_box* box, crofton_transform* transform);
CROFTON_API crofton_status crofton_world_object_count(const crofton_world* world, size_t* count);
/* *contains is 1 or 0. */
CROFTON_API crofton_status crofton_world_contains(const crofton_world* world, crofton_object object, int* contains);
CROFTON_API crofton_status crofton_world_contains_node(const crofton_world* world, crofton_node node, int* contains);
CROFTON_API crofton_status crofton_world_contains_mesh(const crofton_world* world, crofton_world_mesh mesh,
                                                       int* contains);

/* Once a frame; `jobs` or NULL. */
CROFTON_API crofton_status crofton_world_update(crofton_world* world, const crofton_jobs* jobs);
CROFTON_API crofton_status crofton_world_get_statistics(const crofton_world* world,
                                                        crofton_world_statistics* statistics);

/* Queries: as of the last update, from any number of threads, each with results of its own. */

CROFTON_API crofton_status crofton_visible_objects_create(crofton_visible_objects** visible);
CROFTON_API crofton_status crofton_visible_objects_destroy(crofton_visible_objects* visible);
CROFTON_API crofton_status crofton_world_view(const crofton_world* world, const crofton_view* view,
                                              const crofton_cull_options* options, const crofton_jobs* jobs,
                                              crofton_visible_objects* visible);
/* The objects' indices; *inside of them, the first in tree order, lie inside the view. `inside` or NULL. */
CROFTON_API crofton_status crofton_visible_objects_ids(const crofton_visible_objects* visible, const uint32_t** ids,
                                                       size_t* count, size_t* inside);
/* Writes the objects from place `first` on, at most `capacity`; before the next change of the world. */
CROFTON_API crofton_status crofton_visible_objects_list(const crofton_visible_objects* visible, size_t first,
                                                        crofton_object_ref* objects, size_t capacity);
CROFTON_API crofton_status crofton_visible_objects_get_statistics(const crofton_visible_objects* visible,
                                                                  crofton_cull_statistics* statistics);

CROFTON_API crofton_status crofton_visible_in_views_create(crofton_visible_in_views** visible);
CROFTON_API crofton_status crofton_visible_in_views_destroy(crofton_visible_in_views* visible);
CROFTON_API crofton_status crofton_world_views(const crofton_world* world, const crofton_view* views, size_t count,
                                               const crofton_cull_options* options, crofton_visible_in_views* visible);
CROFTON_API crofton_status crofton_visible_in_views_ids(const crofton_visible_in_views* visible, const uint32_t** ids,
                                                        size_t* count);
/* As crofton_visible_objects_list; bit v of view_masks[i] (or NULL): view v sees the object. */
CROFTON_API crofton_status crofton_visible_in_views_list(const crofton_visible_in_views* visible, size_t first,
                                                         crofton_object_ref* objects, uint32_t* view_masks,
                                                         size_t capacity);

/* hits[i] is the nearest of rays[i]. */
CROFTON_API crofton_status crofton_world_raycast(const crofton_world* world, const crofton_ray* rays, size_t count,
                                                 uint32_t layer_mask, crofton_object_hit* hits);
/* *hit is 1 where the ray hits anything, else 0. */
CROFTON_API crofton_status crofton_world_raycast_any(const crofton_world* world, const crofton_ray* ray,
                                                     uint32_t layer_mask, int* hit);

CROFTON_API crofton_status crofton_found_create(crofton_found** found);
CROFTON_API crofton_status crofton_found_destroy(crofton_found* found);
/* What the last call with `found` has found; valid until the next. */
CROFTON_API crofton_status crofton_found_objects(const crofton_found* found, const crofton_object_ref** objects,
                                                 size_t* count);
CROFTON_API crofton_status crofton_found_hits(const crofton_found* found, const crofton_object_hit** hits,
                                              size_t* count);

/* The nearest hit of every object that the ray meets, by t: into the hits of `found`. */
CROFTON_API crofton_status crofton_world_raycast_all(const crofton_world* world, const crofton_ray* ray,
                                                     uint32_t layer_mask, crofton_found* found);
/* Into the objects of `found`, by index. */
CROFTON_API crofton_status crofton_world_overlap_box(const crofton_world* world, const crofton_box* box,
                                                     uint32_t layer_mask, crofton_found* found);
CROFTON_API crofton_status crofton_world_overlap_ball(const crofton_world* world, const double center[3], double radius,
                                                      uint32_t layer_mask, crofton_found* found);
CROFTON_API crofton_status crofton_world_overlap_capsule(const crofton_world* world, const double begin[3],
                                                         const double end[3], double radius, uint32_t layer_mask,
                                                         crofton_found* found);
/* Fill a struct whose `size` is set. */
CROFTON_API crofton_status crofton_world_closest_to_box(const crofton_world* world, const crofton_box* box,
                                                        double max_distance, uint32_t layer_mask,
                                                        crofton_closest_object* closest);
CROFTON_API crofton_status crofton_world_closest_to_ball(const crofton_world* world, const double center[3],
                                                         double radius, double max_distance, uint32_t layer_mask,
                                                         crofton_closest_object* closest);
CROFTON_API crofton_status crofton_world_closest_to_capsule(const crofton_world* world, const double begin[3],
                                                            const double end[3], double radius, double max_distance,
                                                            uint32_t layer_mask, crofton_closest_object* closest);

/* Valid until the next update. */
CROFTON_API crofton_status crofton_world_pairs(const crofton_world* world, const crofton_object_pair** pairs,
                                               size_t* count);
CROFTON_API crofton_status crofton_world_contact_count(const crofton_world* world, size_t* count);
/* Fills a contact whose `size` is set; in order of the pairs, those that ended among them. */
CROFTON_API crofton_status crofton_world_contact(const crofton_world* world, size_t contact,
                                                 crofton_object_contact* result);

#ifdef __cplusplus
}
#endif
#endif
