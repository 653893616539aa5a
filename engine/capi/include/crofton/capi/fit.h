/* SPDX-License-Identifier: MIT */
/* Boxes around points, best by the criterion that the queries imply. */
#ifndef CROFTON_CAPI_FIT_H
#define CROFTON_CAPI_FIT_H
#include <crofton/capi/geometry.h>

#ifdef __cplusplus
extern "C" {
#endif

/* volume_weight V + area_weight F + mean_curvature_weight M, weights >= 0 and not all 0. */
typedef struct crofton_criterion {
    double volume_weight, area_weight, mean_curvature_weight;
} crofton_criterion;

typedef enum crofton_fit_quality {
    CROFTON_FIT_FAST = 0,  /* one or two passes over the points */
    CROFTON_FIT_TIGHT = 1, /* convex hull and local search */
    CROFTON_FIT_EXACT = 2  /* the global optimum */
} crofton_fit_quality;

typedef struct crofton_fit_options {
    size_t size;
    uint32_t quality; /* a crofton_fit_quality */
    crofton_criterion criterion;
} crofton_fit_options;

/* For frusta large beside the objects: the sum of the edges. */
CROFTON_API crofton_status crofton_criterion_minimal_perimeter(crofton_criterion* criterion);
/* The criterion that makes the camera's expected number of hits smallest; its far distance must be finite. */
CROFTON_API crofton_status crofton_criterion_for_frustum(const crofton_camera* camera, crofton_criterion* criterion);
/* For rays and segments of this length. */
CROFTON_API crofton_status crofton_criterion_for_rays(double length, crofton_criterion* criterion);

/* A box that contains every point, x y z each; `options` or NULL: tight, minimal perimeter. */
CROFTON_API crofton_status crofton_fit_floats(const float* points, size_t point_count,
                                              const crofton_fit_options* options, crofton_box* box);
CROFTON_API crofton_status crofton_fit_doubles(const double* points, size_t point_count,
                                               const crofton_fit_options* options, crofton_box* box);
/* A box that contains all the boxes; `criterion` or NULL: minimal perimeter. */
CROFTON_API crofton_status crofton_fit_boxes(const crofton_box* boxes, size_t count, const crofton_criterion* criterion,
                                             crofton_box* box);

#ifdef __cplusplus
}
#endif
#endif
