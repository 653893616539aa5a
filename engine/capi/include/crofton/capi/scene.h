/* SPDX-License-Identifier: MIT */
/* The scene graph: who is where, and how large. */
#ifndef CROFTON_CAPI_SCENE_H
#define CROFTON_CAPI_SCENE_H
#include <crofton/capi/geometry.h>
#include <crofton/capi/hooks.h>

#ifdef __cplusplus
extern "C" {
#endif

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

#ifdef __cplusplus
}
#endif
#endif
