/* SPDX-License-Identifier: MIT */
/* Scenes and trees, for baking them into files and reading them. Games that use World need neither.
 * Link crofton_bake as well as crofton. */
#ifndef CROFTON_CAPI_SCENE_H
#define CROFTON_CAPI_SCENE_H
#include <crofton/capi/crofton.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The scene graph: nodes, meshes, instances and their boxes. */

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
/* The ids of other instances stay the same; this id is reused. */
CROFTON_API crofton_status crofton_scene_remove_instance(crofton_scene* scene, uint32_t instance);

/* Updates world transforms and boxes. `jobs`, `statistics` or NULL. */
CROFTON_API crofton_status crofton_scene_update(crofton_scene* scene, const crofton_jobs* jobs,
                                                crofton_update_statistics* statistics);

/* Returns boxes and layer masks by instance id. Removed instances have the layer mask 0. Valid until the scene's next
 * non-const call. */
CROFTON_API crofton_status crofton_scene_boxes(const crofton_scene* scene, const crofton_box** boxes,
                                               const uint32_t** layer_masks, size_t* count);
/* Returns the instances whose box or world transform changed in the last update, ascending; valid as above. */
CROFTON_API crofton_status crofton_scene_moved(const crofton_scene* scene, const uint32_t** instances, size_t* count);

/* A hierarchy over boxes. */

typedef struct crofton_tree crofton_tree;

/* Builds a tree. Item i is boxes[i] in the layers layer_masks[i], in all if `layer_masks` is NULL. Copies both arrays.
 */
CROFTON_API crofton_status crofton_tree_create(const crofton_box* boxes, const uint32_t* layer_masks, size_t count,
                                               const crofton_jobs* jobs, crofton_tree** tree);
CROFTON_API crofton_status crofton_tree_destroy(crofton_tree* tree);

/* These calls change all of their items, or none. After moves and removals, call crofton_tree_refit before the next
 * query. */
CROFTON_API crofton_status crofton_tree_move(crofton_tree* tree, const uint32_t* items, const crofton_box* boxes,
                                             size_t count);
CROFTON_API crofton_status crofton_tree_insert(crofton_tree* tree, const crofton_box* box, uint32_t layer_mask,
                                               uint32_t* item);
/* Removes an item; its id is reused. */
CROFTON_API crofton_status crofton_tree_remove(crofton_tree* tree, uint32_t item);
CROFTON_API crofton_status crofton_tree_set_layer_mask(crofton_tree* tree, uint32_t item, uint32_t layer_mask);
/* Updates the tree, then does `rebuild_budget` items' worth of background rebuilding; 0: none. Call it once a frame. */
CROFTON_API crofton_status crofton_tree_refit(crofton_tree* tree, size_t rebuild_budget);

/* Lists the items that a view sees. `jobs` or NULL. CROFTON_UNSUPPORTED: a request with occlusion or a picture.
 * Allocates nothing once `result` has held as many. */
CROFTON_API crofton_status crofton_tree_view(const crofton_tree* tree, const crofton_view_request* request,
                                             const crofton_jobs* jobs, crofton_view_result* result);
/* The first item's box that a ray enters. */
typedef struct crofton_ray_hit {
    double t;
    uint32_t index; /* the item; CROFTON_NONE: no hit, and t is infinite */
} crofton_ray_hit;

/* Finds the box that each ray enters first, of the items whose layers share a bit with `layer_mask`. */
CROFTON_API crofton_status crofton_tree_raycast(const crofton_tree* tree, const crofton_ray* rays, size_t count,
                                                uint32_t layer_mask, crofton_ray_hit* hits);
/* Lists the items that overlap a box, sphere or capsule, ascending. Writes at most `capacity`, and sets *found to how
 * many there are. */
CROFTON_API crofton_status crofton_tree_overlap(const crofton_tree* tree, const crofton_query_shape* shape,
                                                uint32_t layer_mask, uint32_t* items, size_t capacity, size_t* found);

#ifdef __cplusplus
}
#endif
#endif
