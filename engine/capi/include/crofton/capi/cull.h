/* SPDX-License-Identifier: MIT */
/* What does a view see? */
#ifndef CROFTON_CAPI_CULL_H
#define CROFTON_CAPI_CULL_H
#include <crofton/capi/geometry.h>
#include <crofton/capi/hooks.h>

#ifdef __cplusplus
extern "C" {
#endif

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

#ifdef __cplusplus
}
#endif
#endif
