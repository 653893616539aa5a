/* SPDX-License-Identifier: MIT */
/* What a World answers: what is seen, what rays and shapes meet, what touches. All as of its last update. */
#ifndef CROFTON_CAPI_WORLD_QUERIES_H
#define CROFTON_CAPI_WORLD_QUERIES_H
#include <crofton/capi/contacts.h>
#include <crofton/capi/cull.h>
#include <crofton/capi/rays.h>
#include <crofton/capi/world.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct crofton_visible_objects crofton_visible_objects;   /* what one view sees, in memory that is kept */
typedef struct crofton_visible_in_views crofton_visible_in_views; /* what up to 32 views see, likewise */
typedef struct crofton_found crofton_found;                       /* a list of objects or of hits, likewise */

typedef struct crofton_object_ref {
    crofton_object object;
    uint64_t user;
} crofton_object_ref;

typedef struct crofton_object_hit {
    crofton_object object; /* index CROFTON_NONE: no hit, and t is infinite */
    uint64_t user;
    double t; /* the ray's */
    double point[3];
    uint32_t triangle; /* of the object's mesh, or CROFTON_NONE */
} crofton_object_hit;

typedef struct crofton_closest_object {
    size_t size;
    crofton_object object; /* index CROFTON_NONE: none within the distance, which is infinite then */
    uint64_t user;
    double distance;
    double on_shape[3], on_object[3]; /* a nearest point of each; any where they meet */
} crofton_closest_object;

typedef struct crofton_object_pair {
    crofton_object_ref first, second; /* first.object.index < second.object.index */
} crofton_object_pair;

typedef enum crofton_contact_phase {
    CROFTON_CONTACT_BEGAN = 0,
    CROFTON_CONTACT_STAYED = 1,
    CROFTON_CONTACT_ENDED = 2
} crofton_contact_phase;

/* Two objects that touch, or that did in the update before. What ended has no more than its objects, whose handles are
 * stale where they have been removed. */
typedef struct crofton_object_contact {
    size_t size;
    crofton_object_ref first, second;      /* ordered as in crofton_object_pair */
    uint32_t phase;                        /* a crofton_contact_phase */
    uint32_t inside;                       /* a crofton_containment of first (a) and second (b) */
    double normal[3];                      /* unit, from first to second; 0 where no direction is known */
    double depth;                          /* 0 between meshes unless options ask for it */
    const crofton_contact_point* points;   /* at most four, in the world; valid until the next update */
    const crofton_mesh_contact* triangles; /* of two meshes, or a mesh and a box; likewise */
    size_t point_count, triangle_count;
} crofton_object_contact;

CROFTON_API crofton_status crofton_world_object_count(const crofton_world* world, size_t* count);
/* *contains is 1 or 0. */
CROFTON_API crofton_status crofton_world_contains(const crofton_world* world, crofton_object object, int* contains);
CROFTON_API crofton_status crofton_world_contains_node(const crofton_world* world, crofton_node node, int* contains);
CROFTON_API crofton_status crofton_world_contains_mesh(const crofton_world* world, crofton_world_mesh mesh,
                                                       int* contains);
CROFTON_API crofton_status crofton_world_get_user(const crofton_world* world, crofton_object object, uint64_t* user);
/* CROFTON_EMPTY before the first update after the object was added. */
CROFTON_API crofton_status crofton_world_get_box(const crofton_world* world, crofton_object object, crofton_box* box);
/* To the world's coordinates. Of an object with a mesh. */
CROFTON_API crofton_status crofton_world_get_transform(const crofton_world* world, crofton_object object,
                                                       crofton_transform* transform);

CROFTON_API crofton_status crofton_visible_objects_create(crofton_visible_objects** visible);
CROFTON_API crofton_status crofton_visible_objects_destroy(crofton_visible_objects* visible);
/* What a view sees, by the objects' boxes; `options`, `jobs` or NULL. Allocates nothing once `visible` has grown to the
 * largest answer. */
CROFTON_API crofton_status crofton_world_view(const crofton_world* world, const crofton_view* view,
                                              const crofton_cull_options* options, const crofton_jobs* jobs,
                                              crofton_visible_objects* visible);
/* The same for a camera, which sees all layers. */
CROFTON_API crofton_status crofton_world_view_camera(const crofton_world* world, const crofton_camera* camera,
                                                     const crofton_cull_options* options, const crofton_jobs* jobs,
                                                     crofton_visible_objects* visible);
/* The objects' indices; valid until the next view. In tree order the first *inside_count (or NULL) lie inside the view.
 * In ascending order *verdicts (or NULL) are a crofton_verdict each; in tree order they are NULL. */
CROFTON_API crofton_status crofton_visible_objects_ids(const crofton_visible_objects* visible, const uint32_t** ids,
                                                       size_t* count, const uint8_t** verdicts, size_t* inside_count);
/* Writes the objects from place `first` on, at most `capacity`. `world` is the one that was viewed; ask before it next
 * changes. */
CROFTON_API crofton_status crofton_visible_objects_list(const crofton_visible_objects* visible,
                                                        const crofton_world* world, size_t first,
                                                        crofton_object_ref* objects, size_t capacity);
CROFTON_API crofton_status crofton_visible_objects_get_statistics(const crofton_visible_objects* visible,
                                                                  crofton_cull_statistics* statistics);

CROFTON_API crofton_status crofton_visible_in_views_create(crofton_visible_in_views** visible);
CROFTON_API crofton_status crofton_visible_in_views_destroy(crofton_visible_in_views* visible);
/* What up to 32 views see, each object once, in the order of the tree; `options` or NULL. */
CROFTON_API crofton_status crofton_world_views(const crofton_world* world, const crofton_view* views, size_t count,
                                               const crofton_cull_options* options, crofton_visible_in_views* visible);
CROFTON_API crofton_status crofton_visible_in_views_ids(const crofton_visible_in_views* visible, const uint32_t** ids,
                                                        size_t* count);
/* As crofton_visible_objects_list; bit v of view_masks[i] (or NULL): view v sees objects[i]. */
CROFTON_API crofton_status crofton_visible_in_views_list(const crofton_visible_in_views* visible,
                                                         const crofton_world* world, size_t first,
                                                         crofton_object_ref* objects, uint32_t* view_masks,
                                                         size_t capacity);

/* Rays meet triangles of meshes, boxes and balls. hits[i] is the nearest of rays[i]. */
CROFTON_API crofton_status crofton_world_raycast(const crofton_world* world, const crofton_ray* rays, size_t count,
                                                 uint32_t layer_mask, crofton_object_hit* hits);
/* *hit is 1 where the ray hits anything, else 0. */
CROFTON_API crofton_status crofton_world_raycast_any(const crofton_world* world, const crofton_ray* ray,
                                                     uint32_t layer_mask, int* hit);

CROFTON_API crofton_status crofton_found_create(crofton_found** found);
CROFTON_API crofton_status crofton_found_destroy(crofton_found* found);
/* What the last query into `found` has found, of its kind; valid until the next. */
CROFTON_API crofton_status crofton_found_objects(const crofton_found* found, const crofton_object_ref** objects,
                                                 size_t* count);
CROFTON_API crofton_status crofton_found_hits(const crofton_found* found, const crofton_object_hit** hits,
                                              size_t* count);

/* Finds the nearest hit of every object that the ray meets, by t, then by index: hits. */
CROFTON_API crofton_status crofton_world_raycast_all(const crofton_world* world, const crofton_ray* ray,
                                                     uint32_t layer_mask, crofton_found* found);
/* Find whose box or ball meets the shape, by index: objects. A mesh's box stands for it. */
CROFTON_API crofton_status crofton_world_overlap_box(const crofton_world* world, const crofton_box* box,
                                                     uint32_t layer_mask, crofton_found* found);
CROFTON_API crofton_status crofton_world_overlap_ball(const crofton_world* world, const double center[3], double radius,
                                                      uint32_t layer_mask, crofton_found* found);
CROFTON_API crofton_status crofton_world_overlap_capsule(const crofton_world* world, const double begin[3],
                                                         const double end[3], double radius, uint32_t layer_mask,
                                                         crofton_found* found);
/* Fill a struct whose `size` is set: the box or ball nearest to the shape, no farther than max_distance, which may be
 * infinite; of several the lowest index. */
CROFTON_API crofton_status crofton_world_closest_to_box(const crofton_world* world, const crofton_box* box,
                                                        double max_distance, uint32_t layer_mask,
                                                        crofton_closest_object* closest);
CROFTON_API crofton_status crofton_world_closest_to_ball(const crofton_world* world, const double center[3],
                                                         double radius, double max_distance, uint32_t layer_mask,
                                                         crofton_closest_object* closest);
CROFTON_API crofton_status crofton_world_closest_to_capsule(const crofton_world* world, const double begin[3],
                                                            const double end[3], double radius, double max_distance,
                                                            uint32_t layer_mask, crofton_closest_object* closest);

/* Objects whose boxes or balls meet, in order; valid until the next update. */
CROFTON_API crofton_status crofton_world_pairs(const crofton_world* world, const crofton_object_pair** pairs,
                                               size_t* count);
CROFTON_API crofton_status crofton_world_contact_count(const crofton_world* world, size_t* count);
/* Fills a struct whose `size` is set: contact number `contact`, in order of the pairs. */
CROFTON_API crofton_status crofton_world_contact(const crofton_world* world, size_t contact,
                                                 crofton_object_contact* result);

#ifdef __cplusplus
}
#endif
#endif
