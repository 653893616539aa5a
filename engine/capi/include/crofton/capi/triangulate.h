/* SPDX-License-Identifier: MIT */
/* Polygons with holes to triangles of minimum weight. */
#ifndef CROFTON_CAPI_TRIANGULATE_H
#define CROFTON_CAPI_TRIANGULATE_H
#include <crofton/capi/base.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct crofton_triangulator crofton_triangulator; /* memory kept from one polygon to the next */

/* Rings one after another; ring r is [ring_ends[r - 1], ring_ends[r]), the first is the outer one, the others holes. */
typedef struct crofton_polygon {
    size_t size;
    const double* points; /* x y each */
    size_t point_count;
    const uint32_t* ring_ends;
    size_t ring_count;
} crofton_polygon;

typedef enum crofton_triangulation_method {
    CROFTON_TRIANGULATE_EAR = 0,
    CROFTON_TRIANGULATE_DELAUNAY = 1,
    CROFTON_TRIANGULATE_MINIMUM_WEIGHT = 2
} crofton_triangulation_method;

typedef struct crofton_triangulation {
    size_t size;
    const uint32_t* indices; /* three per triangle, counter-clockwise; valid until the triangulator's next call */
    size_t triangle_count;
    double weight;    /* total length of the diagonals */
    double gap;       /* proven bound on (weight - minimum) / minimum; infinite when unknown */
    uint32_t optimal; /* 1 where the weight is proven minimal */
} crofton_triangulation;

CROFTON_API crofton_status crofton_triangulator_create(crofton_triangulator** triangulator);
CROFTON_API crofton_status crofton_triangulator_destroy(crofton_triangulator* triangulator);
/* Fills a triangulation whose `size` is set; `method` is a crofton_triangulation_method. */
CROFTON_API crofton_status crofton_triangulate(crofton_triangulator* triangulator, const crofton_polygon* polygon,
                                               uint32_t method, crofton_triangulation* triangulation);

#ifdef __cplusplus
}
#endif
#endif
