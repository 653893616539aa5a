/* SPDX-License-Identifier: MIT */
/* What does a ray hit first, and what lies within a body? */
#ifndef CROFTON_CAPI_RAYS_H
#define CROFTON_CAPI_RAYS_H
#include <crofton/capi/collide.h>
#include <crofton/capi/cull.h>

#ifdef __cplusplus
extern "C" {
#endif

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

#ifdef __cplusplus
}
#endif
#endif
