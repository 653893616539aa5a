/* SPDX-License-Identifier: MIT */
/* Scenes and trees as they are baked into files and read from them. A game whose objects live in a World needs
 * neither. Link crofton_bake as well as crofton. */
#ifndef CROFTON_CAPI_SCENE_H
#define CROFTON_CAPI_SCENE_H
#include <crofton/capi/crofton.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The scene graph: who is where, and how large. */

typedef struct crofton_scene crofton_scene;

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

/* A hierarchy over boxes. */

typedef struct crofton_tree crofton_tree;

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
/* Brings the tree up to date, and then rebuilds in the background, `rebuild_budget` items' worth of work a call; 0: not
 * at all. Once a frame. */
CROFTON_API crofton_status crofton_tree_refit(crofton_tree* tree, size_t rebuild_budget);

/* Finds what a view sees of the tree; `jobs` or NULL. CROFTON_UNSUPPORTED: a request with occlusion or a picture.
 * Allocates nothing once `result` has grown to the largest answer. */
CROFTON_API crofton_status crofton_tree_view(const crofton_tree* tree, const crofton_view_request* request,
                                             const crofton_jobs* jobs, crofton_view_result* result);
/* Where a ray enters an item's box first. */
typedef struct crofton_ray_hit {
    double t;
    uint32_t index; /* the item; CROFTON_NONE: no hit, and t is infinite */
} crofton_ray_hit;

/* Of the items whose layers share a bit with `layer_mask`, the one whose box each ray enters first. */
CROFTON_API crofton_status crofton_tree_raycast(const crofton_tree* tree, const crofton_ray* rays, size_t count,
                                                uint32_t layer_mask, crofton_ray_hit* hits);
/* Writes the first `capacity` of the items that meet a box, sphere or capsule, ascending, and in *found how many there
 * are in all. */
CROFTON_API crofton_status crofton_tree_overlap(const crofton_tree* tree, const crofton_shape* shape,
                                                uint32_t layer_mask, uint32_t* items, size_t capacity, size_t* found);

#ifdef __cplusplus
}
#endif
#endif
