/* What does a ray hit first? */
#ifndef CROFTON_CAPI_RAYS_H
#define CROFTON_CAPI_RAYS_H
#include <crofton/capi/collide.h>

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
    uint32_t index; /* of a collider: the triangle; CROFTON_NONE: no hit, and t is infinite */
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

#ifdef __cplusplus
}
#endif
#endif
