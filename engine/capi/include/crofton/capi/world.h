/* SPDX-License-Identifier: MIT */
/* The front door: an engine's objects, what they are and where. world_queries.h asks; docs/world.md is the guide. */
#ifndef CROFTON_CAPI_WORLD_H
#define CROFTON_CAPI_WORLD_H
#include <crofton/capi/geometry.h>
#include <crofton/capi/hooks.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Owns nodes, meshes and objects. Changes take effect in crofton_world_update. */
typedef struct crofton_world crofton_world;

/* An index that is used again and a generation that tells its users apart; index CROFTON_NONE: none. A call that takes
 * the handle of what has been removed returns CROFTON_STALE_HANDLE. */
typedef struct crofton_object {
    uint32_t index, generation;
} crofton_object;
typedef struct crofton_node {
    uint32_t index, generation;
} crofton_node;
typedef struct crofton_world_mesh {
    uint32_t index, generation;
} crofton_world_mesh;

/* The structs of this header and of world_queries.h that begin with `size` may grow. An older, smaller one is taken:
 * members that it lacks are 0, the default of every member, and results are written as far as it goes. A larger one is
 * CROFTON_WRONG_SIZE. */

typedef struct crofton_world_options {
    size_t size;
    uint32_t without_pairs;       /* 1: neither pairs nor contacts are looked for */
    uint32_t without_contacts;    /* 1: pairs alone */
    uint32_t without_containment; /* 1: a closed mesh around another object does not touch it */
    uint32_t with_mesh_depth;     /* 1: contacts between meshes have a way out, which costs more */
    uint64_t max_pairs;           /* more are an error; 0: 2^24 */
    uint64_t rebuild_budget;      /* items' worth of work on the tree an update; 0: a 128th of the objects and 512 */
    uint32_t without_rebuild;     /* 1: no such work, and no allocation for it */
    uint32_t updates_to_rest;     /* without moving, until an object counts as resting again; 0: 16 */
} crofton_world_options;

/* As of the last update. */
typedef struct crofton_world_statistics {
    size_t size;
    uint64_t objects, resting, moving; /* the latter two: shown ones */
    uint64_t box_pairs_tested, contact_pairs_tested;
    uint32_t boxes_changed, nodes_updated;
    uint32_t out_of_range; /* objects that the product of transforms has put beyond it: hidden until they return */
    uint32_t tree_built;   /* 1: all at once, because much has come to rest, or come and gone */
} crofton_world_statistics;

/* A mesh in its own frame, in the caller's arrays; World copies what it needs. Three indices a triangle,
 * counter-clockwise seen from outside; without indices three positions are one. */
typedef struct crofton_mesh_data {
    size_t size;
    const void* positions; /* x y z; of any alignment */
    size_t position_count;
    size_t position_stride; /* in bytes; 0: packed */
    const void* indices;    /* packed */
    size_t index_count;
    uint32_t is_double;         /* 1: positions are double, rounded to float; 0: float */
    uint32_t is_short;          /* 1: indices are uint16_t; 0: uint32_t */
    uint32_t without_triangles; /* 1: the mesh's box stands for it in rays and contacts */
} crofton_mesh_data;

typedef enum crofton_bound_kind {
    CROFTON_BOUND_NONE = 0,
    CROFTON_BOUND_BOX = 1,
    CROFTON_BOUND_ALIGNED_BOX = 2,
    CROFTON_BOUND_BALL = 3
} crofton_bound_kind;

/* The shape of an object without a mesh, in the world's coordinates. */
typedef struct crofton_bound {
    uint32_t kind;            /* a crofton_bound_kind: which members below count */
    crofton_box box;          /* of a box */
    double min[3], max[3];    /* of an aligned box */
    double center[3], radius; /* of a ball */
} crofton_bound;

/* Either a mesh, which `transform` places under `node` or in the world, or a bound. */
typedef struct crofton_object_description {
    size_t size;
    uint64_t user;                      /* given back with every answer */
    const crofton_bound* bound;         /* or NULL, of a mesh */
    const crofton_transform* transform; /* or NULL: the node's own */
    uint32_t has_mesh, has_node;        /* 1: the next two count */
    crofton_world_mesh mesh;
    crofton_node node;
    uint32_t hidden_layers;  /* layers that the object is not in; 0: it is in all */
    uint32_t ignored_layers; /* layers that the object does not collide with; 0: it does with all */
    uint32_t transparent;    /* 1: of an object with a mesh; it hides nothing (world_occlusion.h) */
    uint32_t only_occludes;  /* 1: of an object with a mesh; it is in no answer, and hides what its occluders hide */
} crofton_object_description;

/* `options` or NULL: all defaults. */
CROFTON_API crofton_status crofton_world_create(const crofton_world_options* options, crofton_world** world);
CROFTON_API crofton_status crofton_world_destroy(crofton_world* world);

CROFTON_API crofton_status crofton_world_add_mesh(crofton_world* world, const crofton_mesh_data* data,
                                                  crofton_world_mesh* mesh);
CROFTON_API crofton_status crofton_world_replace_mesh(crofton_world* world, crofton_world_mesh mesh,
                                                      const crofton_mesh_data* data);
/* For a mesh that deforms: as many positions as before. The other members of `data` are not looked at. */
CROFTON_API crofton_status crofton_world_set_vertices(crofton_world* world, crofton_world_mesh mesh,
                                                      const crofton_mesh_data* data);
/* An error while objects use it. */
CROFTON_API crofton_status crofton_world_remove_mesh(crofton_world* world, crofton_world_mesh mesh);

/* `parent` or NULL: none; `transform` or NULL: the identity. `layers` limits those of all objects below. */
CROFTON_API crofton_status crofton_world_add_node(crofton_world* world, const crofton_node* parent,
                                                  const crofton_transform* transform, uint32_t layers,
                                                  crofton_node* node);
/* With all nodes and objects below it. */
CROFTON_API crofton_status crofton_world_remove_node(crofton_world* world, crofton_node node);
/* `parent` or NULL: none. An error where it is the node itself or one below it. */
CROFTON_API crofton_status crofton_world_set_parent(crofton_world* world, crofton_node node,
                                                    const crofton_node* parent);
CROFTON_API crofton_status crofton_world_set_node_layers(crofton_world* world, crofton_node node, uint32_t layers);

/* The calls with strides read members of the caller's structs: `stride` bytes apart, 0: packed. A stride is a multiple
 * of the type's alignment and no less than its size. Items that are refused stay as they are and all others change;
 * crofton_last_error_item is the place of the first that was refused. */

CROFTON_API crofton_status crofton_world_set_node_transforms(crofton_world* world, const crofton_node* nodes,
                                                             size_t node_stride, const crofton_transform* transforms,
                                                             size_t transform_stride, size_t count);

CROFTON_API crofton_status crofton_world_add(crofton_world* world, const crofton_object_description* description,
                                             crofton_object* object);
CROFTON_API crofton_status crofton_world_remove(crofton_world* world, crofton_object object);
/* Of objects that were added with a transform. */
CROFTON_API crofton_status crofton_world_set_transforms(crofton_world* world, const crofton_object* objects,
                                                        size_t object_stride, const crofton_transform* transforms,
                                                        size_t transform_stride, size_t count);
/* Of objects that were added with a bound, which becomes a box. */
CROFTON_API crofton_status crofton_world_set_boxes(crofton_world* world, const crofton_object* objects,
                                                   size_t object_stride, const crofton_box* boxes, size_t box_stride,
                                                   size_t count);
CROFTON_API crofton_status crofton_world_set_bound(crofton_world* world, crofton_object object,
                                                   const crofton_bound* bound);
/* Of an object that has one. */
CROFTON_API crofton_status crofton_world_set_mesh(crofton_world* world, crofton_object object, crofton_world_mesh mesh);
/* A hidden object (1) is in no answer until it is shown again (0). */
CROFTON_API crofton_status crofton_world_set_hidden(crofton_world* world, crofton_object object, int hidden);
CROFTON_API crofton_status crofton_world_set_layers(crofton_world* world, crofton_object object, uint32_t layers);
CROFTON_API crofton_status crofton_world_set_collides_with(crofton_world* world, crofton_object object,
                                                           uint32_t layers);
CROFTON_API crofton_status crofton_world_set_user(crofton_world* world, crofton_object object, uint64_t user);

/* Makes the changes take effect; once a frame. `jobs` or NULL. CROFTON_BUDGET_EXCEEDED: more than max_pairs pairs;
 * then there are none, and all else is as it should be. */
CROFTON_API crofton_status crofton_world_update(crofton_world* world, const crofton_jobs* jobs);
CROFTON_API crofton_status crofton_world_get_statistics(const crofton_world* world,
                                                        crofton_world_statistics* statistics);

#ifdef __cplusplus
}
#endif
#endif
