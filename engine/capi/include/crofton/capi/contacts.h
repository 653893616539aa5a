/* SPDX-License-Identifier: MIT */
/* Where do boxes and meshes touch, how deep, and how far are they apart? */
#ifndef CROFTON_CAPI_CONTACTS_H
#define CROFTON_CAPI_CONTACTS_H
#include <crofton/capi/collide.h>

#ifdef __cplusplus
extern "C" {
#endif

#define CROFTON_MAX_MANIFOLD_POINTS 8u

typedef struct crofton_contact_point {
    double position[3]; /* midway between the surfaces */
    double depth;       /* >= 0 */
} crofton_contact_point;

/* Moving b by depth * normal ends the contact. */
typedef struct crofton_manifold {
    size_t size;
    double normal[3]; /* unit, from a to b */
    double depth;
    uint32_t point_count; /* 0 where the boxes do not meet */
    crofton_contact_point points[CROFTON_MAX_MANIFOLD_POINTS];
} crofton_manifold;

/* Where two triangles meet, in a's frame: the ends of their common segment, and the unit normal of b's triangle. */
typedef struct crofton_mesh_contact {
    crofton_pair triangles; /* of a and of b */
    double begin[3], end[3], normal[3];
} crofton_mesh_contact;

typedef enum crofton_containment {
    CROFTON_CONTAINS_NOTHING = 0, /* or the surfaces meet */
    CROFTON_A_INSIDE_B = 1,
    CROFTON_B_INSIDE_A = 2,
    CROFTON_PARTLY_INSIDE = 3 /* some pieces of a mesh, but not all */
} crofton_containment;

/* Fills a manifold whose `size` is set. */
CROFTON_API crofton_status crofton_boxes_manifold(const crofton_box* a, const crofton_box* b,
                                                  crofton_manifold* manifold);
/* 0 where they meet; nearest points, or NULL. */
CROFTON_API crofton_status crofton_boxes_distance(const crofton_box* a, const crofton_box* b, double* distance,
                                                  double* on_a, double* on_b);

/* Writes the first `capacity` contacts, in order of triangles, and in *count how many there are in all. */
CROFTON_API crofton_status crofton_colliders_contacts(const crofton_collider* a, const crofton_collider* b,
                                                      const crofton_transform* b_to_a, crofton_mesh_contact* contacts,
                                                      size_t capacity, size_t* count);
/* A motion of b by *depth along `direction` (a unit vector, or NULL) ends the contact: an upper bound of the
 * penetration depth, 0 where the meshes do not meet. */
CROFTON_API crofton_status crofton_colliders_depth(const crofton_collider* a, const crofton_collider* b,
                                                   const crofton_transform* b_to_a, double* depth, double* direction);
/* Whether one mesh, without touching it, lies inside the other, which is to be closed: a crofton_containment. */
CROFTON_API crofton_status crofton_colliders_containment(const crofton_collider* a, const crofton_collider* b,
                                                         const crofton_transform* b_to_a, uint32_t* containment);

#ifdef __cplusplus
}
#endif
#endif
