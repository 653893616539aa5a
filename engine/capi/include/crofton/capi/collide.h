/* SPDX-License-Identifier: MIT */
/* What touches what? Exactly; touching counts. */
#ifndef CROFTON_CAPI_COLLIDE_H
#define CROFTON_CAPI_COLLIDE_H
#include <crofton/capi/geometry.h>
#include <crofton/capi/hooks.h>
#include <crofton/capi/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

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

#ifdef __cplusplus
}
#endif
#endif
