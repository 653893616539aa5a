/* SPDX-License-Identifier: MIT */
/* Statuses and error messages, versions, the host's hooks, boxes, cameras, frusta. */
#ifndef CROFTON_CAPI_BASE_H
#define CROFTON_CAPI_BASE_H
#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32) && defined(CROFTON_SHARED)
#define CROFTON_API __declspec(dllimport)
#elif defined(__GNUC__)
#define CROFTON_API __attribute__((visibility("default")))
#else
#define CROFTON_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* Counts breaking changes of these headers. Binaries with equal numbers are compatible. */
#define CROFTON_API_VERSION 3u
#define CROFTON_NO_ITEM UINT64_MAX
#define CROFTON_NONE UINT32_MAX /* no parent, no id */

typedef enum crofton_status {
    CROFTON_OK = 0,
    CROFTON_INVALID_ARGUMENT = 1, /* a parameter outside its documented range, or NULL where that is not allowed */
    CROFTON_NON_FINITE = 2,       /* NaN or infinity where a finite number is needed */
    CROFTON_OUT_OF_RANGE = 3,     /* an index or a size beyond its limit */
    CROFTON_DEGENERATE = 4,       /* geometry without the extent or rank that the operation needs */
    CROFTON_EMPTY = 5,            /* empty input */
    CROFTON_UNSUPPORTED = 6,      /* well-formed, but not supported */
    CROFTON_IO = 7,               /* a file could not be read or written */
    CROFTON_PARSE = 8,            /* a file's contents are damaged or not of its format */
    CROFTON_CANCELLED = 9,        /* a callback asked to stop */
    CROFTON_BUDGET_EXCEEDED = 10, /* a time or memory budget ran out before any usable result */
    CROFTON_UNAVAILABLE = 11,     /* a device or driver is missing */
    CROFTON_STALE_HANDLE = 12,    /* the id of something that was removed */
    CROFTON_INTERNAL = 13,        /* a bug of Crofton: please report it */
    CROFTON_BAD_HANDLE = 14,      /* NULL, of another kind, or destroyed already */
    CROFTON_WRONG_SIZE = 15,      /* a struct's `size` is not what this library knows */
    CROFTON_BUSY = 16,            /* another thread is using the handle (with thread checks on) */
    CROFTON_OUT_OF_MEMORY = 17    /* the memory hook returned NULL; the call changed nothing */
} crofton_status;

/* Return the message of this thread's last failed call, and the item of its input that caused the failure, or
 * CROFTON_NO_ITEM. The text stays valid until the thread's next failed call. */
CROFTON_API const char* crofton_last_error(void);
CROFTON_API uint64_t crofton_last_error_item(void);
CROFTON_API const char* crofton_status_name(int status); /* "unknown status" for other numbers */

/* Return the version of the linked library, which may differ from that of the headers. */
CROFTON_API uint32_t crofton_api_version(void);
CROFTON_API const char* crofton_version_string(void); /* "major.minor.patch" */

/* The host's allocator, job system, log and assert handler. */

/* Called from any thread. `allocate` returns memory aligned to `alignment`, a power of two. If it returns NULL, the
 * program ends. */
typedef struct crofton_memory_hooks {
    size_t size;
    void* user;
    void* (*allocate)(void* user, size_t bytes, size_t alignment);
    void (*release)(void* user, void* memory, size_t bytes, size_t alignment);
} crofton_memory_hooks;

/* Sets the memory hooks. Call it before you create anything, because memory is released through the present hooks. NULL
 * restores the default. */
CROFTON_API crofton_status crofton_set_memory_hooks(const crofton_memory_hooks* hooks);

/* Processes the items [begin, end). `worker` < concurrency; no two tasks with the same `worker` run at once. */
typedef void (*crofton_range_task)(void* task_data, size_t begin, size_t end, uint32_t worker);

/* The host's job system, an argument of each call that can use one; NULL runs the call on the calling thread only.
 * `parallel_for` calls task(task_data, …) for the ranges [0, grain), [grain, 2 grain), … of [0, count); the last one
 * may be shorter. The ranges may run in any order and on any threads. It returns when all are done. Results do not
 * depend on it. */
typedef struct crofton_jobs {
    size_t size;
    void* user;
    uint32_t concurrency; /* 1 to 65536 */
    void (*parallel_for)(void* user, size_t count, size_t grain, crofton_range_task task, void* task_data);
} crofton_jobs;

typedef enum crofton_log_level {
    CROFTON_LOG_DEBUG = 0,
    CROFTON_LOG_INFO = 1,
    CROFTON_LOG_WARNING = 2,
    CROFTON_LOG_ERROR = 3
} crofton_log_level;

typedef void (*crofton_log_hook)(void* user, uint32_t level, const char* message);
/* Sets the log hook. NULL restores the default: warnings and errors to stderr. */
CROFTON_API crofton_status crofton_set_log_hook(crofton_log_hook hook, void* user);
/* Sends a message to the present log hook, as the library does. `level` is a crofton_log_level. */
CROFTON_API crofton_status crofton_log(uint32_t level, const char* message);

typedef void (*crofton_assert_hook)(const char* condition, const char* message, const char* file, int line);
/* Sets the hook that is called for a caller's mistake in builds with CROFTON_ASSERTS. NULL restores the default: print
 * and abort. */
CROFTON_API crofton_status crofton_set_assert_hook(crofton_assert_hook hook);

/* Switches thread checks on or off. With checks, a forbidden use of a handle by two threads returns CROFTON_BUSY.
 * Checks are on by default in builds with CROFTON_ASSERTS, else off. No other call may run at the same time. */
CROFTON_API crofton_status crofton_set_thread_checks(int on);

/* Boxes, cameras and frusta, with the conventions of docs/conventions.md. */

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

/* A right-handed camera. Angles are in radians; `height` is the full height of the view volume of an orthographic
 * camera. */
typedef struct crofton_camera {
    size_t size;
    double position[3], forward[3], up[3];
    uint32_t projection; /* a crofton_projection */
    double fov_y, height, aspect, near_distance;
    double far_distance; /* infinity allowed for perspective */
} crofton_camera;

/* The half-space dot(normal, x) + offset >= 0. */
typedef struct crofton_plane {
    double normal[3];
    double offset;
} crofton_plane;

#define CROFTON_MAX_PLANES 12u
/* The intersection of half-spaces, relative to `origin`. */
typedef struct crofton_frustum {
    size_t size;
    uint32_t plane_count; /* at most CROFTON_MAX_PLANES */
    double origin[3];
    crofton_plane planes[CROFTON_MAX_PLANES];
} crofton_frustum;

/* Returns a camera at the origin that looks along -z: 60 degrees, 16:9, from 0.1 to 1000. */
CROFTON_API crofton_camera crofton_default_camera(void);

/* Both fill a frustum whose `size` is set. */
CROFTON_API crofton_status crofton_frustum_from_camera(const crofton_camera* camera, crofton_frustum* frustum);
/* `to_clip` is column-major and takes column vectors relative to `origin` (or NULL: the world's) to clip space;
 * `depth` is a crofton_depth_range. */
CROFTON_API crofton_status crofton_frustum_from_matrix(const double to_clip[16], uint32_t depth, const double* origin,
                                                       crofton_frustum* frustum);

/* Returns CROFTON_OK if all boxes are valid. Else crofton_last_error_item is the first invalid one. */
CROFTON_API crofton_status crofton_boxes_validate(const crofton_box* boxes, size_t count);
/* Computes a box that contains `box` under `transform`. */
CROFTON_API crofton_status crofton_box_transform(const crofton_transform* transform, const crofton_box* box,
                                                 crofton_box* result);

#ifdef __cplusplus
}
#endif
#endif
