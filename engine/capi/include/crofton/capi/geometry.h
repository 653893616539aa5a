/* SPDX-License-Identifier: MIT */
/* Boxes, cameras and frusta, with the conventions of docs/conventions.md. */
#ifndef CROFTON_CAPI_GEOMETRY_H
#define CROFTON_CAPI_GEOMETRY_H
#include <crofton/capi/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The parallelepiped { center + sum t_k half_extents[k] axes[k] : |t_k| <= 1 }; axes[3 k + i] is component i of axis k,
 * of unit length. */
typedef struct crofton_box {
    double center[3];
    float axes[9];
    float half_extents[3];
} crofton_box;

/* x -> linear x + translation; linear[3 c + r] is row r of column c. */
typedef struct crofton_transform {
    double linear[9];
    double translation[3];
} crofton_transform;

typedef enum crofton_projection { CROFTON_PERSPECTIVE = 0, CROFTON_ORTHOGRAPHIC = 1 } crofton_projection;

typedef enum crofton_depth_range {
    CROFTON_DEPTH_REVERSED_ZERO_TO_ONE = 0, /* Vulkan, Direct3D: 0 <= z <= w, near at w */
    CROFTON_DEPTH_ZERO_TO_ONE = 1,          /* Vulkan, Direct3D: 0 <= z <= w, near at 0 */
    CROFTON_DEPTH_MINUS_ONE_TO_ONE = 2      /* OpenGL: -w <= z <= w, near at -w */
} crofton_depth_range;

/* Right-handed; radians; full height of the view volume for orthographic cameras. */
typedef struct crofton_camera {
    size_t size;
    double position[3], forward[3], up[3];
    uint32_t projection; /* a crofton_projection */
    double fov_y, height, aspect, near_distance;
    double far_distance; /* infinity allowed for perspective */
} crofton_camera;

/* dot(normal, x) + offset >= 0 is the side that is kept. */
typedef struct crofton_plane {
    double normal[3];
    double offset;
} crofton_plane;

#define CROFTON_MAX_PLANES 12u
/* Half-spaces relative to `origin`. */
typedef struct crofton_frustum {
    size_t size;
    uint32_t plane_count; /* at most CROFTON_MAX_PLANES */
    double origin[3];
    crofton_plane planes[CROFTON_MAX_PLANES];
} crofton_frustum;

/* Fills a camera whose `size` is set: at the origin, looking along -z, 60 degrees, 16:9, from 0.1 to 1000. */
CROFTON_API crofton_status crofton_camera_default(crofton_camera* camera);

/* Both fill a frustum whose `size` is set. */
CROFTON_API crofton_status crofton_frustum_from_camera(const crofton_camera* camera, crofton_frustum* frustum);
/* `to_clip` is column-major and takes column vectors relative to `origin` (or NULL: the world's) to clip space;
 * `depth` is a crofton_depth_range. */
CROFTON_API crofton_status crofton_frustum_from_matrix(const double to_clip[16], uint32_t depth, const double* origin,
                                                       crofton_frustum* frustum);

/* CROFTON_OK iff all boxes are valid; crofton_last_error_item names the first that is not. */
CROFTON_API crofton_status crofton_boxes_validate(const crofton_box* boxes, size_t count);
/* A box around `box` under `transform`. */
CROFTON_API crofton_status crofton_box_transform(const crofton_transform* transform, const crofton_box* box,
                                                 crofton_box* result);

#ifdef __cplusplus
}
#endif
#endif
