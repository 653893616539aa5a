/* SPDX-License-Identifier: MIT */
/* Statuses, their text, and versions; the host's hooks; boxes, cameras and views. */
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

/* Counts breaking changes of these headers. Equal numbers: the binaries fit together. */
#define CROFTON_API_VERSION 3u
#define CROFTON_NO_ITEM UINT64_MAX
#define CROFTON_NONE UINT32_MAX /* no parent, no id */

typedef enum crofton_status {
    CROFTON_OK = 0,
    CROFTON_INVALID_ARGUMENT = 1, /* a parameter outside its documented range, or NULL where that is not allowed */
    CROFTON_NON_FINITE = 2,       /* NaN or infinity where a finite number is needed */
    CROFTON_OUT_OF_RANGE = 3,     /* an index or a size beyond its limit */
    CROFTON_DEGENERATE = 4,       /* geometry without the extent or rank the operation needs */
    CROFTON_EMPTY = 5,            /* nothing to work on */
    CROFTON_UNSUPPORTED = 6,      /* well-formed, but not something we handle */
    CROFTON_IO = 7,               /* a file could not be read or written */
    CROFTON_PARSE = 8,            /* a file's contents are damaged or not of its format */
    CROFTON_CANCELLED = 9,        /* a callback asked to stop */
    CROFTON_BUDGET_EXCEEDED = 10, /* a time or memory budget ran out before any usable result */
    CROFTON_UNAVAILABLE = 11,     /* a device or driver is missing */
    CROFTON_STALE_HANDLE = 12,    /* an id of something that has been removed */
    CROFTON_INTERNAL = 13,        /* our mistake: please report it */
    CROFTON_BAD_HANDLE = 14,      /* NULL, of another kind, or destroyed already */
    CROFTON_WRONG_SIZE = 15,      /* a struct's `size` is not what this library knows */
    CROFTON_BUSY = 16,            /* another thread is using the handle (with thread checks on) */
    CROFTON_OUT_OF_MEMORY = 17    /* the memory hook had none; the call changed nothing */
} crofton_status;

/* What went wrong in this thread's last failed call, and which item of its input (CROFTON_NO_ITEM: none in particular).
 * The text stays valid until the thread's next failed call. */
CROFTON_API const char* crofton_last_error(void);
CROFTON_API uint64_t crofton_last_error_item(void);
CROFTON_API const char* crofton_status_name(int status); /* "unknown status" for numbers that are none */

/* Of the library that is linked, as opposed to the headers. */
CROFTON_API uint32_t crofton_api_version(void);
CROFTON_API const char* crofton_version_string(void); /* "major.minor.patch" */

/* The host's allocator, job system, log and assert handler. */

/* From any thread. `allocate` returns memory aligned to `alignment`, a power of two; NULL ends the program. */
typedef struct crofton_memory_hooks {
    size_t size;
    void* user;
    void* (*allocate)(void* user, size_t bytes, size_t alignment);
    void (*release)(void* user, void* memory, size_t bytes, size_t alignment);
} crofton_memory_hooks;

/* Call it before anything is created: memory is released through the hooks in force. NULL restores the default. */
CROFTON_API crofton_status crofton_set_memory_hooks(const crofton_memory_hooks* hooks);

/* Does the items [begin, end); `worker` < concurrency, and no two run at once for one worker. */
typedef void (*crofton_range_task)(void* task_data, size_t begin, size_t end, uint32_t worker);

/* The host's job system, given to each call that can use one (or NULL: on the calling thread alone). `parallel_for`
 * calls task(task_data, …) for the ranges [0, grain), [grain, 2 grain), … of [0, count), the last one cut short. They
 * may run in any order and on any threads. It returns when all are done. Results do not depend on it. */
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
/* NULL restores the default: warnings and errors to stderr. */
CROFTON_API crofton_status crofton_set_log_hook(crofton_log_hook hook, void* user);
/* `level` is a crofton_log_level. Through the hook in force, as the library's own messages go. */
CROFTON_API crofton_status crofton_log(uint32_t level, const char* message);

typedef void (*crofton_assert_hook)(const char* condition, const char* message, const char* file, int line);
/* Called for callers' mistakes in builds with CROFTON_ASSERTS. NULL restores the default: print and abort. */
CROFTON_API crofton_status crofton_set_assert_hook(crofton_assert_hook hook);

/* With checks on, using a handle from two threads where that is forbidden gives CROFTON_BUSY. On by default in builds
 * with CROFTON_ASSERTS, off in others. Switch it while no other call is running. */
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

/* At the origin, looking along -z, 60 degrees, 16:9, from 0.1 to 1000. */
CROFTON_API crofton_camera crofton_default_camera(void);

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
